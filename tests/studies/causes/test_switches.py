"""Causes of the slope's scatter: each does what it is known to do, and their parts add up."""

import itertools

import numpy as np
import pytest
import reference
from numpy.typing import NDArray
from scipy.optimize import brentq

from octsim.config.load import load_config
from octsim.config.models import Processing
from octsim.optics.two_beams import predicted_phase_slope
from octsim.phase.slopes import phase_slopes
from octsim.phase.transform import fourier_components
from octsim.studies.causes.beat import Parts
from octsim.studies.causes.switches import (
    ALL,
    Causes,
    Reading,
    ShareStatus,
    Stencil,
    every_slope,
    neighbours,
    shapley,
    share_status,
    signal,
    slopes,
    variance_share,
)

Array = NDArray[np.float64]
LINE = {"slope": 0.58, "intercept": "64 nm"}
CONFIG = load_config({"sweep": {"focus": LINE}})
K = CONFIG.spectrum.wavenumbers()
N = CONFIG.scene.refractive_index.neuron
PREDICTED = predicted_phase_slope(N, float(K[0]), float(K[-1]))
DIAMETER = np.linspace(1, 2, 151)
READING = Reading(Processing(), N, DIAMETER, K)
STEP = 1e-5
UNIT = (K - K[0]) / (K[-1] - K[0])


def plates(diameter: Array, amplitude: Array | float = 1.0, still: Array | float = 2.0) -> Parts:
    """Give spectra amplitude(k) cos(2ndk) + still(k)."""
    beat = amplitude * np.exp(2j * N * np.outer(diameter, K))
    return Parts(beat, np.broadcast_to(still, beat.shape), np.zeros(beat.shape))


def at_point(
    diameter: Array, amplitude: Array | float = 1.0, still: Array | float = 2.0
) -> Stencil:
    below, at, above = (plates(diameter + o, amplitude, still) for o in (-STEP, 0, STEP))
    return Stencil(below, at, above, np.full(diameter.size, 2 * STEP))


def test_without_causes_two_plates_have_the_predicted_slope_at_any_step() -> None:
    for stencil in (at_point(DIAMETER), neighbours(plates(DIAMETER), DIAMETER)):
        assert slopes(stencil, frozenset(), READING) == pytest.approx(PREDICTED, abs=1e-6)
    # nor do bins scatter by themselves: a pure exponential's phase is that of the band's middle
    assert slopes(at_point(DIAMETER), frozenset({"bins"}), READING) == pytest.approx(
        PREDICTED, abs=1e-6
    )
    assert slopes(at_point(DIAMETER), frozenset({"image"}), READING).std() > 0.1


def test_with_all_causes_the_slope_is_the_package_s_and_the_literal_one() -> None:
    swept = plates(DIAMETER, 1 - 0.2 * UNIT, 2 + 0.3 * UNIT**2)
    found = slopes(neighbours(swept, DIAMETER), ALL, READING)
    components = fourier_components(swept.intensity(), READING.processing)
    stage = phase_slopes(DIAMETER, np.abs(components), np.angle(components)).strongest
    assert np.allclose(found, stage, atol=1e-9)
    literal = reference.phase_slopes(swept.intensity(), DIAMETER.tolist())
    assert np.allclose(found, literal.slope, atol=1e-8)


def test_a_cause_that_spectra_do_not_have_changes_nothing() -> None:
    # nothing but a level stands still, there is no other light, and both rays are the same
    stencil = at_point(DIAMETER, 1 - 0.2 * UNIT)
    values = every_slope(lambda _: stencil, READING)
    for present, cause in itertools.product(values, ("envelope", "paths", "rays", "step")):
        assert np.allclose(values[present], values[present - {cause}], atol=1e-8)
    assert np.abs(values[ALL] - values[ALL - {"centre"}]).max() > 0.1
    assert np.abs(values[ALL] - values[ALL - {"image"}]).max() > 0.1


def test_switching_off_takes_out_just_what_it_says() -> None:
    some = plates(DIAMETER[:5], 1 - 0.2 * UNIT, 2 + 0.3 * UNIT)
    some = some._replace(rest=0.01 * np.cos(4 * N * np.outer(DIAMETER[:5], K)))
    window = np.hamming(K.size) / np.hamming(K.size).sum()
    intensity = some.intensity()
    middle = (intensity.max(axis=1) + intensity.min(axis=1)) / 2
    processing = READING.processing
    whole = signal(some, ALL, processing)
    assert np.allclose(whole, (intensity - middle[:, None]) * window, atol=1e-16)
    off = whole - signal(some, ALL - {"centre"}, processing)
    assert np.allclose(off, ((some.still @ window) - middle)[:, None] * window, atol=1e-16)
    fixed: Causes = ALL - {"centre"}  # the midpoint would move with what is taken out
    taken = {
        "image": some.beat.conj() / 2,
        "paths": some.rest,
        "envelope": some.still - (some.still @ window)[:, None],
    }
    for cause, part in taken.items():
        off = signal(some, fixed, processing) - signal(some, fixed - {cause}, processing)
        assert np.allclose(off, part * window, atol=1e-16), cause


def test_a_maximum_that_leaves_the_band_s_edge_makes_a_spike_that_the_true_level_does_not() -> None:
    fall = 0.05

    def rise(diameter: float) -> float:
        """Give by how much an edge's intensity is above the interior maximum."""
        x = np.linspace(0.3, 1, 200_001)
        inside = -(1 - fall * x) * np.cos(2 * N * diameter * (K[0] + (K[-1] - K[0]) * x))
        return float(-np.cos(2 * N * diameter * K[0]) - inside.max())

    leaves = brentq(rise, 1.135, 1.16, xtol=1e-9)
    around = leaves + np.linspace(-0.01, 0.01, 201)
    read = READING._replace(diameter=around)
    stencil = at_point(around, fall * UNIT - 1)
    spiked = slopes(stencil, ALL, read)
    jump = int(np.abs(np.diff(spiked)).argmax())
    assert around[jump] == pytest.approx(leaves, abs=2e-4)
    assert abs(spiked[jump + 2] - spiked[jump - 1]) > 1
    assert np.abs(np.diff(slopes(stencil, ALL - {"centre"}, read))).max() < 0.01


def test_parts_sum_to_the_whole_and_equal_ones_are_equal() -> None:
    random = np.random.default_rng(3)
    terms = {cause: random.normal(size=20) for cause in "abc"}
    subsets = [frozenset(s) for n in range(4) for s in itertools.combinations("abc", n)]
    # what adds up has its own terms; a product is shared by its factors alike
    for values in (
        {s: np.sum([terms[c] for c in s], axis=0) * np.ones(20) for s in subsets},
        {s: terms["a"] * ({"a", "b"} <= s) + terms["c"] * ("c" in s) for s in subsets},
        {s: random.normal(size=20) for s in subsets},
    ):
        part = shapley(values)
        whole, none = values[frozenset("abc")], values[frozenset()]
        assert np.allclose(sum(part.values()), whole - none, atol=1e-12)
        shares = [variance_share(p, whole) for p in (*part.values(), none)]
        assert sum(shares) == pytest.approx(1, abs=1e-12)
    part = shapley({s: np.sum([terms[c] for c in s], axis=0) * np.ones(20) for s in subsets})
    assert all(np.allclose(part[c], terms[c]) for c in "abc")
    part = shapley({s: terms["a"] * ({"a", "b"} <= s) + terms["c"] * ("c" in s) for s in subsets})
    assert np.allclose(part["a"], terms["a"] / 2)
    assert np.allclose(part["b"], part["a"])
    assert np.allclose(part["c"], terms["c"])


def test_shapley_is_the_mean_over_all_orders() -> None:
    random = np.random.default_rng(4)
    values = {
        frozenset(s): random.normal(size=3)
        for n in range(5)
        for s in itertools.combinations("abcd", n)
    }
    mean = {cause: np.zeros(3) for cause in "abcd"}
    for order in itertools.permutations("abcd"):
        for i, cause in enumerate(order):
            before = frozenset(order[:i])
            mean[cause] += (values[before | {cause}] - values[before]) / 24
    found = shapley(values)
    assert all(np.allclose(found[c], mean[c], atol=1e-12) for c in "abcd")


def test_a_slope_that_is_the_same_everywhere_has_no_shares() -> None:
    flat, bent = np.full(5, 24.0), np.array([24.0, 24.0, 25.0, 24.0, 24.0])
    assert share_status(flat) == ShareStatus.NO_SCATTER
    assert np.isnan(variance_share(bent, flat))
    assert share_status(bent) == ShareStatus.KNOWN
    assert np.isfinite(variance_share(bent, bent))
