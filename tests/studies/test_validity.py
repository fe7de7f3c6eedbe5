"""Where rays can be believed: errors beside Maxwell's equations, and the map of them."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from missing import unexplained

from octsim.base.errors import ConfigError
from octsim.config.derive import changed
from octsim.config.load import load_config
from octsim.config.models import FocusLine
from octsim.datasets.files import read, write
from octsim.figures.style import look, save
from octsim.figures.validity import validity_figure
from octsim.instrument.instrument import Instrument
from octsim.phase.fringe_status import FringeStatus
from octsim.schemes.light import AccuracyStatus
from octsim.studies.validity import study
from octsim.studies.validity.cases import AS_CONFIGURED, cases
from octsim.studies.validity.errors import ESTIMATORS, FOCUS_MODES, Seen, differences, seen
from octsim.studies.validity.study import summary, validity, windows

RUN = load_config(
    {
        "tracing": {"rays": 3000},
        "spectrum": {"samples": 200},
        "sweep": {"focus": {"slope": 0.581, "intercept": "69 nm"}},
    }
)
LINE = FocusLine.model_construct(slope=0.581, intercept=0.069)


@pytest.fixture(scope="module")
def few() -> xr.Dataset:
    chosen = [c for c in cases(RUN) if c.name in (AS_CONFIGURED, "index 1.34", "gap 50 nm")]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "cases", lambda _: chosen)
        return validity(RUN, number=3)


def plate(depth: float, turned: float, bright: float = 1.0) -> Seen:
    """Return what is seen of a cosine of a depth, with no light traced."""
    k = np.linspace(7, 9.7, 50)
    spectrum = bright * (2 + np.cos(2 * depth * k + turned))
    return Seen(
        np.full((2, 2), depth), turned, 0.5, spectrum / spectrum.mean(), 0.0,
        FringeStatus.VISIBLE, AccuracyStatus.REACHED,
    )  # fmt: skip


def test_errors_are_those_of_known_differences() -> None:
    found = differences(plate(2.2, 3.0), plate(2.0, -3.0))
    assert found["ray_slope_error"] == pytest.approx(np.full((2, 2), 0.1))
    assert found["ray_phase_error"] == pytest.approx(6 - 2 * np.pi)  # whole turns are none
    assert found["ray_visibility_error"] == 0
    assert found["ray_spectrum_error"] > 0.1
    # brightness is none of a shape
    same = differences(plate(2.0, 1.0, bright=3.0), plate(2.0, 1.0))
    assert same["ray_spectrum_error"] == pytest.approx(0, abs=1e-15)


def test_a_focus_follows_its_line_or_is_held_and_both_have_one_middle() -> None:
    first, middle, last = windows(RUN, LINE, 3)
    assert [w.diameter[1] for w in (first, middle, last)] == [1.0, 1.5, 2.0]
    assert np.diff(middle.diameter) == pytest.approx([1 / 150, 1 / 150])
    follows, held = middle.foci
    assert follows == pytest.approx(0.581 * middle.diameter + 0.069)
    assert (held == held[1]).all()
    assert follows[1] == held[1]
    wide = changed(RUN, {"sweep": {"diameters": {"num": 3}}})
    # the phase turns by less than π over a step whatever the sweep's own is
    assert np.diff(windows(wide, LINE, 2)[0].diameter).max() <= study.LARGEST_STEP + 1e-12


def test_the_slopes_of_a_window_are_those_of_a_sweep() -> None:
    case, window = cases(RUN)[0], windows(RUN, LINE, 3)[1]
    own = Instrument(case.rays[0])
    found = seen(own, window)
    for mode, foci in zip(range(2), window.foci, strict=True):
        spectra = own.spectra(window.diameter, foci)
        components = np.fft.rfft(
            (spectra - (spectra.max(1) + spectra.min(1))[:, None] / 2) * np.hamming(200), axis=1
        )
        strongest = 1 + np.abs(components[1, 1:]).argmax()
        phase = np.unwrap(np.angle(components[:, strongest]))
        expected = (phase[2] - phase[0]) / (window.diameter[2] - window.diameter[0])
        assert found.slope[mode, 0] == pytest.approx(expected, rel=1e-9)


def test_one_quantity_is_varied_at_a_time_in_rays_and_waves_alike() -> None:
    every = cases(RUN)
    assert len({case.name for case in every}) == len(every)
    for case in every:
        for rays in case.rays:
            given = case.exact.objective.pupil
            assert rays.pupil == ("uniform" if given is None else given)
            assert rays.objective.numerical_aperture == case.exact.objective.numerical_aperture
            assert rays.swept_index == case.exact.swept_index
            assert rays.scene.swept_gap == case.exact.scene.swept_gap
    base = every[0].exact
    for case in every[1:]:
        moved = {
            "pupil": case.exact.objective.pupil != base.objective.pupil,
            "NA": case.exact.objective.numerical_aperture != base.objective.numerical_aperture,
            "index": case.exact.swept_index != base.swept_index,
            "gap": case.exact.scene.swept_gap != base.scene.swept_gap,
        }
        assert not any(is_moved for name, is_moved in moved.items() if name != case.quantity)


def test_a_case_beyond_the_scheme_is_left_out_and_a_config_beyond_it_is_refused() -> None:
    # water of a lower index: the aperture 1.3 is above it
    dry = changed(RUN, {"scene": {"refractive_index": {"water": 1.25}}})
    names = {case.name for case in cases(dry)}
    assert "NA 1.2" in names
    assert "NA 1.3" not in names
    beyond = changed(RUN, {"objective": {"numerical_aperture": 1.4}})
    with pytest.raises(ConfigError, match=r"objective\.numerical_aperture: 1\.4 given"):
        cases(beyond)


def test_the_map_counts_the_diameters_within_each_bound(few: xr.Dataset) -> None:
    error = few["ray_slope_error"].values
    for place, bound in enumerate(study.BOUNDS):
        expected = (np.abs(error) <= bound).mean(axis=-1)
        assert np.array_equal(few["share_within"].values[..., place], expected)
    rays = few["ray_phase_slope"].sel(case=AS_CONFIGURED)
    away = rays - few["exact_phase_slope"].sel(case=AS_CONFIGURED)
    slope = few["exact_phase_slope"].sel(case=AS_CONFIGURED).mean("diameter")
    expected = away.mean("diameter") / slope
    xr.testing.assert_allclose(few["mean_slope_error"].sel(case=AS_CONFIGURED), expected)
    sure = away.std("diameter", ddof=1) / np.sqrt(3) / slope
    found = few["mean_slope_error_standard_error"].sel(case=AS_CONFIGURED)
    xr.testing.assert_allclose(found, sure)


def test_of_spectra_without_a_fringe_there_is_no_error(few: xr.Dataset) -> None:
    # a neuron of nearly the index of water
    faint = few["fringe_status"] == FringeStatus.NO_FRINGE
    slopes = few["exact_phase_slope"].transpose("case", "diameter", ...).values
    assert np.isnan(slopes[faint.values]).all()
    assert np.isfinite(few["ray_slope_error"].sel(case=AS_CONFIGURED)).all()


def test_light_paths_and_many_rays_agree_where_maxwell_does_not(few: xr.Dataset) -> None:
    # what is measured is the model's error, not that of a number of rays
    one = few["ray_slope_error"].sel(case=AS_CONFIGURED, estimator="sinusoid", focus_mode="held")
    assert np.abs(one.sel(ray_scheme="vogel") - one.sel(ray_scheme="paths")).max() < 0.02
    assert np.abs(one.sel(ray_scheme="paths")).max() > 0.03


def test_the_study_is_kept_told_and_drawn(few: xr.Dataset, tmp_path: Path) -> None:
    write(few, tmp_path / "validity.nc")
    kept = read(tmp_path / "validity.nc", "validity", RUN)
    xr.testing.assert_equal(kept, few)
    assert few["accuracy_status"].max() == AccuracyStatus.REACHED
    assert few["focus_mode"].values.tolist() == list(FOCUS_MODES)
    mean = few.isel(case=0).sel(ray_scheme="paths", focus_mode="follows")["mean_slope_error"]
    for estimator in ESTIMATORS:
        assert f"{estimator} {float(mean.sel(estimator=estimator)):+.1%}" in summary(kept)
    with look():
        save(validity_figure(kept), tmp_path / "validity.png")
    assert (tmp_path / "validity.png").stat().st_size > 10_000


def test_a_status_says_why_a_number_is_missing(few: xr.Dataset) -> None:
    assert list(unexplained(few)) == []
