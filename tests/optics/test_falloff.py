"""Falloffs: their formulas, 1 on the axis, and nothing left beyond their reach."""

import numpy as np
import pytest

from octsim.optics.detector import detector_radius, falloff
from octsim.optics.falloff import (
    Cosine,
    Falloff,
    FibreFalloff,
    GaussianFalloff,
    Parabolic,
    TopHat,
)
from octsim.optics.fibre_mode import lp01

BAND = 2 * np.pi / np.linspace(0.85, 0.68, 5)
K = float(BAND[2])
FIBRE = FibreFalloff(2.5, 0.13)
EDGED: list[Falloff] = [Parabolic(), TopHat(), Cosine()]
UNCUT: list[Falloff] = [GaussianFalloff(1.0), GaussianFalloff(0.7), FIBRE]


def at(kind: Falloff, u: float, wavenumber: float = K) -> float:
    return float(kind.amplitude(np.array(u * u), wavenumber))


def test_the_parabola_is_the_thesis_detectors() -> None:
    squared = np.random.default_rng(1).random((50, 20))
    assert np.array_equal(Parabolic().amplitude(squared, K), falloff(squared))


@pytest.mark.parametrize("kind", EDGED + UNCUT)
def test_the_axis_counts_fully(kind: Falloff) -> None:
    assert at(kind, 0) == 1


def test_the_others_follow_their_formulas() -> None:
    assert at(TopHat(), 0.99) == 1
    assert at(Cosine(), 2 / 3) == pytest.approx(0.5, rel=1e-15)
    assert at(GaussianFalloff(1.0), 1) == pytest.approx(np.exp(-1), rel=1e-15)
    assert at(GaussianFalloff(0.5), 2) == pytest.approx(np.exp(-1), rel=1e-15)
    assert at(GaussianFalloff(0.5), 0.8) == pytest.approx(np.exp(-0.16), rel=1e-15)


def test_the_fibres_mode_is_seen_at_the_focus() -> None:
    core, magnification, rho = 5.0, 12.5, 0.3
    in_fibre = rho * magnification / (core / 2)
    mode = lp01(core / 2, 0.13, K).amplitude(np.array(in_fibre))
    u = rho / detector_radius(core, magnification)
    assert at(FIBRE, u) == pytest.approx(float(mode), rel=1e-14)


@pytest.mark.parametrize("kind", EDGED)
def test_those_with_an_edge_reach_up_to_it(kind: Falloff) -> None:
    assert kind.reach(float(min(BAND))) == 1


@pytest.mark.parametrize("kind", UNCUT)
def test_those_without_reach_to_where_hardly_anything_is_left(kind: Falloff) -> None:
    reach = kind.reach(float(min(BAND)))
    assert max(at(kind, 0.999 * reach, k) for k in BAND) > 1e-13
    assert all(at(kind, 1.0001 * reach, k) < 1e-13 for k in BAND)


@pytest.mark.parametrize("kind", EDGED + UNCUT)
def test_only_the_fibre_depends_on_the_wavenumber(kind: Falloff) -> None:
    differs = at(kind, 0.8, BAND[0]) != at(kind, 0.8, BAND[-1])
    assert differs == kind.dispersive == (kind is FIBRE)


@pytest.mark.parametrize("kind", EDGED + UNCUT)
def test_shapes_are_kept_and_falloffs_hashable(kind: Falloff) -> None:
    assert kind.amplitude(np.full((3, 4), 0.25), K).shape == (3, 4)
    assert len({kind, kind}) == 1
