"""The focus law: known lines come back, and where there is no law it is said."""

import numpy as np
import pytest
import reference
import xarray as xr
from numpy.typing import NDArray

from octsim.config.load import load_config
from octsim.stages.focus_law import fit_line, focus_law
from octsim.stages.gaussian_fits import FitStatus, gaussian, gaussian_fits

FOCI = np.linspace(0.4, 0.9, 41)


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


def test_the_dataset_holds_the_literal_line_through_the_centres(
    stages: dict[str, xr.Dataset],
) -> None:
    fits, law = stages["gaussian_fits"], stages["focus_law"]
    expected = reference.law(fits["diameter"].values.tolist(), fits["centre"].values.tolist())
    assert (law["slope"].item(), law["intercept"].item()) == pytest.approx(expected, rel=1e-9)
    assert np.array_equal(law["status"], fits["status"])


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
