"""Light of every diameter of the sweep, at its focus: what the stages that keep light share."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import OctsimError
from octsim.base.threads import each_block
from octsim.config.grid import Combination
from octsim.config.models import Config, FocusLine
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import LightAtPoint, Points
from octsim.schemes.light import Found
from octsim.stages.focus_law import sweep_foci
from octsim.stages.scatter import Share

VariablesOf = Callable[[Sequence[Any], Combination], dict[str, Any]]
"""Returns the variables of the light of some diameters of a combination."""


def swept_diameters(config: Config) -> dict[str, Coordinate]:
    """Return the coordinate that the sweep is over."""
    return {"diameter": ("diameter", config.sweep.diameters.values())}


def swept_light(
    layout: Layout,
    law: xr.Dataset | None,
    points: Points,
    threads: int,
    share: Share,
    nothing: Found,
    variables_of: VariablesOf,
) -> Iterator[Part]:
    """Find the light of every diameter, block after block.

    Parameters
    ----------
    layout : Layout
        Of the dataset that it is kept in.
    law : Dataset or None
        The fitted focus law, where the focus follows it.
    points, threads, share
        Where light is kept, how many threads find it, and which share of it is asked for.
    nothing : Light or Waves
        Stands for the light of a combination that has no focus law.
    variables_of : callable
        From light to what is kept of it.
    """
    focus = _foci(layout, law)

    def points_of(block: tuple[Combination, slice]) -> Iterator[tuple[LightAtPoint, float, float]]:
        at, span = block
        heights = focus[at.position][span]
        dark = np.isnan(heights).all()
        light_at = (lambda _d, _z: nothing) if dark else Instrument(at.config, points).light
        diameters = layout.own[at.position]["diameter"][1][span]
        return ((light_at, d, z) for d, z in zip(diameters.tolist(), heights.tolist(), strict=True))

    blocks = share.blocks(layout)
    for (at, span), found in each_block(lambda p: p[0](p[1], p[2]), blocks, points_of, threads):
        variables = variables_of(found, at) | {"focus": ("diameter", focus[at.position][span])}
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
