"""The sweep over diameters: detected rays, and the spectra that they sum to (figure 8)."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config import Config, FocusLine
from octsim.datasets import flags, make
from octsim.detection import Outcome
from octsim.errors import OctsimError
from octsim.light import AccuracyStatus, Light
from octsim.simulation import summer, tracer
from octsim.spectrum import wavenumbers
from octsim.threads import each

RAYS: Mapping[str, str] = {
    "path_code": "path",
    "amplitude": "amplitude",
    "rough_amplitude": "rough_amplitude",
    "optical_path_length": "optical_path_length",
}
"""What is stored of each ray, and its name in `Light`."""


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
        path_code, amplitude, rough_amplitude and optical_path_length (ray) of the rays that reach
        the detector, diameter after diameter (CF contiguous ragged: rays_detected(diameter) counts
        them); what was left out and whether the accuracy is reached (diameter); and, of the scheme
        vogel, how all segments of ray ended, outcomes(diameter, outcome).
    """
    diameters, foci = config.sweep.diameters.values(), sweep_foci(config, law)
    trace_at = tracer(config)
    found = each(
        lambda point: trace_at(*point),
        zip(diameters.tolist(), foci.tolist(), strict=True),
        threads,
    )
    counts = np.array([light.amplitude.size for light in found])
    status = np.array([light.status for light in found])
    variables: dict[str, Any] = {
        **{
            name: ("ray", np.concatenate([getattr(light, field) for light in found]))
            for name, field in RAYS.items()
        },
        "rays_detected": ("diameter", counts, {"sample_dimension": "ray"}),
        "segments_traced": ("diameter", np.array([light.segments for light in found])),
        "missing_field": ("diameter", np.array([light.missing for light in found])),
        "accuracy_status": ("diameter", *flags(AccuracyStatus, status)),
        "focus": ("diameter", foci),
    }
    coordinates: dict[str, Any] = {"diameter": diameters}
    outcomes = [light.outcomes for light in found if light.outcomes is not None]
    if outcomes:
        variables["outcomes"] = (("diameter", "outcome"), np.stack(outcomes))
        coordinates["outcome"] = [outcome.name.lower() for outcome in Outcome]
    return make(
        "detections",
        config,
        "Rays that reach the detector, for each diameter",
        variables,
        coordinates,
        __name__,
    )


def stored_light(detected: xr.Dataset) -> list[Light]:
    """Read the light of each diameter back from a dataset of the stage detections."""
    ends = np.cumsum(detected["rays_detected"].values)[:-1]
    rays = [np.split(detected[name].values, ends) for name in RAYS]
    return [
        Light(path, amplitude, rough, optical, missing, segments, AccuracyStatus(status))
        for path, amplitude, rough, optical, missing, segments, status in zip(
            *rays,
            detected["missing_field"].values.tolist(),
            detected["segments_traced"].values.tolist(),
            detected["accuracy_status"].values.tolist(),
            strict=True,
        )
    ]


def spectra(config: Config, detected: xr.Dataset, threads: int = 1) -> xr.Dataset:
    """Sum the detected rays of each diameter to a spectrum.

    Returns
    -------
    Dataset
        intensity(diameter, wavenumber) and focus(diameter), with the estimated error of the
        intensity and whether that is as asked (diameter).
    """
    spectrum, error = zip(*each(summer(config), stored_light(detected), threads), strict=True)
    status = detected["accuracy_status"].values
    if config.tracing.scheme == "paths":
        # the error is judged at the samples themselves
        late = (status == AccuracyStatus.REACHED) & (np.array(error) > config.tracing.accuracy)
        status = np.where(late, AccuracyStatus.NOT_REACHED, status)
    return make(
        "spectra",
        config,
        "Spectrum of the detected light, for each diameter",
        {
            "intensity": (("diameter", "wavenumber"), np.stack(spectrum)),
            "intensity_error": ("diameter", np.array(error)),
            "accuracy_status": ("diameter", *flags(AccuracyStatus, status)),
            "focus": ("diameter", detected["focus"].values),
        },
        {"diameter": detected["diameter"].values, "wavenumber": wavenumbers(config.spectrum)},
        __name__,
    )


def unreached(measured: xr.Dataset) -> str | None:
    """Say in a line at how many points the accuracy asked for is not reached, if at any."""
    status = measured["accuracy_status"].values
    missed = (status != AccuracyStatus.REACHED) & (status != AccuracyStatus.NOT_CONTROLLED)
    if not missed.any():
        return None
    worst = float(measured["intensity_error"].values[missed].max())
    return (
        f"the accuracy is not, or not surely, reached at {missed.sum()} of {missed.size} points "
        f"(accuracy_status says where and why; estimated error up to {worst:.2g}): compare with "
        "tracing.scheme vogel, or ask for less by tracing.accuracy"
    )
