"""How the phase moves at one diameter: with it, with the focus, and with what may be off."""

from collections.abc import Mapping, Sequence
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.phase.derivatives import Array, Derivative, derivative, stencil, wrapped
from octsim.phase.estimators.series import series_phases
from octsim.phase.estimators.visible import require_fringe
from octsim.schemes.light import AccuracyStatus
from octsim.studies.calibration.parameters import parameters_of
from octsim.studies.calibration.scheme import MISSED
from octsim.studies.calibration.tolerances import Nodes, changes_by, moved, nodes_of, offsets_of
from octsim.studies.sides import side_slopes

_CURVATURE_STEP = 4e-3  # µm


class Spectra(NamedTuple):
    """Spectra of one instrument, and how sure they are."""

    intensity: Array
    """(S, K)."""
    error: float
    """The largest of their estimated errors."""
    status: AccuracyStatus
    """Of the one that is farthest from as asked."""


class Placed(NamedTuple):
    """An instrument, and how far its neuron and focus are from where they were."""

    instrument: Instrument
    diameter: float = 0.0
    """Added to the diameter, µm."""
    focus: float = 0.0
    """Added to the height of the focus, µm."""


class Varied(NamedTuple):
    """The instrument with one thing that may be off."""

    nodes: Nodes
    placed: Sequence[Placed]
    """The instrument at each of N nodes."""
    offsets: Array
    """Small changes, (5,)."""
    beside: Sequence[Placed]
    """The instrument at each of them."""


class Bench(NamedTuple):
    """What a calibration measures with."""

    instrument: Instrument
    """As it is believed to be."""
    others: Mapping[str, Instrument]
    """The same by other schemes, by the variable that holds their slope."""
    varied: Mapping[str, Varied]
    """By the name of the parameter that is moved."""
    law_slope: float
    """Of the focus over the diameter."""
    step: float
    """Of the diameter and of the focus, µm."""
    processing: Processing
    fft: Processing
    """With the thesis's estimator."""


def bench_of(
    converged: Config,
    others: Mapping[str, Config],
    processing: tuple[Processing, Processing],
    law_slope: float,
    points: Points | None,
) -> Bench:
    """Return the bench of an instrument.

    Parameters
    ----------
    converged : Config
        The instrument, solved as accurately as small steps need.
    others : mapping
        The same by other schemes, by the variable that holds their slope.
    processing : tuple of Processing
        The calibration's and the thesis's.
    law_slope : float
        Of the focus over the diameter.
    points : Points or None
        Where light that was found before is kept.
    """
    own = Instrument(converged, points)

    def placed(name: str, by: float) -> Placed:
        if not by:
            return Placed(own)
        at = moved(converged, {name: by}, law_slope)
        same = at.config == converged
        return Placed(own if same else Instrument(at.config, points), at.diameter, at.focus)

    def varied(name: str) -> Varied:
        nodes, offsets = nodes_of(converged, name), offsets_of(converged, name)
        at_nodes, beside = (
            [placed(name, by) for by in changes.tolist()] for changes in (nodes.offset, offsets)
        )
        return Varied(nodes, at_nodes, offsets, beside)

    return Bench(
        own,
        {name: Instrument(other, points) for name, other in others.items()},
        {name: varied(name) for name in parameters_of(converged)},
        law_slope,
        converged.calibration.step,
        *processing,
    )


def observed(instrument: Instrument, diameters: Array, foci: Array) -> Spectra:
    """Return the spectra of diameters, (S,), with a focus each, (S,), both µm."""
    places = zip(diameters.tolist(), foci.tolist(), strict=True)
    intensity, error, status = zip(*(instrument.spectrum(*at) for at in places), strict=True)
    return Spectra(np.stack(intensity), max(error), max(status))


def slopes_at(bench: Bench, diameter: float, focus: float) -> dict[str, Any]:
    """Return what a calibration holds at a diameter and its focus, both µm.

    Returns
    -------
    dict
        By the names of the dataset's variables; of each parameter, (P,), ``sensitivity``, the
        slope's derivative in mrad/nm per unit of it, and ``spread``, ``shift`` and ``budget_error``
        of the slope by its tolerance, mrad/nm.

    Raises
    ------
    OctsimError
        If the spectra have no fringe of the diameter.
    """
    own, step, k = bench.instrument, bench.step, bench.instrument.wavenumber
    depth = float(own.nominal_depth(np.array(diameter)))
    offsets, sides = stencil(diameter, step), np.array([-step, step])
    at_rest, held = np.full(offsets.size, diameter), np.full(offsets.size, focus)

    def pair(placed: Placed) -> Spectra:
        diameters: Array = diameter + placed.diameter + sides
        return observed(placed.instrument, diameters, np.full(sides.size, focus + placed.focus))

    fixed = observed(own, diameter + offsets, held)
    middle = fixed.intensity[offsets.size // 2, np.newaxis]
    require_fringe("calibration", middle, k, np.array([depth]), fixed.error, own.power)
    following = observed(own, diameter + offsets, focus + bench.law_slope * offsets)
    focused = observed(own, at_rest, focus + offsets)
    # nothing is off in the middle of each of the following: that pair is there already
    here = fixed._replace(intensity=fixed.intensity[[0, -1]])
    bends = stencil(0.0, _CURVATURE_STEP)
    bent = [pair(Placed(own, by)) if by else here for by in bends.tolist()]
    varied = [
        [here if placed == Placed(own) else pair(placed) for placed in (*one.placed, *one.beside)]
        for one in bench.varied.values()
    ]
    accurate = [fixed, following, focused, *bent, *chain.from_iterable(varied)]

    def phase_slope(seen: Spectra, processing: Processing) -> Derivative:
        phase = series_phases(seen.intensity, k, depth, processing, own.power)
        return derivative(offsets, wrapped(phase - phase[phase.size // 2]))

    def pair_slope(seen: Spectra) -> float:
        before, after = series_phases(seen.intensity, k, depth, bench.processing, own.power)
        return float(wrapped(after - before)) / (2 * step)

    def slope_of(placed: Placed) -> float:
        seen = pair(placed)
        return np.nan if seen.status in MISSED else pair_slope(seen)

    def pair_slopes(pairs: list[Spectra]) -> Array:
        return np.array([pair_slope(pair) for pair in pairs])

    slope = phase_slope(fixed, bench.processing)
    changes, sensitivity = [], []
    for one, pairs in zip(bench.varied.values(), varied, strict=True):
        at_nodes, beside = np.split(pair_slopes(pairs), [one.nodes.offset.size])
        changes.append(changes_by(one.nodes, at_nodes))
        sensitivity.append(derivative(one.offsets, beside).value)
    by_side = side_slopes(own.light, diameter, focus, float((k[0] + k[-1]) / 2), step)
    return {
        **{f"{side}_side_phase_slope": of_side for side, of_side in by_side.items()},
        "fixed_focus_phase_slope": slope.value,
        "difference_error": slope.error,
        "following_phase_slope": phase_slope(following, bench.processing).value,
        "focus_phase_slope": phase_slope(focused, bench.processing).value,
        "fft_fixed_focus_phase_slope": phase_slope(fixed, bench.fft).value,
        "fft_following_phase_slope": phase_slope(following, bench.fft).value,
        **{name: slope_of(Placed(other)) for name, other in bench.others.items()},
        "phase_curvature": derivative(bends, pair_slopes(bent)).value / 1e3,  # per nm
        "sensitivity": np.array(sensitivity),
        "spread": np.array([one.spread for one in changes]),
        "shift": np.array([one.shift for one in changes]),
        "budget_error": np.array([one.error for one in changes]),
        "intensity_error": max(seen.error for seen in accurate),
        "accuracy_status": max(seen.status for seen in accurate),
    }
