"""The trade of cost for accuracy: errors fall with it, the frontier is one, presets are points."""

import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from missing import unexplained
from numpy.typing import NDArray

from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.datasets.files import read, write
from octsim.figures.style import look, save
from octsim.figures.tradeoff import tradeoff_figure, truth_figure
from octsim.schemes.table import PRESETS
from octsim.studies.tradeoff.errors import intensity_errors, shape_errors, why_no_maxwell
from octsim.studies.tradeoff.frontier import cost_of_rays, efficient, power_law
from octsim.studies.tradeoff.settings import OF_WAVES, is_the_runs, preset_of, settings
from octsim.studies.tradeoff.study import summary, tradeoff

TINY = load_config({
    "spectrum": {"samples": 100},
    "focus_law": {
        "diameters": {"start": "1 um", "stop": "1.4 um", "num": 2},
        "fraction": {"num": 5},
    },
    "sweep": {
        "diameters": {"start": "1 um", "stop": "1.02 um", "num": 3},
        "focus": {"slope": 0.581, "intercept": "69 nm"},
    },
})  # fmt: skip
CHOSEN = {
    "tracing.rays": (300, 1000, 3000, 10_000),
    "tracing.accuracy": (1e-1, 3e-2, 1e-3, 1e-4, 1e-6, 1e-8),
    OF_WAVES: (1e-2, 1e-4, 1e-8),
    "tracing.max_intersections": (3, 7),
    "tracing.min_amplitude": (0, 1e-3),
    "spectrum.samples": (50,),
    "sweep.diameters.num": (5,),
}

TRIED = ("attenuation of neuron 100 /cm", "falloff top hat")


@pytest.fixture(scope="module")
def measured() -> xr.Dataset:
    chosen = [s for s in settings(TINY) if s.value in CHOSEN.get(s.factor, ())]
    return tradeoff(TINY, 2, chosen=chosen, separate=False, tried=TRIED)


def of(measured: xr.Dataset, factor: str, name: str) -> NDArray[np.float64]:
    return np.asarray(measured[name].values[measured["factor"].values == factor])


def test_errors_fall_with_rays_and_with_the_accuracy_that_is_asked_for(
    measured: xr.Dataset,
) -> None:
    by_rays = of(measured, "tracing.rays", "worst_intensity_error")
    assert (np.diff(by_rays) < 0).all()
    asked = of(measured, "tracing.accuracy", "value")
    got = of(measured, "tracing.accuracy", "worst_intensity_error")
    assert (got <= asked).all()
    assert not of(measured, "tracing.accuracy", "beyond_accuracy").any()
    few = of(measured, "tracing.max_intersections", "beyond_accuracy")
    assert few.tolist() == [TINY.sweep.diameters.num] * 2
    assert got[-1] < 1e-3 * got[0]
    slope = of(measured, "tracing.accuracy", "phase_slope_rms_error")
    assert slope[-1] < 1e-3 * slope[0]
    segments = of(measured, "tracing.accuracy", "segments_per_diameter")
    # a tenth of the error is not to be had for less; a third of it may be
    assert (segments[2:] > segments[:-2]).all()


def test_what_a_factor_leaves_out_shows(measured: xr.Dataset) -> None:
    few, more = of(measured, "tracing.max_intersections", "worst_intensity_error")
    assert few > 0.1 > 1e-3 > more
    none, some = of(measured, "tracing.min_amplitude", "intensity_change")
    assert none == 0 < some < 1e-2
    # fewer samples are no error of the intensity, which is that of the same wavenumbers
    assert of(measured, "spectrum.samples", "worst_intensity_error") < 1e-6
    assert of(measured, "spectrum.samples", "phase_slope_rms_error") > 1e-3


def beaten(point: tuple[float, float], points: list[tuple[float, float]]) -> bool:
    return any(o[0] <= point[0] and o[1] <= point[1] and o != point for o in points)


def test_the_frontier_holds_no_point_that_another_one_beats(measured: xr.Dataset) -> None:
    found = [str(factor).startswith("tracing.") for factor in measured["factor"].values]
    by_rays = [
        one and factor != OF_WAVES
        for one, factor in zip(found, measured["factor"].values, strict=True)
    ]
    for cost, error, name, traced in (
        ("segments_per_diameter", "worst_intensity_error", "frontier", by_rays),
        ("cpu_seconds", "phase_slope_rms_error", "phase_slope_frontier", by_rays),
        ("cpu_seconds", "maxwell_spectrum_worst_error", "maxwell_frontier", found),
        ("cpu_seconds", "maxwell_slope_rms_error", "maxwell_slope_frontier", found),
    ):
        points = list(
            zip(measured[cost].values.tolist(), measured[error].values.tolist(), strict=True)
        )
        mine = [p for p, one in zip(points, traced, strict=True) if one and math.isfinite(p[1])]
        for point, one, flag in zip(points, traced, measured[name].values, strict=True):
            assert flag == (one and math.isfinite(point[1]) and not beaten(point, mine))


def test_the_frontier_of_random_points_is_that_of_brute_force() -> None:
    points = np.random.default_rng(1).integers(0, 12, (2, 60)).astype(float)
    points[1, :3] = np.nan
    listed = [(cost, error) for cost, error in points.T.tolist() if error == error]
    for (cost, error), flag in zip(points.T.tolist(), efficient(*points), strict=True):
        assert flag == (error == error and not beaten((cost, error), listed))


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_is_a_setting_of_the_trade(name: str) -> None:
    (setting,) = [s for s in settings(Config()) if preset_of(s) == name]
    asked = load_config({"tracing": {"preset": name}})
    assert is_the_runs(setting, asked)


def test_the_runs_own_setting_is_marked_once(measured: xr.Dataset) -> None:
    assert measured["default"].values.sum() == 1
    own = measured.isel(setting=int(measured["default"].values.argmax()))
    assert (own["factor"].item(), own["value"].item()) == ("tracing.rays", 3000)
    other = load_config({"tracing": {"rays": 1234}})
    listed = settings(other)
    assert [s.factor for s in listed if is_the_runs(s, other)][-1] == "tracing.min_amplitude"
    paths = load_config({"tracing": {"scheme": "paths", "accuracy": 2e-4}})
    last = settings(paths)[-1]
    assert (last.factor, last.config) == ("run", paths)
    assert [s for s in settings(paths) if is_the_runs(s, paths)] == [last]


def test_intensity_errors_are_relative_to_the_references_maximum() -> None:
    exact = np.array([[1.0, 4.0], [0.0, 0.0]])
    off = intensity_errors(exact + np.array([[0.2, -0.4], [0.0, 0.0]]), exact)
    assert off[0] == pytest.approx(0.1)
    assert np.isnan(off[1])


def test_what_an_error_costs_is_measured_or_by_the_power_law() -> None:
    segments = np.array([1e3, 1e4, 1e5])
    error = 5 / segments
    assert power_law(segments, error) == pytest.approx((5, -1))
    for target, needed, measured in ((2e-4, 2.5e4, 1), (error[1], 1e4, 1), (1e-6, 5e6, 0)):
        assert cost_of_rays(segments, error, target) == pytest.approx((needed, measured))


def test_the_dataset_explains_itself_and_is_drawn(measured: xr.Dataset, tmp_path: Path) -> None:
    for name, variable in measured.variables.items():
        assert variable.attrs["units"], name
        assert variable.attrs["long_name"], name
    write(measured, tmp_path / "tradeoff.nc")
    stored = read(tmp_path / "tradeoff.nc", "tradeoff", TINY)
    assert "this run" in summary(stored)
    assert "standard" in summary(stored)
    with look():
        save(tradeoff_figure(stored), tmp_path / "tradeoff.png")
        save(truth_figure(stored), tmp_path / "truth.png")


def test_rays_converge_to_their_own_limit_and_stay_off_maxwells(measured: xr.Dataset) -> None:
    rays = of(measured, "tracing.accuracy", "maxwell_spectrum_worst_error")
    assert of(measured, "tracing.accuracy", "worst_intensity_error")[-1] < 1e-7
    # the diffraction of the pupil, which no number of rays has, is percents of the light
    assert 0.01 < rays[-1] == pytest.approx(rays[-2], rel=1e-4)
    slope = of(measured, "tracing.accuracy", "maxwell_slope_rms_error")
    assert slope[-1] == pytest.approx(slope[-2], rel=1e-3)
    assert slope[-1] >= abs(of(measured, "tracing.accuracy", "maxwell_slope_bias")[-1])


def test_waves_converge_to_maxwell_and_have_no_segments(measured: xr.Dataset) -> None:
    asked = of(measured, OF_WAVES, "value")
    own = of(measured, OF_WAVES, "worst_intensity_error")
    assert (own <= asked).all()
    # a shape's error is that of the intensity, and at most that of its mean beside it
    true = of(measured, OF_WAVES, "maxwell_spectrum_worst_error")
    assert (true <= 4 * own).all()
    assert np.isnan(of(measured, OF_WAVES, "segments_per_diameter")).all()
    assert not of(measured, OF_WAVES, "frontier").any()
    assert of(measured, OF_WAVES, "maxwell_frontier")[-1] == 1
    assert np.isnan(of(measured, "spectrum.samples", "maxwell_spectrum_worst_error")).all()
    assert "fullwave at 1e-09" in measured.attrs["maxwell"]


def test_where_maxwell_is_not_solved_the_trade_is_one_of_rays_and_says_why() -> None:
    steep = load_config({
        **TINY.to_dict(),
        "objective": {"numerical_aperture": 1.4},
    })  # fmt: skip
    assert "fullwave" in why_no_maxwell(steep)
    assert OF_WAVES not in {setting.factor for setting in settings(steep, waves=False)}
    chosen = [s for s in settings(steep, waves=False) if s.value == 300]
    trade = tradeoff(steep, 2, chosen=chosen, separate=False, tried=())
    assert np.isnan(trade["maxwell_spectrum_worst_error"]).all()
    assert trade.attrs["maxwell"] == why_no_maxwell(steep)
    with look():
        truth_figure(trade)


def test_a_shape_is_the_spectrum_over_its_mean() -> None:
    exact = np.array([[1.0, 3.0, 2.0]])
    assert shape_errors(5 * exact, exact) == pytest.approx(0)
    # means 2 and 2.5: shapes 0.5, 1.5, 1 and 0.4, 1.2, 1.4
    assert shape_errors(np.array([[1.0, 3.0, 3.5]]), exact) == pytest.approx(0.4 / 1.5)


def test_effects_cost_and_change_what_they_do_by_each_scheme(measured: xr.Dataset) -> None:
    assert measured["effect"].values.tolist() == list(TRIED)
    schemes = ["vogel, 3000 rays", "paths, 0.0001", "paths, 1e-06", "fullwave, 0.0001"]
    assert measured["effect_scheme"].values.tolist() == schemes
    taken, top_hat = measured["effect_intensity_change"].values
    status = measured["effect_status"].values
    # of a neuron of 1 µm, twice through: 1 − e^(−2 · 0.01 / µm), of a part of the field
    assert ((taken[:] > 1e-3) & (taken[:] < 0.04)).all()
    assert taken[1] == pytest.approx(taken[2], rel=1e-2)
    assert (top_hat[:3] > 1).all()
    # what a scheme can't do has a status beside its NaN
    assert np.isnan(top_hat[3])
    assert status[1].tolist() == [0, 0, 0, 1]
    ratio = measured["effect_cost_ratio"].values
    assert (np.isfinite(ratio) == np.isfinite(measured["effect_intensity_change"].values)).all()
    assert (ratio[np.isfinite(ratio)] > 0).all()


def test_a_status_says_why_a_number_is_missing(measured: xr.Dataset) -> None:
    assert list(unexplained(measured)) == []


def test_a_setting_s_status_names_the_reason_of_each_missing_number(measured: xr.Dataset) -> None:
    def told(status: str, factor: str) -> set[str]:
        one = measured[status][measured["factor"].values == factor]
        words = one.attrs["flag_meanings"].split()
        return {words[code] for code in one.values.tolist()}

    assert told("segments_status", OF_WAVES) == {"by_waves"}
    assert told("segments_status", "tracing.rays") == {"measured"}
    assert told("law_error_status", OF_WAVES) == {"no_law"}
    assert told("rays_law_status", "tracing.accuracy") == {"other_factor"}
    assert told("maxwell_status", "spectrum.samples") == {"not_of_the_trade"}
