"""The ray tree with 50 digits: a literal reading of the thesis, to measure rounding against.

An *input* is what octsim is given: the doubles of the config, and the doubles of a ray's position
(x, y) on the objective's plane. Each is taken as exact, and nothing is rounded to a double after
that. The formulas are the plainest there are (a ray starts at the objective, a cylinder is a
quadratic equation, every coefficient stands as in the thesis): with 50 digits cancellation costs
nothing, so that no rearrangement of octsim's is shared. Lengths are in µm.

A tree is full of *decisions*: whether a ray meets the cylinder, is totally reflected, passes the
objective, reaches the fibre. Each has a *margin*, a number without unit that is positive where the
answer is yes; a small one means that rounding may decide.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

from octsim.base.errors import not_installed

try:
    from mpmath import MPContext
except ImportError:
    raise not_installed("mpmath", "stability") from None

from octsim.config.models import Config

DIGITS = 50
Exact = Any  # an mpf, which carries no types
Triple = tuple[Exact, Exact, Exact]

numbers = MPContext()
numbers.dps = DIGITS
ZERO, ONE = numbers.mpf(0), numbers.mpf(1)

GLASS, WATER, NEURON = "glass", "water", "neuron"
# A ray returned to the rim itself counts as within it (docs/physics.md).
RIM = ONE + numbers.mpf("1e-12")


@dataclass(frozen=True)
class Inputs:
    """All that the path of one ray depends on; derivatives are with respect to these."""

    glass: Exact
    water: Exact
    neuron: Exact
    gap: Exact
    diameter: Exact
    focus: Exact
    focus_distance: Exact
    numerical_aperture: Exact
    magnification: Exact
    core_diameter: Exact
    x: Exact
    y: Exact

    @cached_property
    def radius(self) -> Exact:
        """Radius of the cylinder."""
        return self.diameter / 2

    @cached_property
    def axis(self) -> Exact:
        """Height of the cylinder's axis."""
        return self.gap + self.diameter / 2

    @cached_property
    def aperture(self) -> Exact:
        """Radius of the objective."""
        sine = self.numerical_aperture / self.glass
        return self.focus_distance * numbers.tan(numbers.asin(sine))


def inputs_of(config: Config, diameter: float, focus: float, x: float, y: float) -> Inputs:
    """Return the doubles of a config, of a point and of a ray's position as exact numbers."""
    scene, objective = config.scene, config.objective
    given = (
        config.objective_index, config.host_index, config.swept_index, scene.swept_gap, diameter,
        focus, objective.focus_distance, objective.numerical_aperture, objective.magnification,
        config.detector.core_diameter, x, y,
    )  # fmt: skip
    return Inputs(*map(numbers.mpf, given))


@dataclass(frozen=True)
class Ray:
    """One straight piece of light, at its start; `code` as `path_name` reads it."""

    at: Triple
    along: Triple
    amplitude: Exact
    path: Exact
    medium: str
    code: int = 1
    meetings: int = 0
    on_cylinder: bool = False
    margins: tuple[tuple[str, Exact], ...] = ()


@dataclass(frozen=True)
class End:
    """How one light path of a ray ended.

    `reason` is ``detected``, or the decision that ended it; `amplitude` is relative to launch and
    carries the falloff. The margins are those of all decisions on the way, in order.
    """

    code: int
    reason: str
    amplitude: Exact
    path: Exact
    margins: tuple[tuple[str, Exact], ...]


def launch(given: Inputs) -> Ray:
    """Return a ray at the objective, towards the focus, where its path is zero (thesis §4.1)."""
    to_focus = (-given.x, -given.y, given.focus_distance)
    distance = numbers.sqrt(sum((part * part for part in to_focus), ZERO))
    vx, vy, vz = (part / distance for part in to_focus)
    at = (given.x, given.y, given.focus - given.focus_distance)
    return Ray(at, (vx, vy, vz), ONE, -given.glass * distance, GLASS)


def _moved(ray: Ray, distance: Exact, index: Exact) -> Ray:
    (x, y, z), (vx, vy, vz) = ray.at, ray.along
    at = (x + distance * vx, y + distance * vy, z + distance * vz)
    return replace(ray, at=at, path=ray.path + index * distance)


def _to_cylinder(given: Inputs, ray: Ray) -> tuple[Exact | None, Exact]:
    """Return t of |p + t v|² = r² across the axis, None for a miss, and the margin of a hit."""
    (x, _, z), (vx, _, vz) = ray.at, ray.along
    z -= given.axis
    a, b = vx * vx + vz * vz, x * vx + z * vz
    if ray.medium == NEURON:  # the root 0 is where it stands
        return -2 * b / a, ONE
    c = x * x + z * z - given.radius**2
    quarter = b * b - a * c
    margin = quarter / (a * given.radius**2)  # (h / r)²
    if b >= 0 or margin <= 0:
        return None, margin if margin < 0 else -abs(b) / given.radius
    return (-b - numbers.sqrt(quarter)) / a, margin


def _split(given: Inputs, ray: Ray, surface: str) -> Iterator[Ray]:
    """Yield the reflected, then the transmitted light of a ray that stands on a surface (§4.3)."""
    beyond = (
        (WATER if ray.medium == GLASS else GLASS)
        if surface == "P"
        else (NEURON if ray.medium == WATER else WATER)
    )
    n_i, n_t = getattr(given, ray.medium), getattr(given, beyond)
    if surface == "P":
        nx, nz = ZERO, -ONE if ray.medium == GLASS else ONE
    else:
        side = 1 if ray.medium == WATER else -1
        nx = side * ray.at[0] / given.radius
        nz = side * (ray.at[2] - given.axis) / given.radius
    vx, vy, vz = ray.along
    cos_i = -(vx * nx + vz * nz)
    ratio = n_i / n_t
    squared = 1 - ratio**2 * (1 - cos_i**2)
    margins = (*ray.margins, ("refracted", squared))
    code = 4 * ray.code + (0 if surface == "P" else 2)
    onward = replace(
        ray, meetings=ray.meetings + 1, on_cylinder=surface == "C", margins=margins, code=code
    )
    reflected = (vx + 2 * cos_i * nx, vy, vz + 2 * cos_i * nz)
    if squared < 0:
        yield replace(onward, along=reflected)
        return
    cos_t = numbers.sqrt(squared)
    parallel, across = n_t * cos_i + n_i * cos_t, n_i * cos_i + n_t * cos_t
    r_parallel = (n_t * cos_i - n_i * cos_t) / parallel
    r_across = (n_i * cos_i - n_t * cos_t) / across
    r = numbers.sqrt((r_parallel**2 + r_across**2) / 2)
    t = 2 * n_i * cos_i * numbers.sqrt((parallel**-2 + across**-2) / 2)
    r = -r if n_t > n_i else r
    yield replace(onward, along=reflected, amplitude=ray.amplitude * r)
    turn = ratio * cos_i - cos_t
    refracted = (ratio * vx + turn * nx, ratio * vy, ratio * vz + turn * nz)
    yield replace(
        onward, along=refracted, amplitude=ray.amplitude * t, medium=beyond, code=code + 1
    )


def _detect(given: Inputs, ray: Ray) -> End:
    """Return the end of a ray in glass: at the objective, and traced back to the fibre (§4.4)."""
    plane = given.focus - given.focus_distance
    ray = _moved(ray, (plane - ray.at[2]) / ray.along[2], given.glass)
    limit = RIM * given.aperture
    at_objective = 1 - (ray.at[0] ** 2 + ray.at[1] ** 2) / limit**2
    back = _moved(ray, (given.focus - ray.at[2]) / ray.along[2], given.glass)
    image = given.core_diameter / (2 * given.magnification)
    rho_squared = back.at[0] ** 2 + back.at[1] ** 2
    weight = 1 - rho_squared / image**2
    focal = given.focus_distance * given.magnification / (given.magnification + 1)
    lens = given.magnification * (numbers.sqrt(focal**2 + rho_squared) - focal)
    margins = (*ray.margins, ("within objective", at_objective), ("within fibre", weight))
    reason = "detected"
    if weight <= 0:
        reason = "within fibre"
    if at_objective < 0:
        reason = "within objective"
    return End(ray.code, reason, ray.amplitude * weight, back.path + lens, margins)


def _step(given: Inputs, ray: Ray) -> tuple[str, Ray | None, End | None]:
    """Return the surface that a ray meets next with the ray there, or the ray's end."""
    heads_up = ray.along[2] > 0
    if ray.medium == GLASS and not heads_up:
        return "O", None, _detect(given, ray)
    if ray.medium != NEURON and (ray.medium == GLASS or not heads_up):
        if ray.medium == WATER:
            ray = replace(ray, margins=(*ray.margins, ("downwards", -ray.along[2])))
        moved = _moved(ray, -ray.at[2] / ray.along[2], getattr(given, ray.medium))
        return "P", moved, None
    if ray.medium == WATER and ray.on_cylinder:
        margins = (*ray.margins, ("downwards", -ray.along[2]))
        return "", None, End(ray.code, "downwards", ray.amplitude, ray.path, margins)
    distance, margin = _to_cylinder(given, ray)
    if ray.medium == WATER:
        ray = replace(ray, margins=(*ray.margins, ("meets the cylinder", margin)))
    if distance is None:
        end = End(ray.code, "meets the cylinder", ray.amplitude, ray.path, ray.margins)
        return "", None, end
    return "C", _moved(ray, distance, getattr(given, ray.medium)), None


def tree(given: Inputs, max_intersections: int) -> list[End]:
    """Return all light paths of one ray that are detected."""
    detected, waiting = [], [launch(given)]
    while waiting:
        ray = waiting.pop()
        surface, met, end = _step(given, ray)
        if end is not None and end.reason == "detected":
            detected.append(end)
        if met is not None and ray.meetings < max_intersections:
            waiting.extend(_split(given, met, surface))
    return detected


def follow(given: Inputs, code: int) -> End:
    """Return the end of one light path of a ray; its `code` tells where it went instead."""
    digits = []
    while code > 1:
        code, digit = divmod(code, 4)
        digits.append(digit)
    ray = launch(given)
    while True:
        surface, met, end = _step(given, ray)
        if end is not None:
            return end
        if not digits or met is None or "PC".index(surface) != digits[-1] // 2:
            return End(ray.code, "surface", ray.amplitude, ray.path, ray.margins)
        children = list(_split(given, met, surface))
        transmitted = digits.pop() % 2
        if transmitted and len(children) == 1:
            other = children[0]
            return End(other.code, "refracted", other.amplitude, other.path, other.margins)
        ray = children[transmitted]


def sensitivities(given: Inputs, code: int) -> Iterator[tuple[Exact, End]]:
    """Yield 1 / (relative step) and a path's end, with each input larger by that step in turn.

    With the unperturbed end these are difference quotients of twice as many digits as a double has.
    Inputs that are zero have no rounding, and are left out.
    """
    step = numbers.mpf("1e-26")
    for field in fields(given):
        value = getattr(given, field.name)
        if value != 0:
            yield 1 / step, follow(replace(given, **{field.name: value * (1 + step)}), code)
