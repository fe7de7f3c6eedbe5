"""The sweep over diameters: the rays that reach the detector."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.grid import Combination, combinations
from octsim.config.models import Config
from octsim.config.scheme import scheme_of
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout, filling
from octsim.datasets.streams import Stream, Streamed
from octsim.instrument.points import Points
from octsim.optics.detector import Outcome
from octsim.schemes.light import AccuracyStatus, Light
from octsim.stages.scatter import WHOLE, Share
from octsim.stages.swept_light import swept_diameters, swept_light

RAYS: Mapping[str, str] = {
    "path_code": "path",
    "amplitude": "amplitude",
    "rough_amplitude": "rough_amplitude",
    "optical_path_length": "optical_path_length",
}
"""What is stored of each ray, and its name in `Light`."""
_NONE = np.empty(0)
_NOTHING = Light(_NONE.astype(np.int64), _NONE, _NONE, _NONE, 0.0, 0, AccuracyStatus.NO_FOCUS)


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
        return swept_diameters(config) | ({"outcome": named} if counted else {})

    def variables_of(found: Sequence[Light], _: Combination) -> dict[str, Any]:
        outcomes = {"outcomes": (("diameter", "outcome"), _outcomes(found))} if counted else {}
        return _light_variables(found) | outcomes

    title = "Rays that reach the detector, for each diameter"
    layout = Layout("detections", config, title, own, "diameter")
    parts = swept_light(layout, law, points or Points(), threads, share, _NOTHING, variables_of)
    return Stream(layout, parts)


def _light_variables(found: Sequence[Light]) -> dict[str, Any]:
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
    }


def _outcomes(found: Sequence[Light]) -> NDArray[np.int64]:
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
