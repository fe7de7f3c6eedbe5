"""A reference arm, and plates: the thesis's section 2 measured (`snakemake interferometers`)."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.derive import with_flat_source
from octsim.config.models import Config
from octsim.datasets.files import flags, make
from octsim.optics.two_beams import predicted_phase_slope
from octsim.phase.slopes import phase_slopes
from octsim.phase.transform import fourier_components, optical_depths
from octsim.studies.interferometers.michelson import michelson
from octsim.studies.interferometers.plates import ClosedForm, Plates, plates

Array = NDArray[np.float64]
SHOWN = 1.4
"""Thickness whose spectrum and transform are shown, µm; the nearest of the sweep's."""


def interferometers(config: Config, threads: int = 1) -> xr.Dataset:
    """Measure a Michelson interferometer, and plates over a thickness, as the thesis has them.

    Plates are made of the run's media; the one that is swept takes the neuron's place, and its
    thicknesses are the sweep's diameters. Phases are those of the Fourier transform's strongest
    component.

    Parameters
    ----------
    config : Config
    threads : int
        How many spectra are found at a time.

    Returns
    -------
    Dataset
        Of the Michelson interferometer michelson_intensity and michelson_closed_form (wavenumber),
        michelson_magnitude (component) and, over the length of the arm, one_wavelength_intensity
        and band_intensity (arm). Of each kind of plates plates_intensity (case, wavenumber) and
        magnitude (case, component) at one thickness, phase_slope (case, diameter), its mean and
        scatter (case), and plates_error (case), the largest difference of a spectrum from Airy's
        sum over the largest intensity; plates_error_status says where there is no such sum.
    """
    config = with_flat_source(config)  # as the closed forms have it
    k, diameter = config.spectrum.wavenumbers(), config.sweep.diameters.values()
    seen = michelson(config)
    found = list(plates(config, diameter, threads))
    shown = int(np.abs(diameter - SHOWN).argmin())
    magnitude = np.abs(fourier_components(seen.intensity[np.newaxis], config.processing))[0]
    variables: dict[str, Any] = {
        "michelson_intensity": ("wavenumber", seen.intensity),
        "michelson_closed_form": ("wavenumber", seen.closed_form),
        "michelson_magnitude": ("component", magnitude),
        "one_wavelength_intensity": ("arm", seen.one_wavelength),
        "band_intensity": ("arm", seen.band),
        "predicted_phase_slope": predicted_phase_slope(config.swept_index, k[0], k[-1]),
        "shown_thickness": diameter[shown],
        **_of_plates(config, diameter, found, shown),
    }
    depths = optical_depths(k)
    return make(
        "interferometers",
        config,
        "A Michelson interferometer, and plates over a thickness",
        variables,
        {
            "wavenumber": k,
            "component": np.arange(depths.size),
            "depth": ("component", depths),
            "arm": seen.arm,
            "case": [one.name for one in found],
            "diameter": diameter,
        },
    )


def _of_plates(
    config: Config, diameter: Array, found: list[Plates], shown: int
) -> dict[str, tuple[Any, ...]]:
    magnitude, slope, error = [], [], []
    for one in found:
        components = fourier_components(one.spectra, config.processing)
        magnitude.append(np.abs(components)[shown])
        found_slopes = phase_slopes(diameter, np.abs(components), np.angle(components))
        slope.append(found_slopes.strongest)
        off = np.nan
        if one.closed_form is not None:
            off = float(np.abs(one.spectra - one.closed_form).max() / one.closed_form.max())
        error.append(off)
    slopes = np.stack(slope)
    return {
        "plates_intensity": (("case", "wavenumber"), np.stack([f.spectra[shown] for f in found])),
        "magnitude": (("case", "component"), np.stack(magnitude)),
        "phase_slope": (("case", "diameter"), slopes),
        "mean_phase_slope": ("case", slopes.mean(axis=1)),
        "phase_slope_standard_deviation": ("case", slopes.std(axis=1)),
        "plates_error": ("case", np.array(error)),
        "plates_error_status": (
            "case",
            *flags(ClosedForm, np.array([one.compared for one in found])),
        ),
    }


def summary(table: xr.Dataset) -> str:
    """Return in one line the slope of two plates, beside the prediction."""
    two = table.isel(case=1)
    return (
        f"phase slope of {two['case'].item()}: {float(two['mean_phase_slope']):.3f} ± "
        f"{float(two['phase_slope_standard_deviation']):.3f} mrad/nm, eq. (2) "
        f"{float(table['predicted_phase_slope']):.3f}"
    )
