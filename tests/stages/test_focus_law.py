"""Gaussian fits and the focus law: known curves come back, curves without a peak are named."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from octsim.config.load import load_config
from octsim.stages.focus_law import fit_line, focus_law
from octsim.stages.gaussian_fits import FitStatus, fit_gaussian, gaussian, gaussian_fits

FOCI = np.linspace(0.4, 0.9, 41)


@given(st.floats(0.5, 0.8), st.floats(0.03, 0.15), st.floats(1e-9, 1e3), st.floats(0, 1))
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
    ],
    ids=["flat", "rising", "dip", "peak outside"],
)
def test_no_peak_between_the_foci_is_nan_with_a_status(intensity: NDArray[np.float64]) -> None:
    fit = fit_gaussian(FOCI, intensity)
    assert fit.status is not FitStatus.FITTED
    assert np.isnan(fit.parameters).all()
    assert np.isnan(fit.standard_errors).all()


def test_a_line_comes_back_with_textbook_standard_errors() -> None:
    x, y = np.array([1.0, 2.0, 3.0, 4.0]), np.array([1.1, 1.9, 3.2, 3.8])
    line = fit_line(x, y)
    # s² = Σ residual²/(n − 2); se(slope) = s/√Sxx; se(intercept) = s √(1/n + x̄²/Sxx)
    rest = y - line.slope * x - line.intercept
    s, sxx = np.sqrt(np.sum(rest**2) / 2), np.sum((x - x.mean()) ** 2)
    assert line.slope == pytest.approx(np.sum((x - x.mean()) * (y - y.mean())) / sxx)
    assert line.intercept == pytest.approx(y.mean() - line.slope * x.mean())
    assert line.slope_standard_error == pytest.approx(s / np.sqrt(sxx))
    assert line.intercept_standard_error == pytest.approx(s * np.sqrt(1 / 4 + x.mean() ** 2 / sxx))


def test_two_points_are_a_line_without_an_error() -> None:
    line = fit_line(np.array([1.0, 2.0]), np.array([3.0, 5.0]))
    assert line[:2] == pytest.approx((2.0, 1.0))
    assert np.isnan(line[2:]).all()


def test_one_missing_centre_leaves_no_law() -> None:
    diameters = {"start": "1 um", "stop": "2 um", "num": 2}
    config = load_config({"focus_law": {"diameters": diameters}})
    sweep = xr_sweep(np.stack([gaussian(FOCI, 0.6, 0.1, 1.0, 0.0), FOCI]))
    fits = gaussian_fits(config, sweep)
    assert fits["status"].attrs["flag_meanings"] == "fitted no_interior_peak not_converged"
    assert fits["status"].values[0] == FitStatus.FITTED
    assert fits["status"].values[1] != FitStatus.FITTED
    assert np.isnan(fits["centre"].values).tolist() == [False, True]
    assert np.isnan(focus_law(config, fits)["slope"])


def xr_sweep(intensity: NDArray[np.float64]) -> xr.Dataset:
    return xr.Dataset(
        {
            "intensity": (("diameter", "fraction"), intensity),
            "focus": (("diameter", "fraction"), np.tile(FOCI, (len(intensity), 1))),
        },
        {"diameter": np.arange(1.0, 1.0 + len(intensity))},
    )
