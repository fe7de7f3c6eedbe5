"""Runs that are written once: no test changes them in place."""

from pathlib import Path

import pytest
import xarray as xr
from made_once import Once
from report_runs import full_run, written

from octsim.report.page import report


def reported(folder: Path) -> Path:
    report(folder)
    return folder


@pytest.fixture(scope="session")
def plain(stages: dict[str, xr.Dataset], once: Once) -> Path:
    """Write a run without anything beside it, and its report."""
    return once.made("plain", lambda folder: reported(written(stages, folder / "whole")))


@pytest.fixture(scope="session")
def full(once: Once, calibrated: xr.Dataset) -> Path:
    """Write a run with everything beside it that a report shows, and its report."""
    return once.made("full", lambda folder: reported(full_run(folder / "looked", calibrated)))
