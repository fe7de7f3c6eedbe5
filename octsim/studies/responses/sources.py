"""What tells quantities apart: the spectrum's shape, phases in bands, or those of depths."""

from typing import NamedTuple

import numpy as np

from octsim.config.models import Config
from octsim.phase.cramer_rao import fisher_information
from octsim.phase.derivatives import Array
from octsim.phase.noise import expected_counts
from octsim.studies.responses.observables import observables_of
from octsim.studies.responses.separability import (
    Separability,
    errors_of,
    told_apart,
    without_nuisance,
)

SPECTRUM, KNOWN_BRIGHTNESS, BANDS, COMPONENTS = SOURCES = (
    "spectrum", "spectrum_of_known_brightness", "bands", "components",
)  # fmt: skip


class Told(NamedTuple):
    """What is told of Q quantities at D diameters of V scenes, by S sources."""

    alone: Array
    """Standard errors, nm or 1e-3 of an index, (S, V, D, Q)."""
    pair: Array
    """(S, V, D, Q, Q)."""
    together: Array
    """(S, V, D, Q)."""
    correlation: Array
    """(S, V, D, Q, Q)."""
    status: Array
    """Codes of `Separability` of all together, (S, V, D, Q)."""
    pair_status: Array
    """Of each with another, (S, V, D, Q, Q)."""
    apparent: Array
    """What the likeliest diameter moves by for each quantity, nm, (V, D, Q)."""


def by_source(
    config: Config, intensity: Array, shape: Array, response: Array, noise: Array
) -> Told:
    """Return how well quantities are known by each of `SOURCES`, under shot noise alone.

    Parameters
    ----------
    config : Config
    intensity : ndarray, shape (V, D, K)
        Spectra at rest.
    shape : ndarray, shape (V, D, Q, K)
        Their derivatives; NaN of what a scene does not have, which is left out there.
    response : ndarray, shape (V, D, M, Q)
        Phase responses, mrad.
    noise : ndarray, shape (V, D, M, M)
        Covariance of the phases, mrad².
    """
    scenes, diameters, quantities, _ = shape.shape
    plain = (len(SOURCES), scenes, diameters, quantities)
    alone, together, status = (np.full(plain, np.nan) for _ in range(3))
    pair, correlation, pair_status = (np.full((*plain, quantities), np.nan) for _ in range(3))
    apparent = np.full(plain[1:], np.nan)
    photons = config.action_potential.photons
    names = observables_of(config)
    for scene, at in np.ndindex(scenes, diameters):
        there = np.flatnonzero(np.isfinite(shape[scene, at, :, 0]))
        found = _informations(
            intensity[scene, at], shape[scene, at, there], photons,
            response[scene, at][:, there], noise[scene, at], names,
        )  # fmt: skip
        of_shape = found[SPECTRUM][0]
        apparent[scene, at, there] = of_shape[0] / of_shape[0, 0]
        for place, name in enumerate(SOURCES):
            information, values = found[name]
            errors = errors_of(information)
            mesh = np.ix_(there, there)
            alone[place, scene, at, there] = errors.alone
            together[place, scene, at, there] = errors.together
            pair[place, scene, at][mesh] = errors.pair
            correlation[place, scene, at][mesh] = errors.correlation
            status[place, scene, at, there] = told_apart(
                errors.together, errors.alone, values, there.size
            )
            pair_status[place, scene, at][mesh] = told_apart(
                errors.pair, errors.alone[:, np.newaxis], values, 2
            )
    # a quantity that is not there is one that nothing tells
    return Told(
        alone, pair, together, correlation, np.nan_to_num(status, nan=_NONE),
        np.nan_to_num(pair_status, nan=_NONE), apparent,
    )  # fmt: skip


_NONE = float(Separability.ABSENT)


def _informations(
    rest: Array, shape: Array, photons: float, response: Array, noise: Array, names: list[str]
) -> dict[str, tuple[Array, int]]:
    """Return the Fisher information by each source, and how many values it has."""
    expected = expected_counts(rest, photons)
    brighter = np.concatenate([shape * photons / rest.sum(), expected[np.newaxis]])
    whole = fisher_information(expected, brighter)
    found = {
        SPECTRUM: (without_nuisance(whole), rest.size - 1),
        KNOWN_BRIGHTNESS: (whole[:-1, :-1], rest.size),
    }
    for name, prefix in ((BANDS, "band_"), (COMPONENTS, "component_")):
        rows = [place for place, one in enumerate(names) if one.startswith(prefix)]
        covariance = noise[np.ix_(rows, rows)]
        if name == BANDS:  # bands have no sample in common
            covariance = np.diag(np.diag(covariance))
        moved = response[rows]
        found[name] = moved.T @ np.linalg.solve(covariance, moved), len(rows)
    return found
