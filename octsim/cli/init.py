"""`octsim init`: a commented config of a user's instrument and neuron, by flags or questions."""

import sys
from argparse import Namespace
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from octsim.base.errors import ConfigError


class _Question(NamedTuple):
    """What is asked of an instrument."""

    asks: str
    keys: tuple[str, ...]
    """Of the config that the answer sets: one, or both ends of a range."""
    usual: tuple[str, ...]
    """What the thesis has."""
    metavar: tuple[str, ...]


_QUESTIONS: Mapping[str, _Question] = {
    "aperture": _Question(
        "numerical aperture of the objective", ("objective.numerical_aperture",), ("1.2",), ("NA",)
    ),
    "magnification": _Question(
        "its magnification, object to fibre", ("objective.magnification",), ("20",), ("M",)
    ),
    "fibre": _Question(
        "core diameter of the fibre", ("detector.core_diameter",), ("4.4 um",), ("LENGTH",)
    ),
    "band": _Question(
        "shortest and longest wavelength",
        ("spectrum.wavelength.min", "spectrum.wavelength.max"),
        ("650 nm", "900 nm"),
        ("FROM", "TO"),
    ),
    "diameters": _Question(
        "smallest and largest diameter of the neuron",
        ("sweep.diameters.start", "sweep.diameters.stop"),
        ("1 um", "2 um"),
        ("FROM", "TO"),
    ),
}
_STEP, _FEWEST = 0.01, 21
"""Distance (µm) of the diameters that are swept, at most, and how many there are at least."""
_TEXT = """\
# Written by `octsim init`. It holds what differs from the thesis; `octsim check {file}` prints
# every other key as it is. Lengths carry their unit.
run: {run}
objective:
  numerical_aperture: {aperture}
  magnification: {magnification:<18} # object to fibre
detector:
  core_diameter: {fibre:<18} # of the fibre
spectrum:
  wavelength: {{min: {band[0]}, max: {band[1]}}}
sweep:                              # the diameters whose spectra are made
  diameters: {{start: {diameters[0]}, stop: {diameters[1]}, num: {num}}}
  focus: law                        # the line that is fitted; or as {{slope: 0, intercept: 0.9 um}}
# null follows the sweep: these need no range of their own
focus_law: {{diameters: null}}
focus_scan: {{diameter: null, focus: null}}
calibration: {{diameters: null}}
# some of what else there is:
# scene: {{gap: 5 nm, refractive_index: {{glass: 1.52, water: 1.33, neuron: 1.39}}}}
# tracing: {{preset: exact}}          # Maxwell's equations; or draft, standard, reference: rays
# processing: {{estimator: sinusoid}}
"""


def add(commands: Any) -> None:
    """Add the command to a parser's others."""
    parser = commands.add_parser(
        "init",
        help="write a config of your instrument and neuron",
        description="Write a commented config. On a terminal and without options it asks; what is "
        "not given is the thesis's.",
        epilog="Exit status: 0 if it was written, 2 if not; a file that is there stays.",
    )
    parser.add_argument(
        "file", nargs="?", type=Path, default=Path("mine.yaml"), help="to write (%(default)s)"
    )
    parser.add_argument("--run", metavar="NAME", help="of the run (the file's, without .yaml)")
    for name, one in _QUESTIONS.items():
        pair = len(one.keys) > 1
        parser.add_argument(
            f"--{name}",
            nargs=2 if pair else None,
            metavar=one.metavar if pair else one.metavar[0],
            help=f"{one.asks} ({' to '.join(one.usual)})",
        )
    parser.set_defaults(do=run_init, failed=2)


def run_init(given: Namespace) -> int:
    """Write a config that was checked; what is likely not meant goes to stderr."""
    file: Path = given.file.expanduser()
    if file.exists():
        raise ConfigError(f"{file}: there already; give another name, or move it away")
    answers = {name: _as_pair(getattr(given, name)) for name in _QUESTIONS}
    run = given.run or file.stem
    if not any(answers.values()) and sys.stdin.isatty() and sys.stdout.isatty():
        try:
            answers = {name: _asked(name, run) for name in _QUESTIONS}
        except (EOFError, KeyboardInterrupt):
            print("\noctsim: nothing was written", file=sys.stderr)
            return 130
    text = _written(file, run, {name: answers[name] or _QUESTIONS[name].usual for name in answers})
    _write(file, text)
    print(f"{file}: written; `octsim check {file}` says what a run of it takes")
    return 0


def _as_pair(answer: Any) -> tuple[str, ...]:
    return () if answer is None else (answer,) if isinstance(answer, str) else tuple(answer)


def _asked(name: str, run: str) -> tuple[str, ...]:
    """Ask until there is an answer that a config takes; an empty one is the thesis's."""
    one = _QUESTIONS[name]
    while True:
        line = input(f"{one.asks} [{' to '.join(one.usual)}]: ").strip()
        answer = tuple(part.strip() for part in line.split(" to ")) if line else one.usual
        if len(answer) != len(one.keys):
            print(f"write it as {' to '.join(one.usual)}")
            continue
        try:
            _checked(run, {name: answer})
        except ConfigError as error:
            print(error)
        else:
            return answer


def _checked(run: str, answers: Mapping[str, tuple[str, ...]]) -> tuple[Any, list[str]]:
    """Return the config of some answers, and what is to be remarked of it.

    Raises
    ------
    ConfigError
        If it is none that can be run.
    """
    import yaml

    from octsim.config.derive import merge, nested_all
    from octsim.config.load import load_and_tell

    overlay: dict[str, Any] = {
        "run": run,
        "focus_law": {"diameters": None},
        "focus_scan": {"diameter": None, "focus": None},
        "calibration": {"diameters": None},
    }
    values: dict[str, Any] = {}
    for name, answer in answers.items():
        for key, text in zip(_QUESTIONS[name].keys, answer, strict=True):
            try:
                values[key] = yaml.safe_load(text)
            except yaml.YAMLError:
                values[key] = text
    return load_and_tell(merge(overlay, nested_all(values)))


def _written(file: Path, run: str, answers: Mapping[str, tuple[str, ...]]) -> str:
    """Return the text of a config, which was read as a run's will be."""
    import math

    import yaml

    from octsim.config.load import load_and_tell

    config, _ = _checked(run, answers)
    sweep = config.sweep.diameters
    num = max(_FEWEST, 1 + math.ceil(round((sweep.stop - sweep.start) / _STEP, 6)))
    words = {name: answer if len(answer) > 1 else answer[0] for name, answer in answers.items()}
    quoted = yaml.safe_dump(run, default_flow_style=True).removesuffix("...\n").strip()
    text = _TEXT.format(file=file, run=quoted, num=num, **words)
    _, said = load_and_tell(yaml.safe_load(text))
    for remark in said:
        print(f"octsim: warning: {remark}", file=sys.stderr)
    return text


def _write(file: Path, text: str) -> None:
    from octsim.base.files import whole

    with whole(file) as temporary:
        temporary.write_text(text, encoding="utf-8")
