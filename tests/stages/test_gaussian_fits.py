"""Gaussian fits: known curves come back, curves without a peak are named."""

import math

import numpy as np
import pytest
import reference
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import least_squares
from swept import FOCI, xr_sweep

from octsim.config.load import load_config
from octsim.stages.centres import doubts_of_fits
from octsim.stages.fit_errors import StandardErrorStatus
from octsim.stages.gaussian_fits import FitStatus, fit_gaussian, gaussian, gaussian_fits


@given(st.floats(0.5, 0.8), st.floats(0.008, 0.25), st.floats(1e-9, 1e3), st.floats(0, 1))
def test_a_gaussian_comes_back(
    centre: float, width: float, amplitude: float, offset: float
) -> None:
    fit = fit_gaussian(FOCI, gaussian(FOCI, centre, width, amplitude, offset * amplitude))
    assert fit.status is FitStatus.FITTED
    assert fit.parameters[0] == pytest.approx(centre, abs=1e-8)
    assert fit.parameters[1] == pytest.approx(width, rel=1e-6)
    assert fit.parameters[2] == pytest.approx(amplitude, rel=1e-6)
    assert fit.parameters[3] == pytest.approx(offset * amplitude, abs=1e-6 * amplitude)
    assert fit.residual < 1e-7 * amplitude


@given(st.floats(0.42, 0.88), st.floats(0.0005, 0.008))
def test_a_peak_that_few_foci_are_on_is_found_within_two_steps(centre: float, width: float) -> None:
    intensity = gaussian(FOCI, centre, width, 1.0, 0.1)
    intensity[0] += 0.01  # or nothing but rounding may be left of a peak between two foci
    fit = fit_gaussian(FOCI, intensity)
    if intensity.argmax() == 0:
        assert fit.status is FitStatus.NO_INTERIOR_PEAK
    else:
        assert fit.status is FitStatus.FITTED
        # one focus alone may be on it
        assert abs(fit.parameters[0] - centre) < 2 * (FOCI[1] - FOCI[0])


SHAPES = {
    "side lobes": gaussian(FOCI, 0.6, 0.03, 1, 0) * (1 + 0.4 * np.cos((FOCI - 0.6) * 60)),
    "two peaks": gaussian(FOCI, 0.5, 0.02, 1, 0) + gaussian(FOCI, 0.8, 0.03, 0.7, 0),
    "asymmetric": np.where(
        FOCI < 0.55, gaussian(FOCI, 0.55, 0.02, 1, 0), gaussian(FOCI, 0.55, 0.1, 1, 0)
    ),
    "on a slope": 2 * FOCI + gaussian(FOCI, 0.6, 0.05, 2, 0),
    "broad": gaussian(FOCI, 0.7, 0.8, 1, 0) * (1 + 0.03 * FOCI),
    "jumps": gaussian(FOCI, 0.6, 0.05, 1, 0.1) + 0.08 * (np.arange(41) * 7919 % 13 / 6 - 1),
}


@pytest.mark.parametrize("intensity", SHAPES.values(), ids=SHAPES)
def test_no_start_leads_to_a_peak_that_leaves_less(intensity: NDArray[np.float64]) -> None:
    fit = fit_gaussian(FOCI, intensity)
    assert fit.status is FitStatus.FITTED
    found = [
        least_squares(
            lambda p: gaussian(FOCI, *p) - intensity, [centre, width, np.ptp(intensity), 0.0],
            bounds=([FOCI[0], 0.00625, 0, -np.inf], [FOCI[-1], 5, np.inf, np.inf]),
            x_scale=[0.1, 0.1, 1, 1], xtol=1e-12, ftol=1e-12, gtol=None,
        )
        for centre in np.linspace(0.42, 0.88, 9)
        for width in (0.01, 0.03, 0.1, 0.3)
    ]  # fmt: skip
    best = min(found, key=lambda one: one.cost)
    assert fit.residual**2 * FOCI.size <= 2 * best.cost * (1 + 1e-6)


def test_the_answer_does_not_hang_on_where_the_foci_are_counted_from() -> None:
    intensity = SHAPES["jumps"]
    fit, turned = fit_gaussian(FOCI, intensity), fit_gaussian(-FOCI[::-1], intensity[::-1])
    assert -turned.parameters[0] == pytest.approx(fit.parameters[0], abs=1e-9)
    assert turned.parameters[1:] == pytest.approx(fit.parameters[1:], rel=1e-7)


def test_foci_without_a_number_are_left_out() -> None:
    intensity = gaussian(FOCI, 0.6, 0.05, 1.0, 0.2)
    intensity[::5] = np.nan
    assert fit_gaussian(FOCI, intensity).parameters[0] == pytest.approx(0.6)


@pytest.mark.parametrize("intensity", [np.zeros(41), np.full(41, np.nan)], ids=["dark", "nothing"])
def test_no_light_is_named(intensity: NDArray[np.float64]) -> None:
    assert fit_gaussian(FOCI, intensity).status is FitStatus.NO_LIGHT


@pytest.mark.parametrize("reached", [0.45, 0.6, 0.88])
def test_a_plateau_up_to_the_last_or_from_the_first_focus_is_no_peak(reached: float) -> None:
    rise = np.minimum(FOCI, reached)
    for intensity in (rise, rise[::-1].copy()):
        fit = fit_gaussian(FOCI, intensity)
        assert fit.status is FitStatus.NO_INTERIOR_PEAK
        assert np.isnan(fit.parameters).all()


def test_a_width_is_the_standard_deviation_of_the_gaussian() -> None:
    at = np.array([0.0, 1.0, 2.0])
    assert gaussian(at, 0.0, 1.0, 2.0, 0.5) == pytest.approx(
        [2.5, 0.5 + 2 / math.sqrt(math.e), 0.5 + 2 / math.e**2]
    )
    # half of the height is at 2 √(2 ln 2) widths apart
    half = math.sqrt(2 * math.log(2)) * 0.3
    assert gaussian(np.array([half]), 0.0, 0.3, 1.0, 0.0) == pytest.approx([0.5])


def test_noise_makes_no_peak_of_a_rise() -> None:
    rng = np.random.default_rng(4)
    fits = [fit_gaussian(FOCI, 5 * FOCI + rng.normal(0, 0.05, 41)) for _ in range(20)]
    assert FitStatus.FITTED not in {fit.status for fit in fits}


def test_what_a_single_peak_does_not_show_is_said() -> None:
    config = load_config({"focus_law": {"diameters": {"start": "1 um", "stop": "2 um", "num": 2}}})
    sweep = xr_sweep(np.stack([SHAPES["side lobes"], SHAPES["two peaks"]]))
    (several,) = doubts_of_fits(gaussian_fits(config, sweep))
    assert "leaves more than 0.1 of the intensity's range" in several
    assert "at 1 of 2 diameters: 2 um (fitted" in several


def test_standard_errors_are_those_of_repeated_noisy_fits() -> None:
    rng = np.random.default_rng(3)
    clean = gaussian(FOCI, 0.62, 0.1, 1.0, 0.2)
    fits = [fit_gaussian(FOCI, clean + rng.normal(0, 0.02, FOCI.size)) for _ in range(400)]
    scatter = np.std([fit.parameters for fit in fits], axis=0)
    stated = np.median([fit.standard_errors for fit in fits], axis=0)
    assert np.allclose(stated, scatter, rtol=0.15)


@pytest.mark.parametrize(
    "intensity",
    [
        np.ones_like(FOCI),
        FOCI,
        -gaussian(FOCI, 0.6, 0.1, 1.0, 0.0),
        gaussian(FOCI, 0.2, 0.1, 1.0, 0.0),
        1 + 1e-14 * gaussian(FOCI, 0.6, 0.1, 1.0, 0.0),
        1 - np.exp(-8 * FOCI),
    ],
    ids=["flat", "rising", "dip", "peak outside", "rounding", "saturating"],
)
def test_no_peak_between_the_foci_is_nan_with_a_status(intensity: NDArray[np.float64]) -> None:
    fit = fit_gaussian(FOCI, intensity)
    assert fit.status is not FitStatus.FITTED
    assert np.isnan(fit.parameters).all()
    assert np.isnan(fit.standard_errors).all()


def test_the_dataset_holds_the_literal_fit_of_each_diameter(stages: dict[str, xr.Dataset]) -> None:
    swept, fits = stages["focus_sweep"], stages["gaussian_fits"]
    assert (fits["status"] == FitStatus.FITTED).all()
    for row in range(fits.sizes["diameter"]):
        foci, intensity = swept["focus"].values[row], swept["intensity"].values[row]
        expected = reference.fit_gaussian(foci.tolist(), intensity.tolist())
        found = fits.isel(diameter=row)
        names = ("centre", "width", "amplitude", "offset")
        own = [found[name].item() for name in names]
        literal = [getattr(expected, name) for name in names]
        # its least squares stop at coarser tolerances
        assert own == pytest.approx(literal, rel=1e-3)
        left = [np.mean((intensity - reference.gaussian(foci, *p)) ** 2) for p in (own, literal)]
        assert left[0] <= left[1] * (1 + 1e-12)
        assert found["residual"].item() == pytest.approx(np.sqrt(left[0]))


def test_errors_that_the_foci_do_not_tell_have_a_status() -> None:
    foci = np.linspace(0, 1, 11)
    many = fit_gaussian(foci, gaussian(foci, 0.5, 0.2, 1.0, 0.1) + 1e-3 * np.cos(40 * foci))
    assert many.error_status == StandardErrorStatus.KNOWN
    four = np.array([0.0, 0.4, 0.6, 1.0])
    bent = np.array([0.0, 0.01, 0.0, 0.02])
    few = fit_gaussian(four, gaussian(four, 0.5, 0.2, 1.0, 0.1) + bent)
    assert few.status == FitStatus.FITTED
    assert np.isnan(few.standard_errors).all()
    assert few.error_status == StandardErrorStatus.TOO_FEW
    dark = fit_gaussian(foci, 0 * foci)
    assert dark.error_status == StandardErrorStatus.NOT_FITTED
