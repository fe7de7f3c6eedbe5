r"""A slow, literal tracer of any scene, with every effect of `literal_effects`: an oracle.

A ray knows where it is: in which layer, in which cylinder there, and how many of its walls are
around it. What it can meet next are the planes of its layer and the walls next to it; what is
beyond a plane is found from the place alone: which walls are around it, if that layer is the
cylinders'. A wall or plane with one medium on both sides, by its name, is passed as if it were not
there.

Conventions: ``effects.md`` section 1, rows "layers", "cylinders" and "shells". No code is shared
with the package. Units: µm, 1/µm, degrees.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from literal_effects import Rays as Beam
from literal_effects import collect, launch, polarised_intensity, times, vogel_disk
from literal_effects_setup import GLASS, Colour, Index, Setup
from literal_effects_split import split_polarised, split_thesis
from numpy.typing import NDArray

Array = NDArray[Any]
NOTHING, LOWER, UPPER, OUTER, INNER = range(5)
"""What a ray stands on, or meets: nothing, a plane of its layer, the wall around it, one inside."""


@dataclass(frozen=True)
class Tube:
    """A cylinder; lengths are of its outermost wall, shells (medium, thickness) outside in."""

    medium: str = "neuron"
    diameter: float = 1.4
    x: float = 0.0
    gap: float = 0.005
    azimuth: float = 0.0
    elevation: float = 0.0
    shells: tuple[tuple[str, float], ...] = ()

    @property
    def media(self) -> list[str]:
        """Media from outside in."""
        return [*(medium for medium, _ in self.shells), self.medium]

    @property
    def radii(self) -> list[float]:
        """Radius of each wall, outside in."""
        inner = np.cumsum([0.0, *(thickness for _, thickness in self.shells)])
        return list(self.diameter / 2 - inner)

    @property
    def axis(self) -> Array:
        """Unit vector along it."""
        a, e = np.radians([self.azimuth, self.elevation])
        return np.array([-np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)])


@dataclass(frozen=True)
class Scene:
    """Layers (medium, thickness) from below, and the tubes in one of them."""

    layers: tuple[tuple[str, float], ...] = (("glass", np.inf), ("water", np.inf))
    host: int = 1
    tubes: tuple[Tube, ...] = (Tube(),)
    media: Mapping[str, Index] = field(default_factory=dict)

    def bottom(self, layer: int) -> float:
        """Height of a layer's lower plane."""
        return float(sum(thickness for _, thickness in self.layers[1:layer]))

    def centre(self, tube: int) -> Array:
        """Where a tube's axis is above the x axis."""
        one = self.tubes[tube]
        return np.array([one.x, 0.0, self.bottom(self.host) + one.gap + one.diameter / 2])

    def medium(self, layer: int, tube: int, depth: int) -> str:
        """Medium in a layer, `depth` walls deep in a tube."""
        return self.layers[layer][0] if depth == 0 else self.tubes[tube].media[depth - 1]


@dataclass(frozen=True)
class Rays:
    """Rays (R,), what they carry, where they are and what they stand on."""

    position: Array
    direction: Array
    carried: Array
    path: Array
    layer: Array
    tube: Array
    depth: Array
    on: Array
    on_tube: Array
    """The tube whose wall they stand on."""
    met: Array
    """Meetings so far."""

    def __getitem__(self, which: Array) -> "Rays":
        return Rays(*(values[which] for values in vars(self).values()))


def joined(parts: list[Rays]) -> Rays:
    return Rays(
        *(
            np.concatenate(values)
            for values in zip(*(vars(one).values() for one in parts), strict=True)
        )
    )


def crossings(centre: Array, axis: Array, radius: float, rays: Rays) -> tuple[Array, Array]:
    """Distances at which lines come to a cylinder and leave it; NaN where they pass."""
    way = rays.position - centre
    way = way - np.outer(way @ axis, axis)
    v = rays.direction - np.outer(rays.direction @ axis, axis)
    a = np.sum(v * v, axis=1)
    b = np.sum(v * way, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        # way's part across v, squared, is the same as the discriminant's, with fewer digits lost
        side = way - (b / a)[:, np.newaxis] * v
        half = np.sqrt(radius**2 - np.sum(side * side, axis=1)) / np.sqrt(a)
        return -b / a - half, -b / a + half


def distances(scene: Scene, rays: Rays) -> tuple[Array, Array, Array]:
    """Distance to what rays of one place meet next, what that is, and of which tube."""
    layer, tube, depth, on = (int(one[0]) for one in (rays.layer, rays.tube, rays.depth, rays.on))
    found: list[tuple[Array, int, int]] = []
    v_z = rays.direction[:, 2]
    bottom = scene.bottom(layer)
    # a level tube touches planes at most, and light in it meets its wall there
    planes = depth == 0 or scene.tubes[tube].elevation != 0
    with np.errstate(divide="ignore", invalid="ignore"):
        if planes and layer > 0 and on != LOWER:
            down = (bottom - rays.position[:, 2]) / v_z
            found.append((np.where(v_z < 0, np.maximum(down, 0), np.inf), LOWER, -1))
        if planes and layer < len(scene.layers) - 1 and on != UPPER:
            top = bottom + scene.layers[layer][1] if layer else 0.0
            up = (top - rays.position[:, 2]) / v_z
            found.append((np.where(v_z > 0, np.maximum(up, 0), np.inf), UPPER, -1))
    if layer == scene.host:
        for number, one in enumerate(scene.tubes):
            if depth and number != tube:
                continue
            centre, around = scene.centre(number), depth if number == tube else 0
            stands = on if int(rays.on_tube[0]) == number else NOTHING
            if around < len(one.radii) and stands != INNER:
                enter, leave = crossings(centre, one.axis, one.radii[around], rays)
                ahead = np.isfinite(enter) & (leave > 0) & (enter + leave > 0)
                found.append((np.where(ahead, np.maximum(enter, 0), np.inf), INNER, number))
            if around:
                enter, leave = crossings(centre, one.axis, one.radii[around - 1], rays)
                if stands == OUTER:
                    way = rays.position - centre
                    v = rays.direction - np.outer(rays.direction @ one.axis, one.axis)
                    leave = -2 * np.sum(v * way, axis=1) / np.sum(v * v, axis=1)
                out = np.where(np.isfinite(leave) & (leave > 0), leave, np.inf)
                found.append((out, OUTER, number))
    nowhere = np.full(len(v_z), np.inf)
    every = np.array([nowhere, *(one for one, _, _ in found)])
    nearest = np.argmin(every, axis=0)
    what = np.array([NOTHING, *(kind for _, kind, _ in found)])[nearest]
    which = np.array([-1, *(number for _, _, number in found)])[nearest]
    return np.min(every, axis=0), what, which


def deep(scene: Scene, points: Array) -> tuple[Array, Array]:
    """Tube, and number of its walls, around points of the cylinders' layer."""
    tubes, depths = np.full(len(points), -1), np.zeros(len(points), int)
    for number, one in enumerate(scene.tubes):
        if not one.elevation:
            continue  # it touches its planes at most
        way = points - scene.centre(number)
        apart = np.linalg.norm(np.cross(way, one.axis), axis=1)
        walls = np.sum(apart[:, np.newaxis] < np.array(one.radii), axis=1)
        tubes, depths = np.where(walls > 0, number, tubes), np.maximum(depths, walls)
    return tubes, depths


def beyond(scene: Scene, rays: Rays, what: int, which: int) -> Rays:
    """Rays, as they are on the other side of what they stand on."""
    layer, tube, depth, on = rays.layer, rays.tube, rays.depth, rays.on
    if what in (LOWER, UPPER):
        layer = layer + (1 if what == UPPER else -1)
        on = np.full_like(on, LOWER if what == UPPER else UPPER)
        tube, depth = np.full_like(tube, -1), np.zeros_like(depth)
        if layer[0] == scene.host:
            tube, depth = deep(scene, rays.position)
        on_tube = np.full_like(rays.on_tube, -1)
    elif what == INNER:
        tube, depth, on = np.full_like(tube, which), depth + 1, np.full_like(on, OUTER)
        on_tube = tube
    else:
        depth, on = depth - 1, np.full_like(on, INNER)
        tube = np.where(depth == 0, -1, tube)
        on_tube = np.full_like(tube, which)
    return replace(rays, layer=layer, tube=tube, depth=depth, on=on, on_tube=on_tube)


def groups(rays: Rays, *labels: Array) -> Iterator[Array]:
    """Places of rays that have the same labels."""
    if len(rays.path):
        _, group = np.unique(np.stack(labels), axis=1, return_inverse=True)
        for number in range(group.max() + 1):
            yield np.flatnonzero(group.ravel() == number)


@dataclass(frozen=True)
class Tracer:
    """A scene at one wavenumber."""

    scene: Scene
    setup: Setup
    colour: Colour
    number: dict[str, int]

    def normal(self, rays: Rays, what: int, which: int) -> Array:
        if what in (LOWER, UPPER):
            return np.tile([0.0, 0.0, 1.0], (len(rays.path), 1))
        axis = self.scene.tubes[which].axis
        out = rays.position - self.scene.centre(which)
        out = out - np.outer(out @ axis, axis)
        unit: Array = out / np.linalg.norm(out, axis=1, keepdims=True)
        return unit

    def medium(self, rays: Rays) -> int:
        place = int(rays.layer[0]), int(rays.tube[0]), int(rays.depth[0])
        return self.number[self.scene.medium(*place)]

    def children(self, rays: Rays) -> list[Rays]:
        """Return what rays of one place become where they meet something."""
        distance, what, which = distances(self.scene, rays)
        n, mu = self.colour.n[self.medium(rays)], self.colour.mu[self.medium(rays)]
        met = np.isfinite(distance)
        rays, distance, what, which = rays[met], distance[met], what[met], which[met]
        rays = replace(
            rays,
            position=rays.position + distance[:, np.newaxis] * rays.direction,
            path=rays.path + n * distance,
            carried=times(rays.carried, np.exp(-mu * distance / 2)),
        )
        born = []
        for some in groups(rays, what, which):
            kind, tube = int(what[some[0]]), int(which[some[0]])
            stand = rays[some]
            if kind in (LOWER, UPPER):
                layer = int(stand.layer[0]) + (1 if kind == UPPER else 0)
                stand.position[:, 2] = self.scene.bottom(layer) if layer > 1 else 0.0
            other = beyond(self.scene, stand, kind, tube)
            for part in groups(other, other.tube, other.depth):
                born += self.split(stand[part], other[part], kind, tube)
        return born

    def split(self, rays: Rays, other: Rays, what: int, which: int) -> list[Rays]:
        one, two = self.medium(rays), self.medium(other)
        if one == two:
            return [other]
        rays, other = (one[one.met < self.setup.max_intersections] for one in (rays, other))
        setup, v = self.setup, rays.direction
        normal = self.normal(rays, what, which)
        normal = np.where(np.sum(v * normal, axis=1, keepdims=True) > 0, -normal, normal)
        n_i, n_t = (np.full(len(v), self.colour.n[medium]) for medium in (one, two))
        along = np.sum(v * normal, axis=1, keepdims=True)
        ratio = (n_i / n_t)[:, np.newaxis]
        cos_squared = 1 - ratio**2 * (1 - along**2)
        cos_t = np.sqrt(cos_squared + 0j)
        v_r = v - 2 * along * normal
        v_t = -cos_t.real * normal + ratio * (v - along * normal)
        divide = split_thesis if setup.polarisation is None else split_polarised
        reflected, transmitted = divide(
            rays.carried, (v, v_r, v_t), normal, (-along[:, 0], cos_t[:, 0]), (n_i, n_t)
        )
        on_tube = np.full_like(rays.on_tube, which)
        met = rays.met + 1
        back = replace(
            rays, direction=v_r, carried=reflected, on=np.full_like(rays.on, what),
            on_tube=on_tube, met=met,
        )  # fmt: skip
        through = replace(other, direction=v_t, carried=transmitted, met=met)
        return [back, through[cos_squared[:, 0] >= 0]]

    def fields(self, disk: Array) -> Iterator[Array]:
        """Yield what each generation brings to the detector."""
        start = launch(self.setup, self.colour, disk)
        none = np.zeros(len(start.path), int)
        rays = Rays(
            start.position, start.direction, start.carried, start.path, none, none - 1, none,
            none + NOTHING, none - 1, none,
        )  # fmt: skip
        while len(rays.path):
            born: list[Rays] = []
            for some in groups(rays, rays.layer, rays.tube, rays.depth, rays.on, rays.on_tube):
                born += self.children(rays[some])
            if not born:
                return
            rays = joined(born)
            home = (rays.layer == 0) & (rays.direction[:, 2] < 0)
            back = rays[home]
            arrived = back.position, back.direction, back.carried, back.path
            yield collect(self.setup, self.colour, Beam(*arrived, back.layer, back.met > 0))
            rays = rays[~home]


def intensity(scene: Scene, setup: Setup, wavenumbers: Array) -> Array:
    """Return I (K,) at wavenumbers (K,); media are of the set-up, and those of the scene."""
    names = ["glass", *dict.fromkeys(name for name in ("water", "neuron", *scene.media))]
    found = np.zeros(len(wavenumbers))
    for i, k in enumerate(np.asarray(wavenumbers, dtype=float)):
        wavelength = 2 * np.pi / k
        index = np.array([index_of(scene, setup, name, wavelength) for name in names])
        given = np.array([setup.attenuation.get(name, 0.0) for name in names])
        base = Colour.of(setup, float(k))
        colour = replace(base, n=index.real, mu=given + 4 * np.pi * index.imag / wavelength)
        assert names[GLASS] == "glass"
        tracer = Tracer(scene, setup, colour, {name: place for place, name in enumerate(names)})
        field_at_k = sum(tracer.fields(vogel_disk(setup.rays)), start=np.zeros(()))
        amplitude, length = setup.reference or (0.0, 0.0)
        arm = amplitude * np.exp(2j * k * length)
        if setup.polarisation is None:
            found[i] = abs(field_at_k + arm) ** 2
        else:
            found[i] = polarised_intensity(setup, field_at_k + arm * np.eye(2))
    return found


def index_of(scene: Scene, setup: Setup, medium: str, wavelength: float) -> complex:
    """Return n + i kappa of a medium."""
    if medium not in scene.media:
        return setup.index(medium, wavelength)
    index = scene.media[medium]
    return complex(index(wavelength) if callable(index) else index)
