"""Gaussian fits: known curves come back, curves without a peak are named."""

import numpy as np
import pytest
import reference
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from octsim.stages.gaussian_fits import FitStatus, fit_gaussian, gaussian

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
