"""What each command of `octsim` says of itself, as a part of a page."""

import os
import re
import subprocess
import sys

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


def help_of(*command: str) -> str:
    """Return what ``octsim <command> --help`` prints."""
    call = [sys.executable, "-m", "octsim", *command, "--help"]
    # without the words of a terminal: its width, its colours
    plain = {**os.environ, "COLUMNS": "90", "NO_COLOR": "1"}
    return subprocess.run(call, env=plain, capture_output=True, text=True, check=True).stdout


def commands_in(said: str) -> list[str]:
    """Return the commands that a help names."""
    return re.findall(r"^    ([a-z][\w-]*)(?: |$)", said, flags=re.MULTILINE)


class CommandHelp(SphinxDirective):
    """A section for each command of octsim."""

    def run(self) -> list[nodes.Node]:
        """Ask each for its help."""
        sections: list[nodes.Node] = []
        for command in commands_in(help_of()):
            section = nodes.section(ids=[f"octsim-{command}"])
            section += nodes.title(text=f"octsim {command}")
            section += nodes.literal_block(text=help_of(command), language="text")
            sections.append(section)
        return sections


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx of it."""
    app.add_directive("command-help", CommandHelp)
    return {"parallel_read_safe": True}
