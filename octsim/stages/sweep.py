"""The sweep over diameters: detected rays, and the spectra that they sum to (figure 8)."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import OctsimError
from octsim.base.threads import each_block
from octsim.config.grid import Combination, combinations
from octsim.config.models import Config, FocusLine
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout, filling
from octsim.datasets.reader import Stored
from octsim.datasets.stage import Part, Stage, Stream
from octsim.instrument.instrument import Tracer, summer
from octsim.instrument.points import Points
from octsim.optics.band import wavenumbers
from octsim.optics.detector import Outcome
from octsim.schemes.light import AccuracyStatus, Light
from octsim.stages.cost_estimate import point_cost, points_per_block
from octsim.stages.scatter import WHOLE, Share

_ROUGH = 0.1  # of the largest intensity; an error that a slope does not survive
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


def focus_line(config: Config, law: xr.Dataset | None) -> FocusLine:
    """Give the line that the focus follows: the config's, or the fitted law.

    Raises
    ------
    OctsimError
        If the law is needed and could not be fitted, or there are several.
    """
    if isinstance(config.sweep.focus, FocusLine):
        return config.sweep.focus
    if law is not None and law["slope"].dims:
        raise OctsimError(
            "grid: given, and so several focus laws; do this without a grid, or give one focus as "
            "sweep.focus: {slope: 0.581, intercept: 69 nm}"
        )
    sweep_foci(config, law)  # says what is wrong with a law that does not serve
    return FocusLine.fitted(law)


@Stage
def detections(
    config: Config,
    law: xr.Dataset | None = None,
    threads: int = 1,
    points: Points | None = None,
    share: Share = WHOLE,
) -> Stream:
    """Trace every diameter of the sweep.

    Returns
    -------
    Dataset
        path_code, amplitude, rough_amplitude and optical_path_length (ray) of the rays that reach
        the detector, diameter after diameter (CF contiguous ragged: rays_detected(diameter) counts
        them); what was left out and whether the accuracy is reached (diameter); and, of the scheme
        vogel, how all segments of ray ended, outcomes(diameter, outcome).
    """
    whence = points or Points()

    named: Coordinate = "outcome", np.array([outcome.name.lower() for outcome in Outcome])
    schemes = combinations(config, "tracing.scheme", "tracing.preset")
    counted = any(at.config.tracing.scheme == "vogel" for at in schemes)

    def own(config: Config) -> dict[str, Coordinate]:
        swept = {"diameter": ("diameter", config.sweep.diameters.values())}
        return swept | ({"outcome": named} if counted else {})

    title = "Rays that reach the detector, for each diameter"
    layout = Layout("detections", config, title, __name__, own, "diameter")
    return Stream(layout, _detected(layout, law, whence, threads, share))


def _detected(
    layout: Layout, law: xr.Dataset | None, whence: Points, threads: int, share: Share
) -> Iterator[Part]:
    focus = _foci(layout, law)

    def points_of(block: tuple[Combination, slice]) -> Iterator[tuple[Tracer, float, float]]:
        at, span = block
        heights = focus[at.position][span]
        trace_at = _untraced if np.isnan(heights).all() else whence.tracer(at.config)
        diameters = layout.own[at.position]["diameter"][1][span]
        return ((trace_at, d, z) for d, z in zip(diameters.tolist(), heights.tolist(), strict=True))

    blocks = share.blocks(layout)
    for (at, span), found in each_block(lambda p: p[0](p[1], p[2]), blocks, points_of, threads):
        variables = _light_variables(found, focus[at.position][span])
        if "outcome" in layout.own[at.position]:
            variables["outcomes"] = ("diameter", "outcome"), _outcomes(found)
        yield Part(at, span.start, len(found), variables)


def _foci(layout: Layout, law: xr.Dataset | None) -> dict[tuple[int, ...], NDArray[np.float64]]:
    """Give the foci of each combination; NaN where there is no law, unless there is none at all."""
    stored = Stored(law, "focus_law", layout.config) if law is not None else None
    focus: dict[tuple[int, ...], NDArray[np.float64]] = {}
    failed: list[str] = []
    for at in layout.combinations:
        given = isinstance(at.config.sweep.focus, FocusLine)
        try:
            found = sweep_foci(at.config, None if given or stored is None else stored.part(at))
        except OctsimError as error:
            failed.append(f"{error} (at {at})" if at.values else str(error))
            found = np.full(layout.count(at), np.nan)
        focus[at.position] = found
    if len(failed) == len(layout.combinations):
        raise OctsimError(failed[0])
    return focus


def _untraced(_diameter: float, _focus: float) -> Light:
    none = np.empty(0)
    return Light(none.astype(np.int64), none, none, none, 0.0, 0, AccuracyStatus.NO_FOCUS)


def _light_variables(found: list[Light], focus: NDArray[np.float64]) -> dict[str, Any]:
    counts = np.array([light.amplitude.size for light in found])
    status = np.array([light.status for light in found])
    return {
        **{
            name: ("ray", np.concatenate([getattr(light, field) for light in found]))
            for name, field in RAYS.items()
        },
        "rays_detected": ("diameter", counts, {"sample_dimension": "ray"}),
        "segments_traced": ("diameter", np.array([light.segments for light in found])),
        "missing_field": ("diameter", np.array([light.missing for light in found])),
        "accuracy_status": ("diameter", *flags(AccuracyStatus, status)),
        "focus": ("diameter", focus),
    }


def _outcomes(found: list[Light]) -> NDArray[np.int64]:
    none = np.full(len(Outcome), filling(np.dtype(np.int64)))
    return np.stack([none if light.outcomes is None else light.outcomes for light in found])


def stored_light(detected: xr.Dataset) -> list[Light]:
    """Read the light of each diameter back from a plain dataset of the stage detections."""
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


@Stage
def spectra(config: Config, detected: xr.Dataset, threads: int = 1) -> Stream:
    """Sum the detected rays of each diameter to a spectrum.

    Returns
    -------
    Dataset
        intensity(diameter, wavenumber) and focus(diameter), with the estimated error of the
        intensity and whether that is as asked (diameter).
    """

    def own(config: Config) -> dict[str, Coordinate]:
        return {
            "diameter": ("diameter", config.sweep.diameters.values()),
            "wavenumber": ("wavenumber", wavenumbers(config.spectrum)),
        }

    title = "Spectrum of the detected light, for each diameter"
    layout = Layout("spectra", config, title, __name__, own, "diameter")
    return Stream(layout, _summed(layout, Stored(detected, "detections", config, layout), threads))


def _summed(layout: Layout, stored: Stored, threads: int) -> Iterator[Part]:
    parts: dict[int, xr.Dataset] = {}

    def points_of(block: tuple[Combination, slice]) -> Iterator[tuple[Any, Light]]:
        at, span = block
        part = stored.part(at, span)
        parts[id(block)] = part[["accuracy_status", "focus"]]
        sum_light = summer(at.config)
        return ((sum_light, light) for light in stored_light(part))

    def most(config: Config) -> int:
        return points_per_block(8 * config.spectrum.samples + point_cost(config).size)

    blocks = list(layout.blocks(most))
    for block, found in each_block(lambda p: p[0](p[1]), blocks, points_of, threads):
        (at, span), part = block, parts.pop(id(block))
        spectrum, error = zip(*found, strict=True)
        status = part["accuracy_status"].values
        if at.config.tracing.scheme == "paths":
            # the error is judged at the samples themselves
            late = np.array(error) > at.config.tracing.accuracy
            reached = status == AccuracyStatus.REACHED
            status = np.where(reached & late, AccuracyStatus.NOT_REACHED, status)
        nothing = np.where(status == AccuracyStatus.NO_FOCUS, np.nan, 0.0)
        variables = {
            "intensity": (("diameter", "wavenumber"), np.stack(spectrum) + nothing[:, None]),
            "intensity_error": ("diameter", np.array(error) + nothing),
            "accuracy_status": ("diameter", *flags(AccuracyStatus, status)),
            "focus": ("diameter", part["focus"].values),
        }
        yield Part(at, span.start, len(found), variables)


def doubts(measured: xr.Dataset) -> list[str]:
    """Say, a line each, where a run's spectra are not what one would want."""
    status, error = measured["accuracy_status"].values, measured["intensity_error"].values
    none = status == AccuracyStatus.NO_FOCUS
    fine = (AccuracyStatus.REACHED, AccuracyStatus.NOT_CONTROLLED, filling(status.dtype))
    missed = ~np.isin(status, fine) & ~none
    rough = (status == AccuracyStatus.NOT_CONTROLLED) & (error > _ROUGH)
    said = []
    if missed.any():
        said.append(
            f"the accuracy is not, or not surely, reached at {missed.sum()} of {missed.size} "
            f"points (accuracy_status says where and why; estimated error up to "
            f"{error[missed].max():.2g}): compare with tracing.scheme vogel, or ask for less by "
            "tracing.accuracy"
        )
    if rough.any():
        said.append(
            f"the estimated error of the intensity is above {_ROUGH} of its largest at "
            f"{rough.sum()} of {rough.size} points (intensity_error; up to "
            f"{error[rough].max():.2g}), so their slopes mean little: raise tracing.rays, or give "
            "tracing.preset"
        )
    if none.any():
        laws = none.reshape(-1, none.shape[-1]).all(axis=1)
        said.append(
            f"there is no focus law at {laws.sum()} of {laws.size} combinations, which are NaN "
            "(focus_law.nc has the status of each fit): give focus_law.fraction a wider range or "
            "more steps"
        )
    return said
