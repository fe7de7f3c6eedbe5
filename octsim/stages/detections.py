"""The sweep over diameters: the rays that reach the detector."""

from collections.abc import Mapping, Sequence
from enum import IntEnum
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.grid import Combination, combinations
from octsim.config.models import Config
from octsim.config.scheme import sampled, scheme_of
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout, filling
from octsim.datasets.streams import Stream, Streamed
from octsim.instrument.points import Points
from octsim.optics.detector import Outcome
from octsim.schemes.light import AccuracyStatus, Light, Sampled
from octsim.stages.scatter import WHOLE, Share
from octsim.stages.swept_light import swept_diameters, swept_light

RAYS: Mapping[str, str] = {
    "path_code": "path",
    "amplitude": "amplitude",
    "rough_amplitude": "rough_amplitude",
    "optical_path_length": "optical_path_length",
}
"""What is stored of each ray, and its name in `Light`."""
FIELDS = 4
"""Detected fields whose intensities have the detected one as their mean, at most."""
_SAMPLE = ("diameter", "field", "wavenumber")
_NONE = np.empty(0)
_NOTHING = Light(_NONE.astype(np.int64), _NONE, _NONE, _NONE, 0.0, 0, AccuracyStatus.NO_FOCUS)


class FieldStatus(IntEnum):
    """Whether the samples of a detected field are kept."""

    KNOWN = 0
    NOT_THERE = 1
    """The intensity is the mean of fewer fields, or is summed from the rays themselves."""
    NO_FOCUS = 2
    """There is no focus law."""


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
        that counts rays, how all segments of ray ended, outcomes(diameter, outcome). Where rays
        differ from wavenumber to wavenumber, or have a polarisation, they are those at the middle
        of the band, and the fields that they make at all samples are kept too: field_real and
        field_imaginary (diameter, field, wavenumber), NaN for those that there are not, as
        field_status (diameter, field) says.

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "tracing": {"rays": 200},
    ...         "sweep": {
    ...             "diameters": {"stop": "1.1 um", "num": 3},
    ...             "focus": {"slope": 0.58, "intercept": "66 nm"},
    ...         },
    ...     }
    ... )
    >>> detections = octsim.detections(config)
    >>> detections["diameter"].values.tolist()
    [1.0, 1.05, 1.1]
    """
    named: Coordinate = "outcome", np.array([outcome.name.lower() for outcome in Outcome])
    schemes = combinations(config, "tracing.scheme", "tracing.preset")
    counted = any(scheme_of(at.config).counts_rays for at in schemes)
    fields = any(sampled(at.config) for at in combinations(config))

    def own(config: Config) -> dict[str, Coordinate]:
        counts: dict[str, Coordinate] = {"outcome": named} if counted else {}
        samples: dict[str, Coordinate] = {
            "field": ("field", np.arange(FIELDS)),
            "wavenumber": ("wavenumber", config.spectrum.wavenumbers()),
        }
        return swept_diameters(config) | counts | (samples if fields else {})

    def variables_of(found: Sequence[Light | Sampled], at: Combination) -> dict[str, Any]:
        rays = [one.rays if isinstance(one, Sampled) else one for one in found]
        outcomes = {"outcomes": (("diameter", "outcome"), _outcomes(rays))} if counted else {}
        samples = _samples(found, rays, at.config.spectrum.samples) if fields else {}
        return _light_variables(rays) | outcomes | samples

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


def _samples(
    found: Sequence[Light | Sampled], rays: Sequence[Light], number: int
) -> dict[str, Any]:
    nothing = complex(np.nan, np.nan)
    values, error = np.full((len(found), FIELDS, number), nothing), np.full(len(found), np.nan)
    for row, one in enumerate(found):
        if isinstance(one, Sampled):
            values[row, : len(one.values)], error[row] = one.values, one.error
    there = np.isfinite(values).all(axis=-1)
    no_focus = np.array([one.status == AccuracyStatus.NO_FOCUS for one in rays])
    status = np.select(
        [there, np.broadcast_to(no_focus[:, np.newaxis], there.shape)],
        [FieldStatus.KNOWN, FieldStatus.NO_FOCUS],
        FieldStatus.NOT_THERE,
    )
    return {
        "field_status": (_SAMPLE[:2], *flags(FieldStatus, status)),
        "field_real": (_SAMPLE, values.real),
        "field_imaginary": (_SAMPLE, values.imag),
        "field_error": ("diameter", error),
    }


def stored_light(detected: xr.Dataset) -> Sequence[Light | Sampled]:
    """Read the light of each diameter back from a plain dataset of the stage detections."""
    ends = np.cumsum(detected["rays_detected"].values)[:-1]
    rays = [np.split(detected[name].values, ends) for name in RAYS]
    lights = [
        Light(path, amplitude, rough, optical, missing, segments, AccuracyStatus(status))
        for path, amplitude, rough, optical, missing, segments, status in zip(
            *rays,
            detected["missing_field"].values.tolist(),
            detected["segments_traced"].values.tolist(),
            detected["accuracy_status"].values.tolist(),
            strict=True,
        )
    ]
    if "field_real" not in detected:
        return lights
    k = detected["wavenumber"].values
    values = detected["field_real"].values + 1j * detected["field_imaginary"].values
    there = np.asarray(np.isfinite(values).all(axis=-1))
    return [
        Sampled(light, k, fields[known], error) if known.any() else light
        for light, fields, known, error in zip(
            lights, values, there, detected["field_error"].values.tolist(), strict=True
        )
    ]


def stored_rays(detected: xr.Dataset) -> list[Light]:
    """Read the rays of each diameter back: of those that differ, at the middle of the band."""
    lights = stored_light(detected)
    return [one.rays if isinstance(one, Sampled) else one for one in lights]
