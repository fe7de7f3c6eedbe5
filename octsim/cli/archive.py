"""`octsim archive`, `octsim verify` and `octsim unpack`: a run as one file, checked to the bit."""

import sys
from argparse import Namespace
from pathlib import Path
from typing import Any

from octsim.base.errors import one_line


def add(commands: Any) -> None:
    """Add the commands to a parser's others."""
    purpose = "pack a run for a data repository"
    parser = commands.add_parser("archive", help=purpose, description=purpose)
    parser.add_argument("folder", type=Path, help="of the run, as results/thesis")
    parser.add_argument("--file", type=Path, help="to write (default: <folder>/<run>.zip)")
    parser.add_argument(
        "--config",
        type=Path,
        help="whose section archive has title, creators, license and date (default: that of the "
        "archive which is replaced, where there is one)",
    )
    parser.set_defaults(do=run_archive, failed=2)
    purpose = "check that an archive, a run or a dataset is as it was written, to the last bit"
    parser = commands.add_parser(
        "verify", help=purpose, description=purpose,
        epilog="Exit status: 0 if all is as it was written (of what octsim 0.2.0 wrote that is not "
        "known, and said), 1 if something is not, 2 if it can't be read, or nothing can be known.",
    )  # fmt: skip
    parser.add_argument(
        "path",
        type=Path,
        help="a zip or the folder that it was unpacked to, a run's folder as results/thesis, or a "
        "dataset",
    )
    parser.set_defaults(do=run_verify, failed=2)
    purpose = "verify an archive, then unpack it"
    parser = commands.add_parser("unpack", help=purpose, description=purpose)
    parser.add_argument("file", type=Path, help="a zip")
    parser.add_argument("folder", type=Path, help="not there yet, or empty")
    parser.set_defaults(do=run_unpack, failed=2)


def run_archive(given: Namespace) -> int:
    """Pack a run; print what a user should know of it to stderr."""
    from octsim.archive.pack import pack, packed_config
    from octsim.archive.run_folder import run_in
    from octsim.config.derive import merge
    from octsim.config.load import load_config, read_overlay
    from octsim.config.models import Config

    folder = given.folder.expanduser()
    run = run_in(folder).config
    named = given.file and given.file.expanduser()
    file = named or folder / f"{run.run}.zip"
    overlay = read_overlay(given.config.expanduser()) if given.config else packed_config(file)
    # nothing else of it, as the datasets follow from the run's own
    section = load_config({key: data for key, data in overlay.items() if key == "archive"}).archive
    config = merge(run.to_dict(), {"archive": section.model_dump(mode="json")})
    packed = pack(folder, Config.model_validate(config), named)
    for remark in packed.remarks:
        print(f"octsim: warning: {remark}", file=sys.stderr)
    print(packed)
    return 0


def run_verify(given: Namespace) -> int:
    """Verify an archive, or datasets; return the exit status."""
    from octsim.archive.verify import problems
    from octsim.archive.verify_datasets import is_of_datasets

    path = given.path.expanduser()
    if is_of_datasets(path):
        return _verify_datasets(path)
    lines = problems(path)
    for line in lines:
        print(f"octsim: {one_line(f'{path}: {line}')}", file=sys.stderr)
    if not lines:
        print(f"{path}: as it was packed")
    return int(bool(lines))


def _verify_datasets(path: Path) -> int:
    from octsim.archive.verify_datasets import verified

    whole, damaged, unknown = verified(path)
    for file in damaged:
        line = f"{file}: damaged: its bytes are not those that octsim wrote; run again to make it"
        print(f"octsim: {one_line(f'{line} anew')}", file=sys.stderr)
    if unknown:
        names = ", ".join(file.name for file in unknown)
        line = f"{path}: not known of {names}, without a digest of its bytes (as of octsim 0.2.0)"
        print(f"octsim: warning: {one_line(line)}", file=sys.stderr)
    if whole and not damaged:
        what = f", {len(whole)} datasets" if path.is_dir() else ""
        print(f"{path}: as it was written{what}")
    return 1 if damaged else 0 if whole else 2


def run_unpack(given: Namespace) -> int:
    """Unpack an archive."""
    from octsim.archive.verify import unpack

    file, folder = given.file.expanduser(), given.folder.expanduser()
    unpack(file, folder)
    print(f"{folder}: unpacked, as it was packed")
    return 0
