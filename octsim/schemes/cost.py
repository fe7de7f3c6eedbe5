"""What the light of one point takes, typically, by each scheme: known before any is traced.

These rates were measured on one machine (`snakemake tradeoff`); what they decide, the size of
blocks, is to be the same on all.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

_RAY_BYTES = 32  # of the four numbers that are kept of a ray
_DETECTED = 0.18  # arrivals of a launched ray that are detected

SAMPLE_BYTES = 72
"""Of a sample at which the field of rays is kept, with up to four fields."""
SAMPLED_MEMORY = 9.0
"""How many times the memory rays take while such fields are found."""
SAMPLED = 4.0
"""How many times as long rays take that are the same at all wavenumbers, but not their fields."""

_NODE_BYTES = 136  # of a wavenumber, and four complex fields of two polarisations
_MOST_EFFORT = 16.0  # more is beyond the most orders, and is not solved


MOST_WAVES = 200
"""Largest order of partial waves that are solved for."""
MOST_WAVENUMBERS = 400
"""Nodes over the band that are solved for."""


def partial_waves(size: float, digits: float) -> float:
    """Return the largest order of partial waves that is usually enough.

    Parameters
    ----------
    size : float
        k n d / 2, of the larger of the indices within and around the cylinder.
    digits : float
        −log₁₀ of the accuracy.
    """
    return size + (1 + 0.35 * digits) * float(size ** (1 / 3)) + 0.5


def wavenumbers(reach: float, band: float, digits: float) -> float:
    """Return the nodes over the wavenumber that are usually enough.

    Parameters
    ----------
    reach : float
        Optical path of the light that is farthest from that whose phase is taken out, µm.
    band : float
        Width of the band, 1/µm.
    digits : float
        −log₁₀ of the accuracy.
    """
    return 4.5 + 0.75 * band * reach + 1.35 * digits


class PointCost(NamedTuple):
    """What the light of one point takes."""

    size: float
    """Bytes that it is kept in."""
    seconds: float
    """Processor time to find it."""
    paths: int
    """Light paths in it, about."""
    memory: float
    """Bytes that each thread has to work in, beyond those of any process."""
    summed: float = 0.0
    """Rays of it that are summed at each wavenumber; none where a field is kept."""


class Additions(NamedTuple):
    """What a scene has beside the thesis's one cylinder over one plane, as far as it takes time."""

    surfaces: int = 0
    """Planes, and walls of a cylinder, on a way of light that they split."""
    neighbours: int = 0
    """Other cylinders."""
    apart: float = 0.0
    """How far the axes of cylinders are from each other at most, µm."""
    cover: float = 0.0
    """Height of a plane above the cylinders over that below them, µm; 0 of none."""
    aside: bool = False
    """Whether a cylinder is off the optical axis."""
    tilted: bool = False
    """Whether a cylinder is not level."""


def of_rays(options: Mapping[str, Any], _diameter: float) -> PointCost:
    """Return what counted rays take; within a factor of two from 10³ to 10⁷ of them."""
    rays = options["rays"]
    return PointCost(
        size=_RAY_BYTES * (1 + _DETECTED * rays), seconds=1.3e-4 + 8.8e-7 * rays, paths=40,
        memory=115.0 * rays, summed=_DETECTED * rays,
    )  # fmt: skip


_PIECES = 72.0  # of each ray of the thesis's
_AT_FIVE = 18.0  # of a ray that meets five surfaces

MOST_PIECES = 1e9
"""Straight pieces of ray in the trees of a point, by estimate, beyond which none is begun: their
arrivals would not go into a gigabyte."""


def tree_pieces(surfaces: int, max_intersections: int, min_amplitude: float) -> float:
    """Return about how many straight pieces of ray the tree of one ray has.

    Each meeting has up to two, and the more the fewer escape: of the thesis's 1.24 as many as the
    last, with one shell 1.66, with two 1.82, as was measured. What drops rays ends that.

    Parameters
    ----------
    surfaces : int
        Planes, and walls of a cylinder, that the thesis's scene does not have.
    max_intersections : int
    min_amplitude : float
    """
    alike = 0.45**surfaces
    pieces = _AT_FIVE * (2 - 0.76 * alike) ** (max_intersections - 5)
    if min_amplitude > 0:
        pieces = min(pieces, max(_AT_FIVE, min_amplitude ** -(0.6 - 0.32 * alike)))
    return pieces


def of_tree(cost: PointCost, pieces: float) -> PointCost:
    """Return what counted rays take whose trees have so many pieces, and not the thesis's."""
    times = pieces / _PIECES
    return cost._replace(
        size=cost.size * times, seconds=cost.seconds * times, memory=cost.memory * times,
        summed=cost.summed * times,
    )  # fmt: skip


def of_waves(options: Mapping[str, Any], diameter: float) -> PointCost:
    """Return what partial waves take that are summed to an accuracy.

    Fitted within a factor of two of the time, of the thesis's scene, from 0.5 to 5 µm at 1e-2 and
    1e-4 and to 3 µm at 1e-8: orders go with the diameter, and how often they are raised with both.
    """
    digits = -math.log10(options["accuracy"])
    effort = min(diameter * digits**0.8, _MOST_EFFORT)
    return PointCost(
        size=_NODE_BYTES * (3 + 1.3 * digits * (1 + diameter)),
        seconds=4e-3 + 4e-4 * diameter**2.5 * digits**2, paths=4,
        memory=2e6 * math.exp(0.42 * effort),
    )  # fmt: skip


def of_paths(options: Mapping[str, Any], _diameter: float) -> PointCost:
    """Return what light paths take that are integrated to an accuracy."""
    digits = -math.log10(options["accuracy"])
    rays = 45 * 10 ** (0.18 * digits)
    return PointCost(
        size=_RAY_BYTES * rays, seconds=4.7e-4 * 10 ** (0.145 * digits), paths=12, memory=0.0,
        summed=rays,
    )  # fmt: skip


def times_of_waves(added: Additions) -> float:
    """Return how many times as long waves take for what a scene has more; within threefold."""
    times = 1 + 0.5 * bool(added.surfaces)
    if added.cover:
        # light from above is out of focus, and takes the more nodes over k_x, k_y and k
        times *= 4 + 0.5 * added.cover**2.2
    # each sends to each
    return times * (1 + 5 * added.neighbours * (added.neighbours + 1) * (0.3 + added.apart))


def times_of_paths(added: Additions) -> float:
    """Return how many times as long light paths take for what a scene has more; within threefold.

    Most is for the many faint ones, each with its own edges.
    """
    times = 5.0 if added.surfaces else 1.0
    if added.tilted:
        times *= 25
    if added.neighbours:
        return times * 7 * (added.neighbours + 1)
    return 2 * times if added.aside else times
