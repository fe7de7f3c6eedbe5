r"""The neuron and instrument whose modelled spectrum is likeliest to be a measured one.

.. math:: \hat p = \arg\min_p \sum_k \frac{(y_k - b\, S_k I_k(p))^2}{\sigma_k^2}

by Maxwell's equations, over diameter, gap, focus, fill and index, with the brightness b eliminated;
its covariance is the inverse of the Fisher information, widened where the fit leaves more than
noise.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline
from scipy.optimize import least_squares

from octsim.config.models import Config
from octsim.instrument.instrument import Instrument
from octsim.studies.calibration.parameters import parameter_named
from octsim.studies.calibration.tolerances import moved

Array = NDArray[np.float64]
PARAMETERS = ("diameter", "gap", "focus", "fill", "neuron")
"""What is fitted, by the names of their tolerances."""
_SCANNED = np.linspace(-0.3, 0.3, 41)
"""Changes of the diameter that are tried before all is fitted, µm."""
_STARTS = 2
"""The likeliest of these, from which it is."""
_STEP = 0.05
"""Of a tolerance, for derivatives."""


class Observed(NamedTuple):
    """A measured spectrum, (K,) each."""

    wavenumber: Array
    """Rising, 1/µm."""
    counts: Array
    """Without the dark."""
    source: Array
    """Power of the source."""
    error: Array
    """Standard error of the counts."""


class Match(NamedTuple):
    """What fits best."""

    change: Array
    """Of each of `PARAMETERS`, from what is believed, (P,)."""
    covariance: Array
    """(P, P); infinite on the diagonal where nothing is told."""
    fitted: Array
    """Modelled counts of the best, (K,)."""
    configured: Array
    """Modelled counts of the config as it is, as bright, (K,)."""
    chi_square: float
    """Σ over the samples, of the best."""
    configured_chi_square: float
    """Σ over the samples, of the config as it is."""


def match(config: Config, observed: Observed, diameter: float, focus: float) -> Match:
    """Return the neuron and instrument that fit a measured spectrum best.

    Parameters
    ----------
    config : Config
        Solved by Maxwell's equations, with a flat source.
    observed : Observed
    diameter, focus : float
        As they are believed to be, µm.
    """
    tolerance = np.array([config.calibration.tolerances.of[name] for name in PARAMETERS])
    tolerance = np.where(
        tolerance > 0, tolerance, [parameter_named(name).step for name in PARAMETERS]
    )
    weight = 1 / observed.error

    def modelled(change: Array) -> Array:
        place = moved(config, dict(zip(PARAMETERS, change.tolist(), strict=True)), 0.0)
        instrument = Instrument(place.config)
        found = instrument.spectrum(diameter + place.diameter, focus + place.focus).intensity
        own = make_interp_spline(instrument.wavenumber, found, k=5)(observed.wavenumber)
        shape = own * observed.source
        bright = (weight**2 * observed.counts) @ shape / ((weight**2 * shape) @ shape)
        return np.asarray(bright * shape)

    def residual(scaled: Array) -> Array:
        return np.asarray(weight * (observed.counts - modelled(scaled * tolerance)))

    low, high = _limits(config, diameter, tolerance)

    def jacobian(scaled: Array) -> Array:
        """Return central differences, (K, P), within the limits."""
        columns = []
        for step in _STEP * np.eye(len(PARAMETERS)):
            above, below = np.minimum(scaled + step, high), np.maximum(scaled - step, low)
            columns.append((residual(above) - residual(below)) / (above - below).sum())
        return np.column_stack(columns)

    starts = _starts(residual, low, high, tolerance)
    found = min(
        (
            least_squares(
                residual, start, jacobian, bounds=(low, high), xtol=1e-5, ftol=1e-6, max_nfev=60
            )
            for start in starts
        ),
        key=lambda one: float(one.cost),
    )
    at_rest = residual(np.zeros(len(PARAMETERS)))
    chi_square, freedom = 2 * float(found.cost), observed.counts.size - len(PARAMETERS) - 1
    # more than noise is left where the model lacks something: errors are at least as large
    widened = max(1.0, chi_square / freedom)
    return Match(
        found.x * tolerance, _covariance(found.jac, tolerance) * widened,
        modelled(found.x * tolerance), modelled(np.zeros(len(PARAMETERS))), chi_square,
        float(at_rest @ at_rest),
    )  # fmt: skip


def _limits(config: Config, diameter: float, tolerance: Array) -> tuple[Array, Array]:
    """Return between which changes, over the tolerances, all is possible, (P,) each."""
    low, high = [], []
    for name in PARAMETERS:
        one = parameter_named(name)
        at, (least, most) = one.believed(config), one.limits(config)
        low.append(max(least - at, -1e3))
        high.append(min(most - at, 1e3))
    low[0] = max(low[0], -0.5 * diameter)
    high[0] = min(high[0], 0.5 * diameter)
    return np.array(low) / tolerance + 1e-9, np.array(high) / tolerance - 1e-9


def _starts(
    residual: Callable[[Array], Array], low: Array, high: Array, tolerance: Array
) -> list[Array]:
    """Return where to begin: as believed, and at other diameters that are likely by themselves."""
    tried = np.zeros((_SCANNED.size, len(PARAMETERS)))
    tried[:, 0] = np.clip(_SCANNED / tolerance[0], low[0], high[0])
    misfit = np.array([float((residual(one) ** 2).sum()) for one in tried])
    inner = np.flatnonzero(
        (misfit <= np.append(misfit[1:], np.inf)) & (misfit <= np.append(np.inf, misfit[:-1]))
    )
    best = inner[np.argsort(misfit[inner])][:_STARTS]
    return [np.clip(tried[at], low, high) for at in best.tolist()]


def _covariance(jacobian: Array, tolerance: Array) -> Array:
    """Return the covariance of the changes, (P, P), of a fit over the tolerances."""
    information = jacobian.T @ jacobian
    # what nothing tells has a covariance beyond any use, and no other feels it
    values, vectors = np.linalg.eigh(information)
    kept = np.maximum(values, 1e-12 * values.max())
    found: Array = (vectors / kept) @ vectors.T * np.outer(tolerance, tolerance)
    return found
