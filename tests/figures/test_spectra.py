"""Figure 8: its steps are those of the run's processing, by name and by number."""

import json
from typing import Any

import numpy as np
import pytest
import xarray as xr
from made_runs import WHOLE
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

import octsim
from octsim.figures.spectra import DIAMETER, figure_8
from octsim.phase.transform import prepared, without_source

SOURCE = {"gaussian": {"centre": "760 nm", "fwhm": "120 nm"}}


def drawn(spectra: xr.Dataset, config: octsim.Config) -> Axes:
    recorded = spectra.assign_attrs(config=json.dumps(config.to_record()))
    (axes,) = figure_8(recorded, config.processing).axes
    return axes


def names(axes: Axes) -> list[str]:
    return [str(line.get_label()) for line in axes.lines]


@pytest.mark.parametrize(
    ("processing", "source", "expected"),
    [
        ({}, "flat", [
            "spectrum less its midpoint, (max + min)/2", "then × hamming window",
            "then less the mean that is left: transformed",
        ]),
        ({"centre": "mean", "window": ["kaiser", 8.6], "estimator": "hilbert"}, "flat", [
            "spectrum less its mean", "then × kaiser (8.6) window",
            "then less the mean that is left: transformed; the phase is by hilbert of this",
        ]),
        ({"centre": "polynomial", "centre_degree": 2, "estimator": "sinusoid"}, "flat", [
            "spectrum less its polynomial of degree 2, weighted by the hamming window",
            "then × hamming window",
            "then less the mean that is left: transformed; the phase is by sinusoid, of the "
            "spectrum itself",
        ]),
        ({"centre": "weighted", "window": "hann"}, SOURCE, [
            "spectrum less the source's own, and less its mean, weighted by the hann window",
            "then × hann window", "then less the mean that is left: transformed",
        ]),
    ],
)  # fmt: skip
def test_each_step_has_the_name_of_what_the_processing_does(
    processing: dict[str, Any], source: object, expected: list[str],
    stages: dict[str, xr.Dataset],
) -> None:  # fmt: skip
    more = {"processing": processing, "spectrum": {"source": source}}
    axes = drawn(stages["spectra"], octsim.load_config(WHOLE, more))
    assert names(axes) == expected


def test_the_last_step_is_what_the_fourier_transform_is_taken_of(
    stages: dict[str, xr.Dataset],
) -> None:
    """With a source too, whose own spectrum is subtracted first."""
    config = octsim.load_config(WHOLE, {"spectrum": {"source": SOURCE}})
    axes = drawn(stages["spectra"], config)
    one = stages["spectra"].sel(diameter=DIAMETER, method="nearest")
    last = prepared(
        without_source(one["intensity"].values, config.spectrum.power()), config.processing
    )
    shown = np.asarray(axes.lines[-1].get_ydata())
    np.testing.assert_allclose(shown / np.abs(shown).max(), last / np.abs(last).max(), atol=1e-12)


def test_the_error_of_the_spectrum_is_a_band_of_that_width(stages: dict[str, xr.Dataset]) -> None:
    axes = drawn(stages["spectra"], octsim.load_config(WHOLE))
    one = stages["spectra"].sel(diameter=DIAMETER, method="nearest")
    (band,) = (one for one in axes.collections if isinstance(one, PolyCollection))
    corners = np.concatenate([path.vertices for path in band.get_paths()])
    at = corners[corners[:, 0] == one["wavenumber"].values[500], 1]
    intensity = one["intensity"].values
    width = 2 * float(one["intensity_error"]) * intensity.max() / (np.ptp(intensity) / 2)
    np.testing.assert_allclose(np.ptp(at), width)
