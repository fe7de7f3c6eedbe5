"""What the scripts about stated accuracies share: their seed, verdicts and docs' tables."""

import argparse
import hashlib
import subprocess
from pathlib import Path

import numpy as np
import pandas as pd

from octsim.schemes.light import AccuracyStatus

ROOT = Path(__file__).parents[1]


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add what each of the scripts can be asked for."""
    parser.add_argument("--seed")
    parser.add_argument("--table", type=Path, help="a CSV file for every point")
    parser.add_argument("--write", action="store_true")


def seeded(given: str | None) -> tuple[str, np.random.Generator]:
    """Return a seed, the hash of the commit unless one is given, and what it makes random."""
    seed = given or subprocess.run(
        ["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.strip()  # fmt: skip
    number = int.from_bytes(hashlib.sha256(seed.encode()).digest()[:8], "big")
    return seed, np.random.default_rng(number)


def judged(table: pd.DataFrame) -> pd.DataFrame:
    """Add whether a point is wrong in silence, or unsure though it is right."""
    reached = table.status == AccuracyStatus.REACHED
    right = table.true <= table.accuracy
    surely = table.true - table.reference_error > table.accuracy
    return table.assign(
        reached=reached, wrong=reached & surely, open=reached & ~right & ~surely,
        unsure=~reached & right, warned=~reached & ~right, understated=table.true > table.stated,
    )  # fmt: skip
