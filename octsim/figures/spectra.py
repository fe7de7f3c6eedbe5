"""The spectrum of one diameter, prepared for its Fourier transform (figure 8)."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from octsim.config.processing import Processing
from octsim.figures.style import BLUE, GREEN, SKY, label, tell, title
from octsim.phase.fringe_status import FringeStatus, doubts_of
from octsim.phase.transform import centred_by, windowed
from octsim.stages.spectra import doubts

DIAMETER = 1.4
"""Diameter that the thesis shows, µm; the nearest of the sweep is drawn."""


def figure_8(spectra: xr.Dataset, processing: Processing) -> Figure:
    """Draw the three stages of a spectrum's preparation (thesis fig. 8)."""
    spectrum = spectra.sel(diameter=DIAMETER, method="nearest")
    level = centred_by(spectrum["intensity"].values, processing)
    # the thesis's scale: the centred spectrum reaches from −1 to 1
    level = level / max(float(np.abs(level).max()), np.finfo(float).tiny)
    shaped = windowed(level, processing.window)
    figure = Figure()
    axes = figure.subplots()
    k = spectrum["wavenumber"]
    stages = (
        (level, SKY, "-", f"less its {processing.centre}"),
        (shaped, BLUE, "--", f"× {processing.window}"),
        (shaped - shaped.mean(), GREEN, "-.", "less the mean"),
    )
    for values, colour, line, text in stages:
        axes.plot(k, values, color=colour, linestyle=line, label=text)
    axes.set_xlabel(label(k))
    axes.set_ylabel("Intensity (largest = 1)")
    axes.set_title(title(spectra, f"Spectrum, diameter {float(spectrum['diameter']):.4g} µm"))
    figure.legend(loc="outside lower center", ncols=3)
    dark = (spectra["intensity"] == 0).all("wavenumber").values
    status = np.where(dark, FringeStatus.NO_LIGHT, FringeStatus.VISIBLE)
    tell(figure, [*doubts_of(status, "diameters"), *doubts(spectra)])
    return figure
