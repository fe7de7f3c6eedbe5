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
from octsim.studies.calibration.tolerances import PARAMETERS, moved, offsets_of
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
    """The instrument with one thing moved by five offsets."""

    offsets: Array
    """(5,); µm where it is a length."""
    placed: Sequence[Placed]
    """The instrument at each offset."""


class Bench(NamedTuple):
    """What a calibration measures with."""

    instrument: Instrument
    """As it is believed to be."""
    by_rays: Instrument
    """The same with counted rays."""
    bent: Varied
    """The neuron's diameter moved, and the focus held."""
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
    by_rays: Config,
    processing: tuple[Processing, Processing],
    law_slope: float,
    points: Points | None,
) -> Bench:
    """Return the bench of an instrument, traced to an accuracy and by counted rays.

    Parameters
    ----------
    converged, by_rays : Config
        The instrument, traced in two ways.
    processing : tuple of Processing
        The calibration's and the thesis's.
    law_slope : float
        Of the focus over the diameter.
    points : Points or None
        Where light that was found before is kept.
    """
    own = Instrument(converged, points)
    bends = stencil(0.0, _CURVATURE_STEP)

    def varied(name: str) -> Varied:
        offsets = offsets_of(converged, name)
        places = [moved(converged, {name: by}, law_slope) for by in offsets.tolist()]
        return Varied(
            offsets, [Placed(Instrument(at.config, points), at.diameter, at.focus) for at in places]
        )

    return Bench(
        own,
        Instrument(by_rays, points),
        Varied(bends, [Placed(own, by) for by in bends.tolist()]),
        {name: varied(name) for name in PARAMETERS},
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
        By the names of the dataset's variables; ``sensitivity`` and ``sensitivity_error`` of each
        of `PARAMETERS`, (P,), in mrad/nm per unit of the parameter.

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
    require_fringe("calibration", middle, k, np.array([depth]), fixed.error)
    following = observed(own, diameter + offsets, focus + bench.law_slope * offsets)
    focused = observed(own, at_rest, focus + offsets)
    bent = [pair(placed) for placed in bench.bent.placed]
    varied = {name: [pair(placed) for placed in one.placed] for name, one in bench.varied.items()}
    accurate = [fixed, following, focused, *bent, *chain.from_iterable(varied.values())]

    def phase_slope(seen: Spectra, processing: Processing) -> Derivative:
        phase = series_phases(seen.intensity, k, depth, processing)
        return derivative(offsets, wrapped(phase - phase[phase.size // 2]))

    def pair_slope(seen: Spectra) -> float:
        before, after = series_phases(seen.intensity, k, depth, bench.processing)
        return float(wrapped(after - before)) / (2 * step)

    def change(varied: Varied, pairs: list[Spectra]) -> Derivative:
        return derivative(varied.offsets, np.array([pair_slope(pair) for pair in pairs]))

    slope = phase_slope(fixed, bench.processing)
    sensitivities = [change(bench.varied[name], pairs) for name, pairs in varied.items()]
    by_side = side_slopes(own.rays, diameter, focus, float((k[0] + k[-1]) / 2), step)
    return {
        **{f"{side}_side_phase_slope": of_side for side, of_side in by_side.items()},
        "fixed_focus_phase_slope": slope.value,
        "difference_error": slope.error,
        "following_phase_slope": phase_slope(following, bench.processing).value,
        "focus_phase_slope": phase_slope(focused, bench.processing).value,
        "fft_fixed_focus_phase_slope": phase_slope(fixed, bench.fft).value,
        "fft_following_phase_slope": phase_slope(following, bench.fft).value,
        "rays_phase_slope": pair_slope(pair(Placed(bench.by_rays))),
        "phase_curvature": change(bench.bent, bent).value / 1e3,  # per nm
        "sensitivity": np.array([one.value for one in sensitivities]),
        "sensitivity_error": np.array([one.error for one in sensitivities]),
        "intensity_error": max(seen.error for seen in accurate),
        "accuracy_status": max(seen.status for seen in accurate),
    }
