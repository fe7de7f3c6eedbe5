"""The sweep over diameters: detected rays, and the spectra that they sum to (figure 8)."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config import Config, FocusLine
from octsim.datasets import make
from octsim.detection import Outcome
from octsim.errors import OctsimError
from octsim.simulation import tracer
from octsim.spectrum import intensity, wavenumbers
from octsim.threads import each


def sweep_foci(config: Config, law: xr.Dataset | None) -> NDArray[np.float64]:
    """Give the focus of each diameter of the sweep, from the given line or the fitted law.

    Parameters
    ----------
    config : Config
        Its ``sweep.focus`` decides.
    law : Dataset or None
        The fitted law; needed only where ``sweep.focus`` is ``law``.

    Returns
    -------
    ndarray, shape (D,)
        Heights of the focus, µm.

    Raises
    ------
    OctsimError
        If the law is needed and could not be fitted, or asks for a focus out of the objective's
        reach.
    """
    diameters = config.sweep.diameters.values()
    if isinstance(config.sweep.focus, FocusLine):
        return config.sweep.focus.at(diameters)
    remedy = "or give one as sweep.focus: {slope: 0.581, intercept: 69 nm}"
    if law is None:
        raise OctsimError(f"sweep.focus: 'law' given, so fit and pass the focus law, {remedy}")
    if not np.isfinite(law["slope"]):
        named = law["status"].attrs["flag_meanings"].split()
        statuses = [named[status] for status in law["status"].values]
        failed = ", ".join(
            f"{diameter:.4g} um ({status})"
            for diameter, status in zip(law["diameter"].values, statuses, strict=True)
            if status != "fitted"
        )
        raise OctsimError(
            f"sweep.focus: 'law' given, but there is no law: no Gaussian fits at {failed}; change "
            f"focus_law.diameters, or give focus_law.fraction a wider range or more steps, {remedy}"
        )
    foci = FocusLine.fitted(law).at(diameters)
    if not foci.max() < config.objective.focus_distance:
        raise OctsimError(
            f"objective.focus_distance: {config.objective.focus_distance} um given, but the fitted "
            f"law asks for a focus at {foci.max():.6g} um; raise the distance, {remedy}"
        )
    return foci


def detections(config: Config, law: xr.Dataset | None = None, threads: int = 1) -> xr.Dataset:
    """Trace every diameter of the sweep.

    Returns
    -------
    Dataset
        amplitude and optical_path_length (ray) of the rays that reach the detector, diameter after
        diameter (CF contiguous ragged: rays_detected(diameter) counts them), and how all segments
        of ray ended, outcomes(diameter, outcome).
    """
    diameters, foci = config.sweep.diameters.values(), sweep_foci(config, law)
    trace_at = tracer(config)
    found = each(
        lambda point: trace_at(*point),
        zip(diameters.tolist(), foci.tolist(), strict=True),
        threads,
    )
    counts = np.array([d.amplitude.size for d in found])
    return make(
        "detections",
        config,
        "Rays that reach the detector, for each diameter",
        {
            "amplitude": ("ray", np.concatenate([d.amplitude for d in found])),
            "optical_path_length": (
                "ray",
                np.concatenate([d.optical_path_length for d in found]),
            ),
            "rays_detected": ("diameter", counts, {"sample_dimension": "ray"}),
            "segments_traced": ("diameter", np.array([d.segments for d in found])),
            "outcomes": (("diameter", "outcome"), np.stack([d.outcomes for d in found])),
            "focus": ("diameter", foci),
        },
        {"diameter": diameters, "outcome": [outcome.name.lower() for outcome in Outcome]},
        __name__,
    )


def spectra(config: Config, detected: xr.Dataset, threads: int = 1) -> xr.Dataset:
    """Sum the detected rays of each diameter to a spectrum.

    Returns
    -------
    Dataset
        intensity(diameter, wavenumber) and focus(diameter).
    """
    k = wavenumbers(config.spectrum)
    ends = np.cumsum(detected["rays_detected"].values)[:-1]
    amplitudes = np.split(detected["amplitude"].values, ends)
    paths = np.split(detected["optical_path_length"].values, ends)
    spectrum = each(lambda rays: intensity(*rays, k), zip(amplitudes, paths, strict=True), threads)
    return make(
        "spectra",
        config,
        "Spectrum of the detected light, for each diameter",
        {
            "intensity": (("diameter", "wavenumber"), np.stack(spectrum)),
            "focus": ("diameter", detected["focus"].values),
        },
        {"diameter": detected["diameter"].values, "wavenumber": k},
        __name__,
    )
