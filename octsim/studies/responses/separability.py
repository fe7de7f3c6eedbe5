"""How well several quantities are known at once, and whether they are told apart."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from octsim.phase.derivatives import Array

MOST_GROWTH = 10.0
"""How many times an error may grow by another quantity that is not known: responses that are known
to per cents still mean something then. Of two it is a correlation of 0.995."""


class Separability(IntEnum):
    """Whether quantities that are fitted together are told apart."""

    SEPARABLE = 0
    NOT_SEPARABLE = 1
    """The standard error is more than `MOST_GROWTH` times that of the quantity alone."""
    TOO_FEW = 2
    """There are fewer measured values than quantities."""
    ABSENT = 3
    """The scene has no such quantity."""

    @property
    def remedy(self) -> str:
        """What a user can do about it; empty where nothing is amiss."""
        return _REMEDIES[self]


_REMEDIES = {
    Separability.SEPARABLE: "",
    Separability.NOT_SEPARABLE: (
        "fit fewer quantities, hold one by another measurement, or take bands that are wider or "
        "farther apart"
    ),
    Separability.ABSENT: "give the neuron a shell, or leave the quantity out",
    Separability.TOO_FEW: "give as many phases as quantities, or fit fewer",
}


class Errors(NamedTuple):
    """Standard errors of Q quantities, infinite where nothing tells them."""

    alone: Array
    """Of each with the others known, (Q,)."""
    pair: Array
    """Of the first with the second unknown too, (Q, Q); on the diagonal those alone."""
    together: Array
    """Of each with all others unknown, (Q,)."""
    correlation: Array
    """Of the errors, all unknown, (Q, Q); NaN where nothing tells them."""


def errors_of(information: Array) -> Errors:
    """Return the standard errors that a Fisher information (Q, Q) is of."""
    own = np.diag(information)
    with np.errstate(divide="ignore", invalid="ignore"):
        left = own[:, np.newaxis] - information**2 / own
        alone = 1 / np.sqrt(own)
        pair = np.where(left > _EPS * own[:, np.newaxis], 1 / np.sqrt(np.abs(left)), np.inf)
    np.fill_diagonal(pair, alone)
    covariance = covariance_of(information)
    together = np.sqrt(np.diag(covariance))
    with np.errstate(invalid="ignore"):
        return Errors(alone, pair, together, covariance / np.outer(together, together))


_EPS = 1e-12
"""Of what is known of a quantity alone: less is rounding."""


def covariance_of(information: Array) -> Array:
    """Return the inverse of a Fisher information (Q, Q); infinite where it has none."""
    root = np.sqrt(np.diag(information))
    if not (root > 0).all() or not np.isfinite(root).all():
        return np.full_like(information, np.inf)
    scaled = information / np.outer(root, root)
    if not np.linalg.eigvalsh(scaled)[0] > _EPS:
        return np.full_like(information, np.inf)
    inverse: Array = np.linalg.inv(scaled) / np.outer(root, root)
    return inverse


def without_nuisance(information: Array) -> Array:
    """Return what is left of an information (N, N) if its last parameter is unknown, (N−1, N−1)."""
    crossed = information[:-1, -1]
    left: Array = information[:-1, :-1] - np.outer(crossed, crossed) / information[-1, -1]
    return left


def told_apart(error: Array, alone: Array, values: int, quantities: int) -> Array:
    """Return the `Separability` of errors, of any shape, beside those alone, as codes."""
    if values < quantities:
        return np.full(np.shape(error), float(Separability.TOO_FEW))
    with np.errstate(invalid="ignore"):
        fine = np.isfinite(error) & (error <= MOST_GROWTH * alone)
    codes: Array = np.where(fine, float(Separability.SEPARABLE), float(Separability.NOT_SEPARABLE))
    return codes
