"""Which responses are missing, and why."""

from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from octsim.datasets.files import flags
from octsim.datasets.statuses import first_reason
from octsim.phase.derivatives import Array
from octsim.studies.sides import SIDES


class ResponseStatus(IntEnum):
    """Whether a response, or how sure it is, is known."""

    KNOWN = 0
    ABSENT = 1
    """The scene has no such quantity."""
    BY_RAYS = 2
    """Each side's light by itself is watched of waves alone."""
    OTHER_SCENE = 3
    """What is not known of the instrument is looked at in the scene as it is alone."""
    NOT_COMPARED = 4
    """The responses are by rays, which are not compared with Maxwell's equations."""
    OF_A_SIDE = 5
    """Light of one side by itself has no fringe, and so no depth, and no noise of one."""
    NOT_TOLD = 6
    """Nothing tells the quantities, or there are fewer measured values than quantities."""


Reasons = list[tuple[NDArray[np.bool_], ResponseStatus]]


def response_statuses(
    shape: Array, observables: int, correlation: Array, *, by_rays: bool
) -> dict[str, Any]:
    """Return why responses are missing, as variables.

    Parameters
    ----------
    shape : ndarray, shape (V, D, Q, K)
        Responses of the spectrum; NaN of a quantity that a variant does not have.
    observables : int
        How many phases are watched; those of each side's light are the last.
    correlation : ndarray, shape (S, V, D, Q, Q)
        Of the errors of quantities.
    by_rays : bool
        Whether they are by rays.
    """
    absent = np.isnan(shape[..., 0])
    sides = np.arange(observables) >= observables - len(SIDES)
    other = np.reshape(np.arange(len(shape)) > 0, (-1, 1, 1, 1))
    of_rays = (sides & by_rays)[:, np.newaxis], ResponseStatus.BY_RAYS
    missing: Reasons = [(absent[:, :, np.newaxis], ResponseStatus.ABSENT), of_rays]
    unsure: Reasons = [
        (other, ResponseStatus.OTHER_SCENE), (np.array(by_rays), ResponseStatus.NOT_COMPARED)
    ]  # fmt: skip
    pairs = absent[..., np.newaxis] | absent[..., np.newaxis, :]
    scene, phases = ("variant", "diameter"), ("observable", "other_observable")
    found: dict[tuple[str, tuple[str, ...]], Reasons] = {
        ("quantity_status", (*scene, "quantity")): [(absent, ResponseStatus.ABSENT)],
        ("response_status", (*scene, "observable", "quantity")): missing,
        ("response_error_status", (*scene, "observable", "quantity")): [*missing, *unsure],
        ("shift_status", ("observable", "quantity")): [
            (absent[0, 0], ResponseStatus.ABSENT), of_rays
        ],
        ("depth_status", ("observable",)): [(sides, ResponseStatus.OF_A_SIDE)],
        ("covariance_status", phases): [(sides[:, np.newaxis] | sides, ResponseStatus.OF_A_SIDE)],
        ("correlation_status", ("source", *scene, "quantity", "other_quantity")): [
            (np.broadcast_to(pairs, correlation.shape), ResponseStatus.ABSENT),
            (np.isnan(correlation), ResponseStatus.NOT_TOLD),
        ],
    }  # fmt: skip
    return {name: (over, *flags(ResponseStatus, first_reason(those, ResponseStatus.KNOWN)))
            for (name, over), those in found.items()}  # fmt: skip
