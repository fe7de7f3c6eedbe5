"""One cell of the stability matrix: octsim's doubles beside 50 digits and beside float32."""

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import ConfigError
from octsim.config.checks import rounding_remarks
from octsim.config.models import Config
from octsim.instrument.build import detector_of, scene_of
from octsim.optics.beam import Beam
from octsim.schemes.field_sum import intensity
from octsim.studies.stability.exact import follow, numbers
from octsim.studies.stability.matrix import Cell
from octsim.studies.stability.pairs import (
    RAYS,
    Case,
    Conditions,
    Key,
    Pair,
    compared,
    prepared,
    sample,
    traced,
)
from octsim.studies.stability.single import follow_single
from octsim.studies.stability.verdict import (
    NOTHING,
    TOLERANCE,
    UNKNOWN,
    Judgement,
    Row,
    Status,
    bound,
    judged,
)
from octsim.tracing.faces import faces_at

WAVENUMBERS = 100
"""Most wavenumbers of a cell at which the sum is compared."""


def _phase_error(case: Case, pair: Pair) -> float:
    return float(abs(pair.path - pair.end.path)) * case.k_max


def _amplitude_error(pair: Pair) -> float:
    exact = pair.end.amplitude
    if abs(exact) < NOTHING:
        return abs(pair.amplitude)
    return float(abs(pair.amplitude - exact) / abs(exact))


def worst(
    errors: list[tuple[float, Key]],
    condition_of: Callable[[Key], float],
    at_edge: Callable[[Key], bool],
) -> tuple[Judgement, set[Key]]:
    """Return the largest error and fraction of the bound, and the paths at an edge, left out.

    Errors below the tolerance are within any bound. Of those only the largest gets its condition,
    and its fraction is that of the tolerance: none of them has a larger one.
    """
    kept, edges = [], set()
    for error, key in sorted(errors, reverse=True):
        condition = condition_of(key)
        if error <= TOLERANCE:
            kept.append(Judgement(error, condition, error / TOLERANCE))
            break
        judgement = judged(error, condition)
        if judgement.of_bound > 1 and at_edge(key):
            edges.add(key)
        else:
            kept.append(judgement)
    largest = max((one.error for one in kept), default=math.nan)
    return max(kept, key=lambda one: one.of_bound, default=UNKNOWN)._replace(error=largest), edges


def phase_slope(case: Case, pairs: list[Pair], conditions: Conditions) -> Judgement:
    """Return the rounding of a phase slope, rad/µm: k_max (Λ(d + δ) − Λ(d − δ)) / (2 δ).

    Of the brightest path through the neuron that both diameters have; δ is half of the sweep's
    step, or d/100 where that is less. Both tracers take the same two diameters, so that what is
    left is rounding, not the difference quotient's own error.
    """
    sweep, d = case.config.sweep.diameters, case.cell.diameter
    half = min((sweep.stop - sweep.start) / (sweep.num - 1) / 2, d / 100)
    low, high = d - half, d + half
    through = [pair for pair in pairs if _goes_through(pair.key[1])]
    for pair in sorted(through, key=lambda pair: -abs(pair.amplitude))[:5]:
        ray, code = pair.key
        place = np.flatnonzero(case.beam.number == ray)
        alone = _rays_of(case.beam, place)
        lengths = []
        for diameter in (low, high):
            arrived = traced(case.config, alone, diameter, case.cell.focus)
            end = follow(case.inputs(ray, diameter), code)
            (at,) = np.nonzero(arrived.path == code)
            if at.size == 1 and end.reason == "detected":
                lengths.append((float(arrived.optical_path_length[at[0]]), end.path))
        if len(lengths) == 2:
            (low_path, low_exact), (high_path, high_exact) = lengths
            scale = case.k_max / (high - low)
            error = float(abs((high_path - high_exact) - (low_path - low_exact))) * scale
            condition = conditions.of(pair.key).phase
            allowed = 2 * bound(condition) / (high - low)
            return Judgement(error, condition, error / allowed)
    return UNKNOWN


def _rays_of(beam: Beam, place: NDArray[np.intp]) -> Beam:
    """Return some of a beam's rays, by their places in it."""
    return beam._replace(**{name: values[place] for name, values in beam._asdict().items()})


def _goes_through(code: int) -> bool:
    while code > 1:
        code, digit = divmod(code, 4)
        if digit == 3:
            return True
    return False


def _terms(case: Case, k: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the fields at a wavenumber, each rounded once: k Λ is used to its last digit."""
    path = case.detections.optical_path_length
    product = k * path
    # Dekker's product: what rounding took from it
    split = 134217729.0
    k_high = split * k - (split * k - k)
    p_high = split * path - (split * path - path)
    k_low, p_low = k - k_high, path - p_high
    rest = ((k_high * p_high - product) + k_high * p_low + k_low * p_high) + k_low * p_low
    cos, sin = np.cos(product), np.sin(product)
    return case.detections.amplitude * (cos - rest * sin), case.detections.amplitude * (
        sin + rest * cos
    )


def spectrum_sum(case: Case) -> Judgement:
    """Return the error of the sum over rays, by an exactly rounded one, over the largest intensity.

    The condition number is that of the paths' last digits in the sum, 2 k Σ|E Λ| Σ|E| / max I.
    """
    amplitude, path = case.detections.amplitude, case.detections.optical_path_length
    k = case.config.spectrum.wavenumbers()
    summed = intensity(amplitude, path, k)
    at = np.unique(np.linspace(0, k.size - 1, WAVENUMBERS).astype(int))
    if amplitude.size * at.size > 2_000_000:
        at = at[:: 1 + amplitude.size * at.size // 2_000_000]
    exact = []
    for i in at.tolist():
        real, imaginary = map(math.fsum, _terms(case, float(k[i])))
        exact.append(real**2 + imaginary**2)
    peak = max(float(summed.max()), *exact)
    if peak == 0:
        return UNKNOWN
    error = float(np.abs(summed[at] - exact).max()) / peak
    total = np.abs(amplitude).sum()
    return judged(error, float(2 * k[-1] * np.abs(amplitude * path).sum() * total / peak))


def launch_error(case: Case, rays: list[int]) -> Judgement:
    """Return the error of a spiral's places on the objective, as a fraction of its radius."""
    if case.cell.positions is not None:
        return UNKNOWN
    given = case.inputs(0)
    ratio = given.numerical_aperture / given.glass
    golden = (numbers.sqrt(5) - 1) / 2
    last = max(case.x.size - 1, 1)
    errors = [0.0]
    for j in rays:
        turn, distance = 2 * numbers.pi * j * golden, numbers.sqrt(numbers.mpf(j) / last)
        for exact, at in ((numbers.cos(turn), case.x[j]), (numbers.sin(turn), case.y[j])):
            errors.append(float(abs(exact * distance - numbers.mpf(float(at)) / given.aperture)))
    # the radius, f tan(asin(NA / n)), feels NA and n as 1 / (1 − (NA / n)²) each, and f as 1
    return judged(max(errors), float(1 + 2 / (1 - ratio**2)))


def single(case: Case, pairs: list[Pair]) -> Iterator[tuple[float, float]]:
    """Yield the errors of float32 in phase (rad) and amplitude; infinite where a ray is lost."""
    faces = faces_at(scene_of(case.config, case.cell.diameter), case.k_max)
    detector = detector_of(case.config)
    place = np.empty_like(case.beam.number)
    place[case.beam.number] = np.arange(place.size)
    for pair in pairs:
        ray, code = pair.key
        arguments = (case.cell.focus, int(place[ray]), code, np.float32)
        with np.errstate(all="ignore"):
            arrival = follow_single(faces, detector, case.beam, *arguments)
        if arrival is None or not np.isfinite(arrival).all():
            yield math.inf, math.inf
            continue
        other = pair._replace(
            amplitude=float(arrival.amplitude), path=float(arrival.optical_path_length)
        )
        yield _phase_error(case, other), _amplitude_error(other)


def measure(cell: Cell, base: Config, most: int = RAYS) -> Row:
    """Return what is measured in a cell, with at most so many rays of 50 digits."""
    try:
        config = cell.config(base)
    except ConfigError as error:
        return Row(Status.REFUSED, str(error))
    case = prepared(cell, config)
    if case.x.size == 0:
        return Row(Status.NO_SUCH_RAY, "no ray of this scene is at that edge")
    results = (case.detections.amplitude, case.detections.optical_path_length)
    if not all(np.isfinite(values).all() for values in results):
        return Row(Status.NOT_FINITE, "an amplitude or a path is not finite")
    rays, conditions = sample(case, most), Conditions(case)
    pairs, edges, lost = compared(case, rays, conditions)
    phase_errors = [(_phase_error(case, pair), pair.key) for pair in pairs]
    amplitude_errors = [(_amplitude_error(pair), pair.key) for pair in pairs]
    phase, phase_edges = worst(
        phase_errors, lambda key: conditions.of(key).phase, conditions.at_edge
    )
    amplitude, amplitude_edges = worst(
        amplitude_errors, lambda key: conditions.of(key).amplitude, conditions.at_edge
    )
    judgements = {
        "phase": phase,
        "amplitude": amplitude,
        "phase_slope": phase_slope(case, pairs, conditions),
        "spectrum": spectrum_sum(case),
        "launch": launch_error(case, rays),
    }
    edges += len(phase_edges | amplitude_edges)
    narrow = list(single(case, pairs))
    kept = [errors for errors in narrow if math.isfinite(errors[0])]
    over = [name for name, judgement in judgements.items() if judgement.of_bound > 1]
    reason = lost or (f"{', '.join(over)} beyond the bound" if over else "")
    status = Status.BEYOND if reason else Status.EDGE if edges else Status.WITHIN
    warned = rounding_remarks(config)
    if reason and warned:
        status, reason = Status.WARNED, warned[0]
    elif warned and phase.error > TOLERANCE:
        reason = warned[0]
    return Row(
        status,
        reason,
        paths_compared=len(pairs),
        paths_at_edge=edges,
        optical_path_length_error=max((error for error, _ in phase_errors), default=math.nan)
        / case.k_max,
        single_phase_error=max((phase for phase, _ in kept), default=math.nan),
        single_amplitude_error=max((amplitude for _, amplitude in kept), default=math.nan),
        single_lost=1 - len(kept) / len(narrow) if narrow else math.nan,
        **judgements,
    )
