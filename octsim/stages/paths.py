"""What each light path has in a spectrum: its amplitude, phase, optical path and share."""

from collections.abc import Iterator, Mapping
from enum import IntEnum
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.models import Config
from octsim.config.scheme import point_cost, scheme_of
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.stages.detections import stored_rays
from octsim.stages.fields import stored_waves
from octsim.stages.kept_light import stored_by_kind
from octsim.stages.pooled_paths import PathPool
from octsim.stages.ray_shares import SAMPLES, ray_shares, strongest_first
from octsim.stages.swept_light import swept_diameters
from octsim.stages.wave_shares import NAMES, wave_shares
from octsim.stages.workload import points_per_block


class PathStatus(IntEnum):
    """Whether a light path brings light back from a diameter."""

    KNOWN = 0
    NO_LIGHT = 1
    """None of its rays reaches the detector."""
    NO_AMPLITUDE = 2
    """Those that do have none, and so no mean path."""


_NOT_THERE = {
    "field_amplitude": 0.0, "field_phase": np.nan, "mean_optical_path_length": np.nan,
    "share": 0.0, "path_rays": 0,
}  # fmt: skip
"""Of a path that does not reach the detector at a diameter."""
_OVER = ("path", "diameter")


def _block_points(config: Config) -> int:
    return points_per_block(point_cost(config).size + 1000)


@Streamed
def light_paths(
    config: Config, detected: xr.Dataset | None = None, fields: xr.Dataset | None = None
) -> Stream:
    r"""Return what each light path has in the spectra of a sweep.

    A path's share of the intensity is

    .. math:: \int \mathrm{Re}(E_p^* E)\, dk / \int |E|^2\, dk, \quad E = \sum_p E_p

    over the band: shares sum to one, and that of a path which takes away is negative. Of waves the
    paths are their counterparts: what the plane returns, the terms p = 0 (near side) and p = 2 (far
    side) of the cylinder's Debye series, and the rest.

    Parameters
    ----------
    config : Config
        The run.
    detected, fields : Dataset
        Datasets of the stages detections and fields: those of them that the run has.

    Returns
    -------
    Dataset
        field_amplitude and field_phase, at the middle of the band, mean_optical_path_length, share
        and path_rays (path, diameter); path_code(path), negative for what is no path of rays. The
        strongest path is first. A path that does not reach the detector at a diameter has no rays
        there, and its phase and optical path are NaN, as path_status says.

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
    >>> paths = octsim.light_paths(config, octsim.detections(config))
    >>> [str(name) for name in paths["path"].values[:3]]
    ['PT CR PT', 'PT CT CR CT PT', 'PR']
    """
    title = "What each light path has in the spectra"
    unnamed = Layout("paths", config, title, swept_diameters, "diameter")
    stored = stored_by_kind(unnamed, detected, fields)
    pool = PathPool()
    found = "rays" in stored
    codes = _ray_codes(unnamed, stored["rays"], pool) if found else np.empty(0, np.int64)
    called = [pool.name(code) for code in codes.tolist()]
    terms = NAMES if "waves" in stored else ()
    named: dict[str, Coordinate] = {
        "path": ("path", np.array([*called, *terms], str)),
        "path_code": ("path", np.append(codes, -1 - np.arange(len(terms)))),
    }
    layout = Layout("paths", config, title, lambda of: named | swept_diameters(of), "diameter")
    return Stream(layout, _shared(layout, stored, codes, pool))


def _ray_codes(layout: Layout, stored: Stored, pool: PathPool) -> NDArray[np.int64]:
    """Return the codes of all paths of rays, the strongest at mid-band first."""

    def parts() -> Iterator[tuple[xr.Dataset, float]]:
        for at, span in layout.blocks(_block_points):
            if scheme_of(at.config).light == "rays":
                k = at.config.spectrum.wavenumbers()
                yield pool.pooled(at.config, stored.part(at, span)), (k[0] + k[-1]) / 2

    return strongest_first(parts())


def _shared(
    layout: Layout, stored: Mapping[str, Stored], codes: NDArray[np.int64], pool: PathPool
) -> Iterator[Part]:
    paths = layout.sizes["path"]
    for at, span in layout.blocks(_block_points):
        k, kind = at.config.spectrum.wavenumbers(), scheme_of(at.config).light
        part, step = stored[kind].part(at, span), (k[-1] - k[0]) / (SAMPLES - 1)
        found: list[dict[str, NDArray[Any]]]
        if kind == "rays":
            place = slice(0, codes.size)
            rays = stored_rays(pool.pooled(at.config, part))
            found = [ray_shares(light, codes, k[0], step) for light in rays]
        else:
            place = slice(codes.size, paths)
            found = [wave_shares(waves, k[0], step) for waves in stored_waves(part)]
        whole = {
            name: _placed(name, [one[name] for one in found], place, paths) for name in _NOT_THERE
        }
        status = flags(PathStatus, _status(whole["field_phase"], whole["mean_optical_path_length"]))
        variables: dict[str, Any] = {n: (_OVER, values) for n, values in whole.items()}
        yield Part(at, span.start, len(found), variables | {"path_status": (_OVER, *status)})


def _status(phase: NDArray[np.float64], length: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the `PathStatus` of phases and mean optical paths (P, D)."""
    return np.select(
        [np.isnan(phase), np.isnan(length)],
        [PathStatus.NO_LIGHT, PathStatus.NO_AMPLITUDE],
        PathStatus.KNOWN,
    )


def _placed(name: str, rows: list[NDArray[Any]], place: slice, paths: int) -> NDArray[Any]:
    """Return what some paths have at each diameter, (P, D), among all."""
    whole = np.full((paths, len(rows)), _NOT_THERE[name], rows[0].dtype)
    whole[place] = np.stack(rows, axis=1)
    return whole
