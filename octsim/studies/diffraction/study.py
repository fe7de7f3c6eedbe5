"""Rays as the rulings of a Gaussian beam, beside Maxwell's equations (`snakemake diffraction`)."""

import math
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import ConfigError
from octsim.base.threads import each
from octsim.config.derive import changed, counting_rays, nested
from octsim.config.following import scan_diameter, scan_foci
from octsim.config.maxwell import beyond_maxwell, by_maxwell
from octsim.config.models import Config, FocusLine
from octsim.datasets.files import flags, make
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.phase.estimators.sinusoid import sinusoid
from octsim.phase.slopes import line_slope, slope_of
from octsim.studies.diffraction.peaks import WINDOWS, PeakStatus, peak_within
from octsim.studies.validity.errors import by_estimator

Array = NDArray[np.float64]
RAYS, ONE, EACH, UNIFORM, FIBRE = (
    "rays", "rulings, one wavelength", "rulings, each wavelength", "Maxwell, uniform pupil",
    "Maxwell, fibre's mode",
)  # fmt: skip
FOCI, DIAMETERS = 201, 51
"""Foci of the scan, and diameters of the sweep; both over the config's ranges."""
LAW = FocusLine.model_construct(slope=0.581, intercept=0.069)
"""The thesis's focus law, for all: what is compared has the same foci."""
OFFSETS = (-0.05, 0.05)
"""Of the focus from the law, µm."""
_SPARSE = 2
"""Of the diameters every second is looked at with the focus off the law."""


def instruments(config: Config) -> dict[str, Config]:
    """Return the instruments that are compared.

    Raises
    ------
    ConfigError
        If Maxwell's equations are not solved for the config.
    """
    if reason := beyond_maxwell(config):
        raise ConfigError(f"{reason}, for diffraction")
    plain = counting_rays(config)
    middle = f"{2e3 * math.pi / config.spectrum.middle:.6g} nm"
    return {
        RAYS: changed(plain, {"beam": {"waist": "none"}}),
        ONE: changed(plain, {"beam": {"waist": "diffraction", "wavelength": middle}}),
        EACH: changed(plain, {"beam": {"waist": "diffraction", "wavelength": "each"}}),
        UNIFORM: changed(by_maxwell(config), nested("objective.pupil", "uniform")),
        FIBRE: changed(by_maxwell(config), nested("objective.pupil", None)),
    }


def diffraction(
    config: Config,
    threads: int = 1,
    points: Points | None = None,
    foci: int = FOCI,
    diameters: int = DIAMETERS,
) -> xr.Dataset:
    """Compare rays that are defocused on purpose with Maxwell's equations.

    The thesis suggests it (its section 7): a bundle that is defocused as wide as the diffraction
    limit would broaden the peaks of figure 6, and may make the slope less dependent on the focus.
    Its rays are the rulings of a Gaussian beam's hyperboloid here, both families at half the
    weight. Phases are by a least-squares sinusoid at the nominal depth of each diameter.

    Parameters
    ----------
    config : Config
    threads : int
        How many points are at work at a time.
    points : Points, optional
        Where light that was found before is kept.
    foci, diameters : int
        How many.

    Returns
    -------
    Dataset
        intensity (case, focus), the mean over the band; peak_focus, peak_width, peak_height and
        peak_status (case, peak); estimated_phase and phase_slope (case, diameter),
        mean_phase_slope, the slope of the line through the phase, and
        phase_slope_standard_deviation (case); from plain rays slope_change and local_slope_change
        (case); and the mean slope with the focus off the law, offset_phase_slope (case,
        focus_offset).

    Raises
    ------
    ConfigError
        If Maxwell's equations are not solved for the config.
    """
    every = {name: Instrument(one, points) for name, one in instruments(config).items()}
    scan, sweep = scan_foci(config), config.sweep.diameters
    heights = np.linspace(scan.start, scan.stop, foci)
    diameter = np.linspace(sweep.start, sweep.stop, diameters)
    sparse = diameter[::_SPARSE]

    def scan_by(instrument: Instrument) -> Array:
        def mean_at(focus: float) -> float:
            return instrument.brightness(instrument.light(scan_diameter(config), focus)).mean

        return np.array(list(each(mean_at, heights.tolist(), threads)))

    def phase_of(instrument: Instrument, at: Array, foci: Array) -> Array:
        spectra, k = instrument.spectra(at, foci, threads), instrument.wavenumber
        processing = by_estimator(config.processing, "sinusoid")
        phases = sinusoid(spectra, k, instrument.nominal_depth(at), processing, instrument.power)
        return np.unwrap(phases.phase)

    intensity, phase, off = [], [], []
    for instrument in every.values():
        intensity.append(scan_by(instrument))
        phase.append(phase_of(instrument, diameter, LAW.at(diameter)))
        rows = (phase_of(instrument, sparse, LAW.at(sparse) + by) for by in OFFSETS)
        off.append([line_slope(sparse, row) for row in rows])
    return make(
        "diffraction",
        config,
        "Rays as rulings of a Gaussian beam beside Maxwell's equations",
        _variables(config, heights, np.stack(intensity), diameter, np.stack(phase), np.array(off)),
        {
            "case": list(every),
            "focus": heights,
            "peak": list(WINDOWS),
            "diameter": diameter,
            "focus_offset": np.array(OFFSETS),
        },
    )


def _variables(
    config: Config, heights: Array, intensity: Array, diameter: Array, phase: Array, off: Array
) -> dict[str, Any]:
    size = scan_diameter(config)
    found = [
        [peak_within(heights, row, a * size, b * size) for a, b in WINDOWS.values()]
        for row in intensity
    ]
    peaks, status = np.array(found), np.array([[one.status for one in row] for row in found])
    slope = np.stack([slope_of(diameter, row) for row in phase])
    mean = np.array([line_slope(diameter, row) for row in phase])
    change = slope - slope[0]
    local = np.sqrt(((change - change.mean(axis=1, keepdims=True)) ** 2).mean(axis=1))
    return {
        "intensity": (("case", "focus"), intensity),
        **{
            f"peak_{name}": (("case", "peak"), peaks[..., place])
            for place, name in enumerate(("focus", "width", "height"))
        },
        "peak_status": (("case", "peak"), *flags(PeakStatus, status)),
        "estimated_phase": (("case", "diameter"), phase),
        "phase_slope": (("case", "diameter"), slope),
        "mean_phase_slope": ("case", mean),
        "phase_slope_standard_deviation": ("case", slope.std(axis=1)),
        "slope_change": ("case", mean - mean[0]),
        "local_slope_change": ("case", local),
        "offset_phase_slope": (("case", "focus_offset"), off),
    }


def summary(table: xr.Dataset) -> str:
    """Return in one line what the rulings change of the slope, and what Maxwell's equations do."""
    change = table["slope_change"]
    return (
        "mean phase slope from that of rays: by rulings "
        f"{float(change.sel(case=EACH)):+.3f} mrad/nm, by Maxwell's equations "
        f"{float(change.sel(case=UNIFORM)):+.3f}"
    )
