"""Light as the stages keep it, rays or waves: where each kind is, and how it is read."""

from collections.abc import Callable, Mapping, Sequence

import xarray as xr

from octsim.base.errors import OctsimError
from octsim.datasets.keys import light_of
from octsim.datasets.layout import Layout
from octsim.datasets.reader import Stored
from octsim.schemes.light import Found
from octsim.stages.detections import stored_light
from octsim.stages.fields import stored_waves

_READ: Mapping[str, Callable[[xr.Dataset], Sequence[Found]]] = {
    "rays": stored_light,
    "waves": stored_waves,
}
"""How light of each kind is read from a plain dataset."""
_KEPT_IN = {"rays": "detections", "waves": "fields"}


def lights_in(dataset: xr.Dataset, kind: str) -> Sequence[Found]:
    """Return the light of each diameter, of one kind, from a plain dataset."""
    return _READ[kind](dataset)


def stored_by_kind(layout: Layout, *datasets: xr.Dataset | None) -> dict[str, Stored]:
    """Return the datasets of a run that light of each kind is kept in.

    Parameters
    ----------
    layout : Layout
        Of the dataset that is made from them.
    *datasets : Dataset or None
        Of the stages detections and fields; None where the run has none.

    Raises
    ------
    OctsimError
        If one is missing that the run's schemes need.
    """
    given = dict(zip(_KEPT_IN, datasets, strict=True))
    stored = {}
    for kind in sorted(light_of(layout.config)):
        dataset, name = given[kind], _KEPT_IN[kind]
        if dataset is None:
            raise OctsimError(
                f"{name}: not given, which holds the light of a scheme of {kind}; make it by "
                f"octsim.{name}(config, law) and pass it as {name}"
            )
        stored[kind] = Stored(dataset, name, layout.config, layout)
    return stored
