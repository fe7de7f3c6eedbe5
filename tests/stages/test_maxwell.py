"""A run by rays beside Maxwell's equations: the same points, solved and estimated by themselves."""

import numpy as np
import pytest
import xarray as xr
from made_runs import every_stage

import octsim
from octsim.config.derive import merge
from octsim.stages.maxwell import summary

SMALL = {
    "tracing": {"preset": "standard"},
    "focus_scan": {"focus": {"num": 3}},
    "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 5}},
    "sweep": {"diameters": {"start": "1.3 um", "stop": "1.4 um", "num": 11},
              "focus": {"slope": 0.581, "intercept": "69 nm"}},
}  # fmt: skip


@pytest.fixture(scope="module")
def run() -> dict[str, xr.Dataset]:
    return every_stage(octsim.load_config(SMALL))


def test_both_slopes_are_those_of_whole_runs_at_the_same_diameters(
    run: dict[str, xr.Dataset],
) -> None:
    exact = every_stage(octsim.load_config(merge(SMALL, {"tracing": {"preset": "exact"}})))
    compared = run["maxwell"]
    assert compared["diameter"].size == 5
    for name, whole in (("ray", run), ("exact", exact)):
        own = whole["phase_slope"]["phase_slope"].sel(diameter=compared["diameter"])
        assert np.allclose(compared[f"{name}_phase_slope"].sel(by="run"), own, rtol=1e-12)
        visible = whole["fourier"]["fringe_visibility"].sel(diameter=compared["diameter"])
        assert np.allclose(compared[f"{name}_visibility"], visible, rtol=1e-12, equal_nan=True)


def test_a_run_says_how_far_it_is_from_maxwell_s_equations(run: dict[str, xr.Dataset]) -> None:
    compared = run["maxwell"]
    off = (compared["ray_phase_slope"] / compared["exact_phase_slope"] - 1).sel(by="least_squares")
    assert f"{100 * float(off.mean()):+.1f} %" in summary(compared)
    assert "tracing: {preset: exact}" in summary(compared)


def test_where_waves_cannot_do_the_scene_it_is_not_known_and_said_so() -> None:
    steep = merge(SMALL, {"objective": {"numerical_aperture": 1.35}})
    made = every_stage(octsim.load_config(steep))
    assert np.isnan(made["maxwell"]["exact_phase_slope"]).all()
    assert "not known" in summary(made["maxwell"])


def test_a_run_by_waves_has_none() -> None:
    exact = every_stage(octsim.load_config(merge(SMALL, {"tracing": {"preset": "exact"}})))
    assert "maxwell" not in exact
