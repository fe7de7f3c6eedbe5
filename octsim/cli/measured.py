"""The command `octsim import`: a spectrometer's file in octsim's own form."""

import argparse
import sys
from argparse import Namespace
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from octsim.base.errors import ConfigError

if TYPE_CHECKING:
    from octsim.config.models import Config

_FIELDS = ("at", "x", "dark", "reference", "rate", "full_scale")
"""Options that are keys of the section measured."""
_BY_ITSELF = {"depth": "peak", "sinusoid": {"weights": "shot"}}
"""How spectra are processed of which no config tells more."""


def add(commands: "argparse._SubParsersAction[Any]") -> None:
    """Add the command."""
    parser = commands.add_parser(
        "import",
        help="read a spectrometer's spectra, and estimate the phase of each",
        description=(
            "Write measured.nc: a spectrometer's spectra in octsim's form, each with its phase, "
            "and print what was understood of the files. The options are keys of the config's "
            "section `measured`; what else they can be stands in a config."
        ),
    )
    parser.add_argument("spectra", nargs="?", help="file with raw spectra")
    parser.add_argument("--config", help="config of the run, as YAML")
    parser.add_argument("--output", default="measured.nc", help="file to write (measured.nc)")
    parser.add_argument("--at", help="name inside the file, as /raw/spectra")
    parser.add_argument("--x", type=int, help="which place across, of three-dimensional data")
    parser.add_argument("--axis", help="file with a wavelength for each sample")
    parser.add_argument("--dark", help="file with spectra without light")
    parser.add_argument("--reference", help="file with the source's own spectra, raw")
    parser.add_argument("--rate", help="of spectra, as '20 kHz'")
    parser.add_argument("--full-scale", type=float, help="counts at which the camera is full")
    parser.add_argument(
        "--source", type=Path, help="also write the reference as a file for spectrum.source"
    )
    parser.set_defaults(do=do, failed=2)


def do(given: Namespace) -> int:
    """Read, fit, write and tell."""
    from octsim.config.load import load_and_tell
    from octsim.datasets.files import opened
    from octsim.datasets.writer import write_stream
    from octsim.studies.measured.source_file import write_source
    from octsim.studies.measured.study import doubts, measured, own_band, summary

    asked: dict[str, Any] = {
        name: getattr(given, name) for name in _FIELDS if getattr(given, name) is not None
    }
    if given.spectra is not None:
        asked["spectra"] = given.spectra
    if given.axis is not None:
        asked["axis"] = {"wavelength": given.axis}
    overlays: list[str | Mapping[str, Any]] = [given.config] if given.config else []
    if not given.config:
        # nothing says which part of the spectra is meant, or at which depth: all, and the peak's
        band = own_band(load_and_tell({"measured": asked})[0])
        overlays.append({"spectrum": band, "processing": _BY_ITSELF})
    config, said = load_and_tell(*overlays, {"measured": asked})
    # of a config that no one wrote there is nothing to remark
    for remark in said if given.config else ():
        print(f"octsim: warning: {remark}", file=sys.stderr)
    output = Path(given.output)
    _require_new("--output", output, given.config, config)
    if given.source is not None:
        _require_new("--source", given.source, given.config, config)
        if given.source.resolve() == output.resolve():
            raise ConfigError(f"--source: {output} given, which is --output too; give another name")
        write_source(config, given.source)
        print(f"{given.source}: the source, for spectrum.source")
    write_stream(measured.stream(config), output)
    with opened(output, "measured", config) as found:
        for line in str(found.attrs["understood"]).splitlines():
            if not line.startswith("warning: "):
                print(line)
        print(f"{output}: {summary(found)}")
        for doubt in doubts(found):
            print(f"octsim: warning: {doubt}", file=sys.stderr)
    return 0


def _require_new(option: str, output: Path, given: str | None, config: "Config") -> None:
    """Refuse to write over a file that is read."""
    for key, file in {"--config": given, **config.measured.files}.items():
        if file is not None and output.exists() and Path(file).exists() and output.samefile(file):
            raise ConfigError(
                f"{option}: {output} given, which is {key}'s own file; give another name"
            )
