"""The nodes of a tile: rays aimed at them, their weights, the field they sum to and its error."""

import math

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.optics.beam import Beam, aim
from octsim.schemes.paths.aperture_tiles import Tile, across, images
from octsim.schemes.paths.chebyshev import FIT, trailing, transform
from octsim.schemes.paths.check_rays import weight_error
from octsim.schemes.paths.falloffs import falloff_at
from octsim.schemes.paths.line_crossings import LESS_S, LESS_V, Cut
from octsim.schemes.paths.patch_integrals import moments
from octsim.schemes.paths.workspace import Point, Workspace

CRUDE = 0.25
"""Error of a trapezoid rule where not all rays take the path, over its field."""
_CLOSER = 1 / 3  # error of a rule, over how far a rougher one is from it, at most


@register_jitable(forceinline=True)
def aim_at(point: Point, s: float, v: float, beam: Beam, k: int) -> None:
    """Aim a beam's ray k at a place of the aperture."""
    radius, xi = point.detector.objective_radius, across(s, point.symmetric)
    x, y = xi * math.sqrt(1 - v) * radius, math.sqrt(v) * radius
    beam.vx[k], beam.vy[k], beam.vz[k] = aim(x, y, point.detector.focus_distance)


@register_jitable
def aim_at_tile(point: Point, tile: Tile, n: int, m: int, kind: int, beam: Beam) -> None:
    """Aim a beam's first n x m rays at the nodes of a tile."""
    along_s, along_v = point.tables.nodes_s[kind, n], point.tables.nodes_v[kind, m]
    for i in range(n):
        s = tile.s_min + (tile.s_max - tile.s_min) * along_s[i]
        for j in range(m):
            v = tile.v_min + (tile.v_max - tile.v_min) * along_v[j]
            aim_at(point, s, v, beam, i * m + j)


@register_jitable
def map_tile(
    point: Point, tile: Tile, n: int, m: int, stride: int, kind: int, space: Workspace
) -> None:
    """Fit polynomials to where a tile's rays return to; `stride` rays have the same s."""
    bundle, along_s, along_v = (
        space.bundle,
        point.tables.nodes_s[kind, n],
        point.tables.nodes_v[kind, m],
    )
    to_s, to_v = point.tables.transforms_s[kind, n], point.tables.transforms_v[kind, m]
    values, others = space.values, space.others
    for j in range(m):
        v = tile.v_min + (tile.v_max - tile.v_min) * along_v[j]
        half, over_y = math.sqrt(1 - v), 1 / math.sqrt(v)
        for i in range(n):
            s = tile.s_min + (tile.s_max - tile.s_min) * along_s[i]
            over_x = 1 / (half * math.sqrt(s)) if point.symmetric else 1.0
            values[i, j] = bundle.x[i * stride + j] * over_x
            others[i, j] = bundle.y[i * stride + j] * over_y
    transform(values, n, m, to_s, to_v, space.between, space.returns.x)
    transform(others, n, m, to_s, to_v, space.between, space.returns.y)
    for i in range(n):
        for j in range(m):
            values[i, j], others[i, j] = bundle.cos[i * stride + j], bundle.inside[i * stride + j]
    transform(values, n, m, to_s, to_v, space.between, space.returns.cos)
    transform(others, n, m, to_s, to_v, space.between, space.returns.inside)
    # what is within the rim by no more than the polynomial's error stays within
    along_s, along_v = trailing(space.returns.inside, n, m)
    space.returns.inside[0, 0] += along_s + along_v


@register_jitable
def weigh(
    point: Point, tile: Tile, n: int, m: int, tolerance: float, space: Workspace
) -> tuple[float, float]:
    """Find the weight of each node of a tile, and by a rougher rule.

    Returns their sum, and how far off the tile's polynomials put the falloff of check rays.
    """
    cut = Cut(
        space.returns, n, m, tile, point.symmetric, point.detector.radius, point.falloff,
        point.tables.bernstein,
    )  # fmt: skip
    total = moments(cut, tolerance, point.tables.rules, space.line, space.exact, space.rough)
    _to_nodes(point, space.exact, n, m, n, m, space.between, space.weight)
    _to_nodes(point, space.rough, n - LESS_S, m - LESS_V, n, m, space.between, space.rough_weight)
    for i in range(n):
        for j in range(m):
            difference = space.rough_weight[i, j] - space.weight[i, j]
            space.rough_weight[i, j] = space.weight[i, j] + _CLOSER * difference
    return total, weight_error(space.checks, cut, space.line)


@register_jitable
def _to_nodes(
    point: Point, integrals: NDArray[np.float64], p: int, q: int, n: int, m: int,
    between: NDArray[np.float64], weight: NDArray[np.float64],
) -> None:  # fmt: skip
    """Turn p x q integrals of polynomials into the weights of n x m nodes."""
    along_s, along_v = point.tables.transforms_s[FIT, n], point.tables.transforms_v[FIT, m]
    for a in range(p):
        for j in range(m):
            total = 0.0
            for b in range(q):
                total += integrals[a, b] * along_v[b, j]
            between[a, j] = total
    multiplicity = images(point.symmetric)
    for i in range(n):
        for j in range(m):
            total = 0.0
            for a in range(p):
                total += along_s[a, i] * between[a, j]
            weight[i, j] = multiplicity * total


@register_jitable
def weigh_crudely(
    point: Point, tile: Tile, n: int, m: int, kind: int, space: Workspace
) -> tuple[float, float]:
    """Weigh the nodes of a small tile of which not all take the path: trapezoids, as they come.

    Returns the magnitude of the field, and its error, taken for a fixed part of it.
    """
    bundle, radius = space.bundle, point.detector.radius
    along_s, along_v = point.tables.nodes_s[kind, n], point.tables.nodes_v[kind, m]
    multiplicity, size = images(point.symmetric), 0.0
    s_width, v_width = tile.s_max - tile.s_min, tile.v_max - tile.v_min
    for i in range(n):
        left = across(tile.s_min + s_width * along_s[max(i - 1, 0)], point.symmetric)
        right = across(tile.s_min + s_width * along_s[min(i + 1, n - 1)], point.symmetric)
        for j in range(m):
            v = tile.v_min + v_width * along_v[j]
            below = math.sqrt(tile.v_min + v_width * along_v[max(j - 1, 0)])
            above = math.sqrt(tile.v_min + v_width * along_v[min(j + 1, m - 1)])
            k = i * m + j
            space.weight[i, j], space.rough_weight[i, j] = 0.0, 0.0
            if not bundle.followed[k] or bundle.inside[k] < 0:
                bundle.amplitude[k], bundle.optical_path_length[k] = 0.0, 0.0
                continue
            off_axis = math.hypot(bundle.x[k], bundle.y[k]) / (bundle.cos[k] * radius)
            squared = off_axis * off_axis
            collected = falloff_at(point.falloff, squared, 0.0) if squared < 1 else 0.0
            place = 0.25 * (right - left) * (above - below) * math.sqrt(1 - v)
            space.weight[i, j] = multiplicity * place * collected
            space.rough_weight[i, j] = (1 - CRUDE) * space.weight[i, j]
            size += space.weight[i, j] * abs(bundle.amplitude[k])
    return size, CRUDE * size


@register_jitable
def sum_tile(point: Point, n: int, m: int, space: Workspace) -> tuple[float, float]:
    """Sum a tile's nodes to a field: its magnitude, and its error by the rougher rule."""
    size, error = 0.0, 0.0
    for k in (point.k_mid, point.k_max):
        real, imaginary, error_real, error_imaginary = 0.0, 0.0, 0.0, 0.0
        for i in range(n):
            for j in range(m):
                amplitude = space.bundle.amplitude[i * m + j]
                phase = k * space.bundle.optical_path_length[i * m + j]
                cos, sin = amplitude * math.cos(phase), amplitude * math.sin(phase)
                w = space.weight[i, j]
                less = w - space.rough_weight[i, j]
                real += w * cos
                imaginary += w * sin
                error_real += less * cos
                error_imaginary += less * sin
        size = max(size, math.hypot(real, imaginary))
        error = max(error, math.hypot(error_real, error_imaginary))
    return size, error


@register_jitable(forceinline=True)
def followed_of(space: Workspace, num: int) -> tuple[int, float]:
    """Count the rays that take a path, and return their largest amplitude."""
    count, amplitude = 0, 0.0
    for i in range(num):
        if space.bundle.followed[i]:
            count += 1
            amplitude = max(amplitude, abs(space.bundle.amplitude[i]))
    return count, amplitude


@register_jitable
def map_errors(point: Point, tile: Tile, n: int, m: int, space: Workspace) -> tuple[float, float]:
    """Return how far off, over R_det, polynomials may put the rays' return: along s, along v."""
    xi = max(abs(across(tile.s_min, point.symmetric)), abs(across(tile.s_max, point.symmetric)))
    x_s, x_v = trailing(space.returns.x, n, m)
    y_s, y_v = trailing(space.returns.y, n, m)
    scale_x = (xi if point.symmetric else 1.0) / point.detector.radius
    scale_y = math.sqrt(tile.v_max) / point.detector.radius
    return x_s * scale_x + y_s * scale_y, x_v * scale_x + y_v * scale_y


@register_jitable
def rim_errors(n: int, m: int, space: Workspace) -> tuple[float, float]:
    """Return what polynomials may misplace of a tile at the objective's rim: along s, along v.

    Nothing, where all of the tile returns well within the rim.
    """
    inside = space.returns.inside
    along_s, along_v = trailing(inside, n, m)
    vary = -abs(inside[0, 0])
    for a in range(n):
        for b in range(m):
            vary += abs(inside[a, b])
    if inside[0, 0] - vary > 2 * (along_s + along_v):
        return 0.0, 0.0
    return along_s, along_v


@register_jitable
def field_errors(point: Point, n: int, m: int, space: Workspace) -> tuple[float, float]:
    """Return how far off polynomials may put the rays' field at each place: along s, along v.

    From the field's Chebyshev coefficients of the highest orders, at the shortest wavelength.
    """
    values, others, bundle = space.values, space.others, space.bundle
    for i in range(n):
        for j in range(m):
            amplitude = bundle.amplitude[i * m + j]
            phase = point.k_max * bundle.optical_path_length[i * m + j]
            values[i, j] = amplitude * math.cos(phase)
            others[i, j] = amplitude * math.sin(phase)
    to_s, to_v = point.tables.transforms_s[FIT, n], point.tables.transforms_v[FIT, m]
    transform(values, n, m, to_s, to_v, space.between, space.exact)
    transform(others, n, m, to_s, to_v, space.between, space.rough)
    along_s, along_v = 0.0, 0.0
    for b in range(m):
        for a in range(n - LESS_S, n):
            along_s += math.hypot(space.exact[a, b], space.rough[a, b])
    for a in range(n):
        for b in range(m - LESS_V, m):
            along_v += math.hypot(space.exact[a, b], space.rough[a, b])
    return _CLOSER * along_s, _CLOSER * along_v
