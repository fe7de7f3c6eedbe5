"""Where a value is missing a status beside it says why, in every dataset of a run."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pytest
import xarray as xr
from gridded import GIVEN, SMALL, gridded, run_of_grid
from made_runs import WHOLE, every_stage
from missing import unexplained

import octsim
from octsim.config.grid import combinations
from octsim.config.models import Config
from octsim.datasets.catalog import CATALOG
from octsim.datasets.keys import stages_of
from octsim.datasets.reader import Stored
from octsim.datasets.status_variables import STATUSES
from octsim.datasets.statuses import TOLD_BY, statuses_of, with_statuses
from octsim.datasets.variables import MEANINGS, meaning

DARK = {"scene": {"refractive_index": {"neuron": 1.33}}}
"""Nothing is reflected but by the glass: some spectra have no fringe."""
RUNS: dict[str, tuple[dict[str, Any], ...]] = {
    "no fringe": (SMALL, GIVEN, DARK),
    "no fringe, sinusoid": (SMALL, GIVEN, DARK, {"processing": {"estimator": "sinusoid"}}),
    "fields at samples": (SMALL, GIVEN, {"polarisation": {"input": "unpolarised"}}),
    "paths that come and go": (
        SMALL, GIVEN,
        {
            "tracing": {"scheme": "paths", "accuracy": 1e-3},
            "sweep": {"diameters": {"start": "0.4 um", "stop": "4 um"}},
        },
    ),
}  # fmt: skip
Run = Mapping[str, xr.Dataset]


def parts_of(config: Config, run: Run) -> Iterator[xr.Dataset]:
    """Return each combination's own datasets: where these end, a grid's are filled with NaN."""
    for name, dataset in run.items():
        for at in combinations(config):
            if name in stages_of(at.config):
                yield Stored(dataset, name, config).part(at)


def wrong(config: Config, run: Run) -> list[str]:
    return [line for part in parts_of(config, run) for line in unexplained(part)]


def test_of_a_whole_run(stages: Run) -> None:
    assert wrong(octsim.load_config(WHOLE), stages) == []


@pytest.mark.parametrize("name", RUNS)
def test_of_runs_in_which_much_is_missing(name: str) -> None:
    config = octsim.load_config(*RUNS[name])
    run = octsim.run(config, "phase_slope", "paths")
    assert wrong(config, run) == []
    if name == "paths that come and go":
        assert run["paths"]["field_phase"].isnull().any()


@pytest.mark.parametrize("name", ["waves", "estimators", "sizes"])
def test_of_each_combination_of_a_grid(name: str) -> None:
    config, run = run_of_grid(name)
    assert wrong(config, run) == []


def test_of_a_combination_without_a_focus_law() -> None:
    config = gridded({"focus_law.fraction.stop": [0.8, 0.42]})
    run = every_stage(config)
    assert wrong(config, run) == []
    assert run["focus_law"]["law_status"].values.tolist() == [0, 1]


def test_the_table_is_of_datasets_and_variables_that_there_are() -> None:
    assert set(TOLD_BY) <= set(CATALOG)
    for stage, told in TOLD_BY.items():
        for status, names in told.items():
            assert status in MEANINGS, (stage, status)
            for name in names.split():
                assert meaning(name)["long_name"], (stage, name)


def test_every_status_of_missing_values_tells_of_a_variable() -> None:
    assert set(STATUSES) <= {status for told in TOLD_BY.values() for status in told}


def test_a_variable_names_its_statuses_as_cf_has_it(stages: Run) -> None:
    phase = stages["fourier"]["phase"]
    assert phase.attrs["ancillary_variables"] == "phase_status"
    assert statuses_of("fourier", "depth") == {}


def test_a_status_that_an_older_file_lacks_is_not_named() -> None:
    found = xr.Dataset({"phase": ("x", np.array([np.nan])), "fringe_visibility": 1.0})
    linked = with_statuses(found.assign(fringe_status=0), "fourier")
    assert "ancillary_variables" not in linked["phase"].attrs
    assert linked["fringe_visibility"].attrs["ancillary_variables"] == "fringe_status"
