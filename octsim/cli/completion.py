"""`octsim completion`: a script by which a shell completes commands, options and files."""

import argparse
from argparse import Namespace
from collections.abc import Mapping
from functools import partial
from typing import Any

_BASH = """\
# completion of octsim for bash: source this, or put it in
# ~/.local/share/bash-completion/completions/octsim
_octsim() {{
    local word="${{COMP_WORDS[COMP_CWORD]}}" path="" at words
    for at in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
        case "$path/$at" in
            {known}) path="$path/$at" ;;
        esac
    done
    case "$path" in
{cases}
    esac
    COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o bashdefault -o default -F _octsim octsim
"""
_ZSH = """\
#compdef octsim
# completion of octsim for zsh: put this as _octsim in a folder of $fpath, or source it
_octsim() {{
    local path_="" at; local -a words_
    for at in "${{(@)words[2,CURRENT-1]}}"; do
        case "$path_/$at" in
            {known}) path_="$path_/$at" ;;
        esac
    done
    case "$path_" in
{cases}
    esac
    (( $#words_ )) && _describe -t commands octsim words_
    _files
}}
compdef _octsim octsim
"""


def add(commands: Any) -> None:
    """Add the command to a parser's others."""
    parser = commands.add_parser(
        "completion",
        help="print a script that completes octsim in bash or zsh",
        description='Print a script for a shell: eval "$(octsim completion bash)".',
    )
    parser.add_argument("shell", choices=sorted(_SHELLS))
    parser.set_defaults(do=partial(run_completion, commands), failed=2)


def run_completion(commands: Any, given: Namespace) -> int:
    """Print the script of a shell, made of the parser's commands."""
    print(_SHELLS[given.shell](_table(commands)), end="")
    return 0


def _table(commands: Any, before: str = "") -> dict[str, dict[str, str]]:
    """Return what can follow each command, by its path as ``/cache/show``, and its help."""
    help_of = {one.dest: one.help or "" for one in commands._choices_actions}
    found = {before: {**{name: help_of.get(name, "") for name in commands.choices}}}
    for name, parser in commands.choices.items():
        path, following = f"{before}/{name}", dict[str, str]()
        for action in parser._actions:
            if isinstance(action, argparse._SubParsersAction):
                found |= _table(action, path)
                following |= found[path]
                continue
            long = [option for option in action.option_strings if option.startswith("--")]
            names = long or (list(action.choices or ()) if not action.option_strings else [])
            following |= dict.fromkeys(map(str, names), action.help or "")
        found[path] = following
    found[before] |= {} if before else {"--help": "", "--version": ""}
    return found


def _bash(table: Mapping[str, Mapping[str, str]]) -> str:
    cases = [f'        "{path}") words="{" ".join(names)}" ;;' for path, names in table.items()]
    return _BASH.format(known=_known(table), cases="\n".join(cases))


def _zsh(table: Mapping[str, Mapping[str, str]]) -> str:
    cases = []
    for path, names in table.items():
        each = (
            f"'{name}:{_quoted(said)}'" if said else f"'{name}'" for name, said in names.items()
        )
        cases.append(f'        "{path}") words_=({" ".join(each)}) ;;')
    return _ZSH.format(known=_known(table), cases="\n".join(cases))


def _known(table: Mapping[str, object]) -> str:
    return "|".join(f'"{path}"' for path in table if path)


def _quoted(text: str) -> str:
    return text.replace("'", "'\\''").replace("%(default)s", "as it is")


_SHELLS = {"bash": _bash, "zsh": _zsh}
