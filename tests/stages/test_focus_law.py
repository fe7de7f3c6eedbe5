"""The focus law: known lines come back, and where there is no law it is said."""

import re
import warnings

import numpy as np
import pytest
import reference
import xarray as xr
import yaml
from numpy.typing import NDArray
from swept import FOCI, xr_sweep

from octsim.base.errors import OctsimError, OctsimWarning
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.stages.centres import CentreUse
from octsim.stages.focus_law import fit_line, focus_law, sweep_foci
from octsim.stages.focus_sweep import focus_sweep
from octsim.stages.gaussian_fits import FitStatus, gaussian, gaussian_fits


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


def law_of(*intensity: NDArray[np.float64], **law: object) -> tuple[Config, xr.Dataset]:
    """Return the law of intensities at `FOCI` for diameters of 1 µm and so on."""
    diameters = {"start": "1 um", "stop": f"{len(intensity)} um", "num": len(intensity)}
    config = load_config({"focus_law": {"diameters": diameters, **law}})
    return config, focus_law(config, gaussian_fits(config, xr_sweep(np.stack(intensity))))


def peak(centre: float) -> NDArray[np.float64]:
    return gaussian(FOCI, centre, 0.05, 1.0, 0.1)


def test_two_centres_are_no_law() -> None:
    for last in (FOCI, peak(0.7)):
        config, law = law_of(peak(0.6), last)
        assert np.isnan(law["slope"])
        with pytest.raises(OctsimError, match=r"raise focus_law\.diameters\.num to 3 or more"):
            sweep_foci(config, law)


def test_a_law_is_fitted_to_the_centres_that_are_found() -> None:
    with pytest.warns(
        OctsimWarning, match=r"no Gaussian fits at 1 of 5 .*: 3 um \(no_interior_pea"
    ):
        _, law = law_of(peak(0.5), peak(0.55), FOCI, peak(0.66), peak(0.7))
    named = law["status"].attrs["flag_meanings"].split()
    assert [named[status] for status in law["status"].values] == [
        "fitted", "fitted", "no_interior_peak", "fitted", "fitted",
    ]  # fmt: skip
    expected = reference.law([1, 2, 4, 5], [0.5, 0.55, 0.66, 0.7])
    assert (law["slope"].item(), law["intercept"].item()) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("place", range(7))
def test_a_centre_far_off_neither_bends_the_law_nor_goes_unsaid(place: int) -> None:
    centres = 0.5 + 0.04 * np.arange(7) + np.array([1, -2, 0, 2, -1, 1, 0]) * 1e-3
    moved = centres.copy()
    moved[place] += 0.12 if place < 5 else -0.2
    with pytest.warns(OctsimWarning, match=rf"left out .* 1 of 7 diameters: {place + 1} um"):
        _, law = law_of(*map(peak, moved))
    diameter = np.arange(1.0, 8.0)
    rest = np.arange(7) != place
    expected = reference.law(diameter[rest].tolist(), centres[rest].tolist())
    assert (law["slope"].item(), law["intercept"].item()) == pytest.approx(expected, rel=1e-6)
    assert np.flatnonzero(law["centre_use"] == CentreUse.OFF_THE_LINE).tolist() == [place]


@pytest.mark.parametrize(
    "off",
    [np.array([0, 0, 0, 0.011, 0, 0]), 0.02 * np.array([1, -1, 1, 1, -1, -1])],
    ids=["less than is seen", "no more than the others"],
)
def test_scatter_stays_in_the_unweighted_law(off: NDArray[np.float64]) -> None:
    centres = 0.5 + 0.05 * np.arange(6) + off
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        _, law = law_of(*map(peak, centres))
    expected = reference.law(list(range(1, 7)), centres.tolist())
    assert (law["slope"].item(), law["intercept"].item()) == pytest.approx(expected, rel=1e-6)


def test_without_a_law_the_line_says_what_gives_one() -> None:
    config, law = law_of(np.zeros(41), np.zeros(41), np.zeros(41))
    with pytest.raises(
        OctsimError, match="there; give media whose indices differ, or raise detector"
    ):
        sweep_foci(config, law)
    config, law = law_of(np.ones(41), np.ones(41), np.ones(41))
    with pytest.raises(OctsimError, match=r"the same at all foci.*; bring focus_law\.fraction to"):
        sweep_foci(config, law)


@pytest.mark.parametrize("fraction", [(0.7, 0.9, 9), (0.4, 0.5, 5)], ids=["below", "above"])
def test_the_range_that_the_line_gives_has_the_peaks(fraction: tuple[float, float, int]) -> None:
    config = load_config(
        {
            "tracing": {"rays": 500},
            "focus_law": {
                "diameters": {"start": "1 um", "stop": "1.4 um", "num": 3},
                "fraction": dict(zip(("start", "stop", "num"), fraction, strict=True)),
            },
        }
    )
    law = focus_law(config, gaussian_fits(config, focus_sweep(config)))
    with pytest.raises(OctsimError, match="no_interior_peak, brightest at ") as said:
        sweep_foci(config, law)
    given = re.search(r"focus_law\.fraction: (\{.*?\})", str(said.value))
    assert given
    wider = load_config(config.to_dict(), {"focus_law": {"fraction": yaml.safe_load(given[1])}})
    law = focus_law(wider, gaussian_fits(wider, focus_sweep(wider)))
    assert sweep_foci(wider, law) == pytest.approx(
        0.58 * wider.sweep.diameters.values() + 0.064, abs=0.05
    )


def test_a_narrow_peak_between_wide_foci_is_found() -> None:
    # 4.25 um was said to have no peak: its width is 0.037 of the range of foci
    config = load_config(
        {
            "objective": {
                "numerical_aperture": 1.0, "magnification": 40, "focus_distance": "3 mm",
            },
            "detector": {"core_diameter": "5 um"},
            "spectrum": {"wavelength": {"min": "780 nm", "max": "920 nm"}, "samples": 100},
            "scene": {"gap": "0 nm", "refractive_index": {"neuron": 1.38}},
            "focus_law": {"diameters": {"start": "4 um", "stop": "5 um", "num": 5}},
        }
    )  # fmt: skip
    fits = gaussian_fits(config, focus_sweep(config))
    assert (fits["status"] == FitStatus.FITTED).all()
    line = fit_line(fits["diameter"].values, fits["centre"].values)
    off = fits["centre"] - line.slope * fits["diameter"] - line.intercept
    assert np.abs(off).max() < 0.01
