"""The sweep over diameters by Maxwell's equations: the field that the detector collects."""

from collections.abc import Sequence
from enum import IntEnum
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.grid import Combination
from octsim.config.models import Config
from octsim.config.scheme import scheme_of
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.streams import Stream, Streamed
from octsim.instrument.build import optics_of, scene_of
from octsim.instrument.points import Points
from octsim.optics.materials import Table
from octsim.schemes.cost import MOST_WAVENUMBERS
from octsim.schemes.fullwave.cylinder_on_plane import cylinders_of
from octsim.schemes.fullwave.orders import most_nodes
from octsim.schemes.light import TERMS, AccuracyStatus, Waves
from octsim.stages.scatter import WHOLE, Share
from octsim.stages.swept_light import swept_diameters, swept_light

POLARISATIONS = ("across", "along")
"""Of the light, by the cylinder."""
_FIELD = ("diameter", "polarisation", "node")
_TERM = ("diameter", "term", "polarisation", "node")
_NO_FIELD = np.empty((len(POLARISATIONS), 0), np.complex128)
_NOTHING = Waves(
    np.empty(0), _NO_FIELD, np.empty((len(TERMS), *_NO_FIELD.shape), np.complex128),
    np.nan, np.nan, 0.0, 0, AccuracyStatus.NO_FOCUS,
)  # fmt: skip


class NodeStatus(IntEnum):
    """Whether the field is solved for at a node."""

    SOLVED = 0
    NOT_NEEDED = 1
    """The diameter has fewer nodes than others."""
    NO_FOCUS = 2
    """There is no focus law."""
    BUDGET_SPENT = 3
    """It takes more partial waves, nodes or wavenumbers than are solved for."""


@Streamed
def fields(
    config: Config,
    law: xr.Dataset | None = None,
    threads: int = 1,
    points: Points | None = None,
    share: Share = WHOLE,
) -> Stream:
    r"""Solve Maxwell's equations for every diameter of the sweep.

    Returns
    -------
    Dataset
        The detected field at Chebyshev nodes of the band, without the phase
        :math:`e^{i k \Lambda_0}` of removed_optical_path_length(diameter): real and imaginary
        (diameter, polarisation, node) at node_wavenumber (diameter, node), and its parts, term_real
        and term_imaginary (diameter, term, polarisation, node); how sure it is (diameter). A
        diameter that needs fewer nodes than others has NaN at the last ones, as node_status
        (diameter, node) says.

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "tracing": {"preset": "exact"},
    ...         "sweep": {
    ...             "diameters": {"stop": "1.1 um", "num": 3},
    ...             "focus": {"slope": 0.58, "intercept": "66 nm"},
    ...         },
    ...     }
    ... )
    >>> fields = octsim.fields(config)
    >>> fields["diameter"].values.tolist()
    [1.0, 1.05, 1.1]
    """
    named: dict[str, Coordinate] = {
        "polarisation": ("polarisation", np.array(POLARISATIONS)),
        "term": ("term", np.array(TERMS)),
    }

    def own(config: Config) -> dict[str, Coordinate]:
        return swept_diameters(config) | named

    def nodes(config: Config) -> dict[str, int]:
        return {"node": _most_nodes(config)}

    def variables_of(found: Sequence[Waves], at: Combination) -> dict[str, Any]:
        return _wave_variables(found, _most_nodes(at.config))

    title = "Field that the detector collects, for each diameter"
    layout = Layout("fields", config, title, own, "diameter", nodes)
    parts = swept_light(layout, law, points or Points(), threads, share, _NOTHING, variables_of)
    return Stream(layout, parts)


def _most_nodes(config: Config) -> int:
    """Return the most wavenumbers at which the field of any diameter is solved."""
    if scheme_of(config).light != "waves":
        return 1
    tables = any(isinstance(one, Table) for one in config.scene.refractive_index.of.values())
    if tables or not config.scene.cylinders:
        return MOST_WAVENUMBERS
    largest = cylinders_of(scene_of(config, config.sweep.diameters.stop))
    return most_nodes(largest, optics_of(config).band, config.tracing.accuracy)


def _wave_variables(found: Sequence[Waves], nodes: int) -> dict[str, Any]:
    values = _padded([waves.values for waves in found], nodes)
    terms = _padded([waves.terms for waves in found], nodes)
    status = np.array([waves.status for waves in found])
    nothing = np.select(
        [status == AccuracyStatus.NO_FOCUS, ~np.isfinite(values[:, 0, 0])],
        [NodeStatus.NO_FOCUS, NodeStatus.BUDGET_SPENT],
        NodeStatus.NOT_NEEDED,
    )
    solved = np.isfinite(values).all(axis=1)
    at_nodes = np.where(solved, NodeStatus.SOLVED, nothing[:, np.newaxis])
    return {
        "real": (_FIELD, values.real),
        "imaginary": (_FIELD, values.imag),
        "term_real": (_TERM, terms.real),
        "term_imaginary": (_TERM, terms.imag),
        "node_wavenumber": (
            ("diameter", "node"), _padded([waves.wavenumber for waves in found], nodes).real,
        ),
        "removed_optical_path_length": _each("optical_path_length", found),
        "azimuth": _each("azimuth", found),
        "field_error": _each("error", found),
        "partial_waves": _each("order", found),
        "accuracy_status": ("diameter", *flags(AccuracyStatus, status)),
        "node_status": (("diameter", "node"), *flags(NodeStatus, at_nodes)),
    }  # fmt: skip


def _each(name: str, found: Sequence[Waves]) -> tuple[str, NDArray[Any]]:
    return "diameter", np.array([getattr(waves, name) for waves in found])


def _padded(arrays: Sequence[NDArray[Any]], nodes: int) -> NDArray[np.complex128]:
    """Stack arrays, with NaN after each one's nodes."""
    nothing = complex(np.nan, np.nan)
    whole = np.full((len(arrays), *arrays[0].shape[:-1], nodes), nothing, np.complex128)
    for row, values in zip(whole, arrays, strict=True):
        row[..., : values.shape[-1]] = values
    return whole


def stored_waves(stored: xr.Dataset) -> list[Waves]:
    """Read the light of each diameter back from a plain dataset of the stage fields."""
    node = stored["node_wavenumber"].values
    values = stored["real"].values + 1j * stored["imaginary"].values
    terms = stored["term_real"].values + 1j * stored["term_imaginary"].values
    counts = np.isfinite(node).sum(axis=1).tolist()
    numbers = zip(
        *(
            stored[name].values.tolist()
            for name in (
                "removed_optical_path_length", "azimuth", "field_error", "partial_waves",
                "accuracy_status",
            )
        ),
        strict=True,
    )  # fmt: skip
    return [
        Waves(
            node[row, :count], values[row, :, :count], terms[row, :, :, :count],
            removed, azimuth, error, order, AccuracyStatus(status),
        )
        for row, (count, (removed, azimuth, error, order, status)) in enumerate(
            zip(counts, numbers, strict=True)
        )
    ]  # fmt: skip
