"""The diameter whose modelled spectrum makes a measured one most likely: no phase, no formula."""

from typing import NamedTuple

import numpy as np

from octsim.base.errors import OctsimError
from octsim.phase.estimators.estimate import Array

_STEPS = 10
_FEWEST = 4  # spectra that a cubic needs


class Model(NamedTuple):
    """Modelled spectra of a scene over its diameter, M of them."""

    diameter: Array
    """Increasing diameters, (M,), µm, a small part of an oscillation apart."""
    intensity: Array
    """Their spectra, (M, K)."""


def maximum_likelihood(intensity: Array, model: Model, read_noise: float = 0.0) -> Array:
    r"""Find the diameter whose spectrum, at the brightness measured, makes the counts most likely.

    .. math:: \hat d = \arg\max_d \sum_k (y_k + \sigma^2) \ln(\mu_k(d) + \sigma^2),
        \quad \sum_k \mu_k = \sum_k y_k

    the likelihood of Poisson counts y; read noise of variance σ² is taken for that many more counts
    (Snyder, Hammoud and White 1993, doi:10.1364/JOSAA.10.001014). The nearest of the model's
    spectra, then Fisher's scoring on a cubic spline through them.

    Parameters
    ----------
    intensity : ndarray, shape (D, K)
        Measured spectra.
    model : Model
        Modelled spectra of the same wavenumbers.
    read_noise : float
        Standard deviation σ of a dark sample, in the unit of `intensity`.

    Returns
    -------
    ndarray, shape (D,)
        Diameters, µm, none beyond the model's.

    Raises
    ------
    OctsimError
        If the model has too few spectra, or other wavenumbers.
    """
    # half a second to import, which only those who need it should wait for
    from scipy.interpolate import CubicSpline

    if model.diameter.size < _FEWEST or model.intensity.shape[1] != intensity.shape[1]:
        raise OctsimError(
            f"maximum_likelihood: a model of {model.diameter.size} diameters and "
            f"{model.intensity.shape[1]} wavenumbers given for spectra of {intensity.shape[1]}; "
            f"give {_FEWEST} diameters or more, and the spectra's wavenumbers"
        )
    # each spectrum's samples beside each other: the order in which numpy sums hangs on that
    intensity = np.ascontiguousarray(intensity)
    extra = read_noise**2
    # each modelled spectrum as a share of its light
    share = CubicSpline(model.diameter, model.intensity / model.intensity.sum(1, keepdims=True))
    slope = share.derivative()
    light = intensity.sum(axis=1, keepdims=True)
    found = model.diameter[_nearest(intensity, light, share(model.diameter), extra)]
    for _ in range(_STEPS):
        expected = np.maximum(light * share(found), 0) + extra + _TINY * light
        change = light * slope(found)
        score = ((intensity + extra - expected) * change / expected).sum(axis=1)
        found = found + score / (change**2 / expected).sum(axis=1)
        found = np.clip(found, model.diameter[0], model.diameter[-1])
    return np.asarray(found)


_TINY = 1e-9  # of the light, per sample: a dark fringe must not forbid a count


def _nearest(intensity: Array, light: Array, share: Array, extra: float) -> Array:
    """Return which modelled spectrum is likeliest, (D,), each spectrum by itself."""
    return np.array(
        [
            int((np.log(share + extra / own + _TINY) @ (counts + extra)).argmax())
            for counts, own in zip(intensity, light[:, 0], strict=True)
        ]
    )
