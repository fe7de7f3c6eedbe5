"""Runs that are written once: no test changes them in place."""

from pathlib import Path

import pytest
import xarray as xr
from report_runs import full_run, written

from octsim.report.page import report


@pytest.fixture(scope="session")
def plain(stages: dict[str, xr.Dataset], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write a run without anything beside it, and its report."""
    folder = written(stages, tmp_path_factory.mktemp("plain") / "whole")
    report(folder)
    return folder


@pytest.fixture(scope="session")
def full(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write a run with everything beside it that a report shows, and its report."""
    folder = full_run(tmp_path_factory.mktemp("full") / "looked")
    report(folder)
    return folder
