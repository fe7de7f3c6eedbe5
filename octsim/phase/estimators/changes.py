"""Small changes of several quantities at once that make a spectrum's counts most likely."""

from typing import NamedTuple

import numpy as np

from octsim.phase.estimators.estimate import Array

_ROUNDS = 5
_TINY = 1e-9  # of the mean: a dark sample must not forbid a count


class Changes(NamedTuple):
    """Changes of Q quantities by S spectra."""

    value: Array
    """(S, Q)."""
    covariance: Array
    """Of the errors by shot noise, (S, Q, Q)."""


def likeliest_changes(counts: Array, rest: Array, response: Array) -> Changes:
    r"""Find the changes from rest, and the brightness, that make Poisson counts most likely.

    .. math:: \mu_k = b \, (I_k + \sum_q x_q \, \partial_q I_k)

    is linear in b and b x, so Fisher's scoring is a least-squares fit with weights 1/μ of the last
    one; the covariance of x is that of the inverse Fisher information, the brightness b unknown.

    Parameters
    ----------
    counts : ndarray, shape (S, K)
        Photons in each sample.
    rest : ndarray, shape (K,)
        Spectrum at rest, in any unit.
    response : ndarray, shape (Q, K)
        Its derivatives by the quantities.

    Returns
    -------
    Changes
        In the units that the derivatives are by.

    Examples
    --------
    >>> rest, response = np.array([1.0, 2, 3]), np.array([[1.0, 0, -1]])
    >>> likeliest_changes(500 * (rest + 0.01 * response), rest, response).value.round(6)
    array([[0.01]])
    """
    columns = np.concatenate([rest[np.newaxis], response])
    size = np.abs(columns).max(axis=1)
    columns = columns / size[:, np.newaxis]  # of one size, or the equations are far from solvable
    mean = counts.mean(axis=1, keepdims=True)
    expected = rest * mean / rest.mean()
    for _ in range(_ROUNDS):
        weighted = columns / np.maximum(expected, _TINY * mean)[:, np.newaxis]
        information = weighted @ columns.T
        found = np.linalg.solve(information, weighted @ counts[..., np.newaxis])[..., 0]
        expected = found @ columns
    covariance = np.linalg.inv(information) / np.outer(size, size)
    brightness, scaled = found[:, :1] / size[0], found[:, 1:] / size[1:]
    value = scaled / brightness
    # x is a quotient of what is fitted
    of_each = np.broadcast_to(np.eye(len(response)), (*value.shape, value.shape[1]))
    turn = np.concatenate([-value[..., np.newaxis], of_each], axis=2) / brightness[..., np.newaxis]
    return Changes(value, turn @ covariance @ np.swapaxes(turn, 1, 2))
