"""The spectrum of one diameter, prepared for its Fourier transform (figure 8)."""

from collections.abc import Callable, Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from octsim.config.processing import Processing
from octsim.figures.recorded import config_in
from octsim.figures.style import BLACK, BLUE, SKY, label, tell, title
from octsim.phase.fringe_status import FringeStatus, doubts_of
from octsim.phase.transform import centred_by, prepared, windowed, without_source
from octsim.stages.spectra import doubts

DIAMETER = 1.4
"""Diameter that the thesis shows, µm; the nearest of the sweep is drawn."""
_CENTRES: Mapping[str, Callable[[Processing], str]] = {
    "midpoint": lambda _: "its midpoint, (max + min)/2",
    "mean": lambda _: "its mean",
    "weighted": lambda one: f"its mean, weighted by the {_window(one)} window",
    "polynomial": lambda one: (
        f"its polynomial of degree {one.centre_degree}, weighted by the {_window(one)} window"
    ),
}
_OF_THE_LAST = ("fft", "zero_padded", "hilbert", "fringe")
"""Estimators whose phase is of the spectrum after the last step."""


def figure_8(spectra: xr.Dataset, processing: Processing) -> Figure:
    """Draw the steps of a spectrum's preparation (thesis fig. 8), as the run takes them."""
    spectrum = spectra.sel(diameter=DIAMETER, method="nearest")
    intensity = spectrum["intensity"].values
    source = config_in(spectra).spectrum.power()
    bare = without_source(intensity, source)
    # the thesis's scale: the centred spectrum reaches from −1 to 1
    level = centred_by(bare, processing)
    scale = max(float(np.abs(level).max()), np.finfo(float).tiny)
    figure = Figure(figsize=(6.4, 4.8))
    axes = figure.subplots()
    k = spectrum["wavenumber"]
    error = float(spectrum["intensity_error"]) * float(intensity.max()) / scale
    axes.fill_between(
        k, level / scale - error, level / scale + error, color=SKY, alpha=0.3, linewidth=0,
        label="± estimated error of the spectrum",
    )  # fmt: skip
    for values, colour, line, text in (
        (level, SKY, "-", _centred(processing, source)),
        (windowed(level, processing.window), BLUE, "--", f"then × {_window(processing)} window"),
        (prepared(bare, processing), BLACK, "-.", _last(processing)),
    ):
        axes.plot(k, values / scale, color=colour, linestyle=line, label=text)
    axes.set_xlabel(label(k))
    axes.set_ylabel("Intensity (largest = 1)")
    axes.set_title(title(spectra, f"Spectrum, diameter {float(spectrum['diameter']):.4g} µm"))
    figure.legend(loc="outside lower center", fontsize=9)
    dark = (spectra["intensity"] == 0).all("wavenumber").values
    status = np.where(dark, FringeStatus.NO_LIGHT, FringeStatus.VISIBLE)
    tell(figure, [*doubts_of(status, "diameters"), *doubts(spectra)])
    return figure


def _window(processing: Processing) -> str:
    """Name a window, with its parameters if it has some."""
    if isinstance(processing.window, str):
        return processing.window
    name, *parameters = processing.window
    return f"{name} ({', '.join(f'{one}' for one in parameters)})"


def _centred(processing: Processing, source: NDArray[np.float64] | None) -> str:
    """Say what is subtracted before the window."""
    of = "spectrum less " if source is None else "spectrum less the source's own, and less "
    return of + _CENTRES[processing.centre](processing)


def _last(processing: Processing) -> str:
    """Say what is done last, and what becomes of the spectrum then."""
    name = processing.estimator
    if name in _OF_THE_LAST:
        own = "" if name == "fft" else f"; the phase is by {name.replace('_', ' ')} of this"
    else:
        own = f"; the phase is by {name.replace('_', ' ')}, of the spectrum itself"
    return f"then less the mean that is left: transformed{own}"
