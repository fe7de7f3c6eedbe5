"""The sweep over diameters: the light that reaches the detector."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import OctsimError
from octsim.base.threads import each_block
from octsim.config.grid import Combination, combinations
from octsim.config.models import Config, FocusLine
from octsim.config.scheme import scheme_of
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout, filling
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import LightAtPoint, Points
from octsim.optics.detector import Outcome
from octsim.schemes.light import AccuracyStatus, Light
from octsim.stages.focus_law import sweep_foci
from octsim.stages.scatter import WHOLE, Share

RAYS: Mapping[str, str] = {
    "path_code": "path",
    "amplitude": "amplitude",
    "rough_amplitude": "rough_amplitude",
    "optical_path_length": "optical_path_length",
}
"""What is stored of each ray, and its name in `Light`."""


@Streamed
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
        them); what was left out and whether the accuracy is reached (diameter); and, of a scheme
        that counts rays, how all segments of ray ended, outcomes(diameter, outcome).
    """
    named: Coordinate = "outcome", np.array([outcome.name.lower() for outcome in Outcome])
    schemes = combinations(config, "tracing.scheme", "tracing.preset")
    counted = any(scheme_of(at.config).counts_rays for at in schemes)

    def own(config: Config) -> dict[str, Coordinate]:
        swept = {"diameter": ("diameter", config.sweep.diameters.values())}
        return swept | ({"outcome": named} if counted else {})

    title = "Rays that reach the detector, for each diameter"
    layout = Layout("detections", config, title, own, "diameter")
    return Stream(layout, _detected(layout, law, points or Points(), threads, share))


def _detected(
    layout: Layout, law: xr.Dataset | None, points: Points, threads: int, share: Share
) -> Iterator[Part]:
    focus = _foci(layout, law)

    def points_of(block: tuple[Combination, slice]) -> Iterator[tuple[LightAtPoint, float, float]]:
        at, span = block
        heights = focus[at.position][span]
        dark = np.isnan(heights).all()
        light_at = _untraced if dark else Instrument(at.config, points).light
        diameters = layout.own[at.position]["diameter"][1][span]
        return ((light_at, d, z) for d, z in zip(diameters.tolist(), heights.tolist(), strict=True))

    blocks = share.blocks(layout)
    for (at, span), found in each_block(lambda p: p[0](p[1], p[2]), blocks, points_of, threads):
        variables = _light_variables(found, focus[at.position][span])
        if "outcome" in layout.own[at.position]:
            variables["outcomes"] = ("diameter", "outcome"), _outcomes(found)
        yield Part(at, span.start, len(found), variables)


def _foci(layout: Layout, law: xr.Dataset | None) -> dict[tuple[int, ...], NDArray[np.float64]]:
    """Return the foci of each combination; NaN where it has no law, unless none has one."""
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
