"""Noise of a spectrometer by what its spectra scatter: the photon transfer curve."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

Array = NDArray[np.float64]
_GROUPS = 24
"""Of samples that are about as bright, whose scatter is taken together."""
_ROUNDS = 4


class Transfer(NamedTuple):
    r"""How the variance of a sample goes with its counts μ: :math:`\sigma^2 = r^2 + g \mu`.

    (Janesick, Photon Transfer, 2007.)
    """

    read_variance: float
    """r², of a sample without light, counts²."""
    per_count: float
    """g, of each count: one over the photoelectrons in it."""

    def variance(self, counts: Array) -> Array:
        """Return the variance of expected counts, of their shape."""
        found: Array = self.read_variance + self.per_count * np.maximum(counts, 0)
        return np.maximum(found, np.finfo(float).tiny)

    @property
    def read_noise(self) -> float:
        """Standard deviation without light, as for counts that are photoelectrons: r over √g."""
        return float(np.sqrt(self.read_variance / self.per_count)) if self.per_count > 0 else 0.0


def transfer(counts: Array, variance: Array) -> Transfer:
    """Fit a photon transfer curve.

    Parameters
    ----------
    counts : ndarray, shape (K,)
        Mean counts of each sample, without the dark.
    variance : ndarray, shape (K,)
        Of each sample, as it was measured.
    """
    if not (variance > 0).any():
        return Transfer(0.0, 0.0)
    order = np.argsort(counts)
    groups = np.array_split(order, min(_GROUPS, max(2, counts.size // 8)))
    mean = np.array([np.maximum(counts[one], 0).mean() for one in groups])
    of_each = np.array([variance[one].mean() for one in groups])
    size = np.sqrt(np.array([one.size for one in groups]))
    # each group's scatter is known to the same fraction
    weight = size / np.maximum(of_each, 1e-6 * of_each.max())
    columns = np.column_stack([np.ones_like(mean), mean])
    for _ in range(_ROUNDS):
        scale = np.abs(columns * weight[:, np.newaxis]).max(axis=0)
        scale[scale == 0] = 1
        found = nnls(columns * weight[:, np.newaxis] / scale, of_each * weight)[0] / scale
        # by what is fitted, as groups that scatter less by chance would count more
        weight = size / np.maximum(columns @ found, 1e-6 * of_each.max())
    return Transfer(float(found[0]), float(found[1]))
