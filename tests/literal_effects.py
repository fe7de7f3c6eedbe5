r"""A slow, literal tracer of the effects that the thesis left out, an oracle for the package.

Everything is done anew at each wavenumber: indices, the aperture's radius, the spiral, the focus,
Snell, Fresnel, the whole tree of rays, and what the fibre sees of it. Nothing is cut but what is
totally reflected or lost. Conventions: ``effects.md`` section 1 on top of ``design.md`` section 1;
`reference` is the same for the thesis alone. No code is shared with the package.

A ray in glass is held by the point where its line crosses the focal plane, as if all were glass,
and by its path there; so no 300 µm are added only to be taken off again.

Units: lengths in µm, wavenumbers in 1/µm, attenuation in 1/µm, angles in degrees.

Examples
--------
>>> k = np.linspace(7.0, 9.6, 3)
>>> thesis, polarised = Setup(rays=1), Setup(rays=1, polarisation=(None, None))
>>> bool(np.allclose(intensity(thesis, k), intensity(polarised, k), rtol=1e-12))  # on the axis
True
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from literal_effects_lens import falloff_of, pupil_of, ruling_length, zernike_sum
from literal_effects_setup import GLASS, NEURON, WATER, Colour, Setup
from literal_effects_split import enter_lens, leave_lens, split_polarised, split_thesis
from numpy.typing import NDArray

__all__ = ["Setup", "intensity"]

Array = NDArray[Any]
RIM = 1 + 1e-12


@dataclass(frozen=True)
class Rays:
    """Rays (R,) standing on a surface: the medium they are in, and what they carry.

    `carried` is an amplitude (R,), or under polarisation the fields (R, 3, 2) of light that came
    in as x and as y.
    """

    position: Array
    direction: Array
    carried: Array
    path: Array
    medium: Array
    on_cylinder: Array

    def __getitem__(self, which: Array) -> "Rays":
        return Rays(*(values[which] for values in vars(self).values()))

    def on(self, distance: Array, colour: Colour) -> tuple[Array, Array, Array]:
        """Return position, path and what is carried, a distance further in the same medium."""
        position = self.position + distance[:, np.newaxis] * self.direction
        path = self.path + colour.n[self.medium] * distance
        return position, path, times(self.carried, np.exp(-colour.mu[self.medium] * distance / 2))


def times(carried: Array, factor: Array) -> Array:
    """Multiply what rays carry by a factor (R,)."""
    product: Array = carried * factor.reshape((-1,) + (1,) * (carried.ndim - 1))
    return product


def vogel_disk(rays: int) -> Array:
    """Return eq. (3) on the unit disk, (N, 2)."""
    if rays == 1:
        return np.zeros((1, 2))
    j = np.arange(rays)
    theta = 2 * np.pi * j * ((np.sqrt(5) - 1) / 2)
    turn = np.stack([np.cos(theta), np.sin(theta)], axis=1)
    points: Array = np.sqrt(j / (rays - 1))[:, np.newaxis] * turn
    return points


def launch(setup: Setup, colour: Colour, disk: Array) -> Rays:
    """Rays from the objective to the plane z = 0, which all of them meet first."""
    points = colour.aperture * disk
    direction = np.column_stack([-points, np.full(len(points), setup.focus_distance)])
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    weight = np.full(len(points), 1 / len(points))
    if setup.waist is None:
        crossing = np.zeros((len(points), 2))
    else:
        z_r = ruling_length(setup, colour.k)
        tangents = direction[:, :2] / direction[:, 2:]
        along = z_r * np.column_stack([-tangents[:, 1], tangents[:, 0]])  # z_R tan(theta) phi-hat
        crossing = np.concatenate([along, -along])
        direction, weight = np.tile(direction, (2, 1)), np.tile(weight / 2, 2)
    pupil_point = -colour.n[GLASS] * direction[:, :2] / setup.numerical_aperture
    path, moved = aberration(setup, pupil_point)
    crossing = crossing + moved

    weight = weight * pupil_of(setup, colour.k, np.linalg.norm(pupil_point, axis=1))
    if setup.apodisation == "aplanatic":
        weight = weight * np.sqrt(direction[:, 2])
    past_focus = -colour.focus / direction[:, 2]  # from the focal plane to z = 0
    position = np.column_stack([crossing, np.zeros(len(crossing))])
    position[:, :2] += past_focus[:, np.newaxis] * direction[:, :2]
    in_glass = (setup.focus_distance - colour.focus) / direction[:, 2]
    weight = weight * np.exp(-colour.mu[GLASS] * in_glass / 2)
    return Rays(
        position,
        direction,
        weight if setup.polarisation is None else times(enter_lens(direction), weight),
        path + colour.n[GLASS] * past_focus,
        np.full(len(crossing), GLASS),
        np.zeros(len(crossing), dtype=bool),
    )


def aberration(setup: Setup, pupil_point: Array) -> tuple[Array, Array]:
    """Return the path (R,) that the lens adds, and by how much (R, 2) it moves the crossing."""
    wavefront, gradient = zernike_sum(setup.zernike, pupil_point)
    if setup.zernike_rays == "phase":
        return wavefront, np.zeros_like(gradient)
    path = wavefront - np.sum(pupil_point * gradient, axis=1)
    return path, gradient / setup.numerical_aperture


def split(setup: Setup, colour: Colour, rays: Rays) -> Rays:
    """Reflected and transmitted children of rays that stand on what they met."""
    centre = np.array([setup.x, 0.0, setup.gap + setup.diameter / 2])
    outward = rays.position - centre
    outward[:, 1] = 0.0
    normal = np.where(rays.on_cylinder[:, np.newaxis], outward, [0.0, 0.0, 1.0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    v = rays.direction
    normal = np.where(np.sum(v * normal, axis=1, keepdims=True) > 0, -normal, normal)
    beyond = np.where(
        rays.on_cylinder,
        np.where(rays.medium == WATER, NEURON, WATER),
        np.where(rays.medium == WATER, GLASS, WATER),
    )
    n_i, n_t = colour.n[rays.medium], colour.n[beyond]
    along = np.sum(v * normal, axis=1, keepdims=True)
    ratio = (n_i / n_t)[:, np.newaxis]
    cos_squared = 1 - ratio**2 * (1 - along**2)
    through = cos_squared[:, 0] >= 0
    cos_t = np.sqrt(cos_squared + 0j)  # +i sqrt(sin^2 - 1) beyond the critical angle
    v_r = v - 2 * along * normal
    v_t = -cos_t.real * normal + ratio * (v - along * normal)
    divide = split_thesis if setup.polarisation is None else split_polarised
    reflected, transmitted = divide(
        rays.carried, (v, v_r, v_t), normal, (-along[:, 0], cos_t[:, 0]), (n_i, n_t)
    )
    both = np.concatenate([np.ones(len(v), dtype=bool), through])
    return Rays(
        np.tile(rays.position, (2, 1)),
        np.concatenate([v_r, v_t]),
        np.concatenate([reflected, transmitted]),
        np.tile(rays.path, 2),
        np.concatenate([rays.medium, beyond]),
        np.tile(rays.on_cylinder, 2),
    )[both]


def meet(setup: Setup, colour: Colour, rays: Rays) -> Rays:
    """Carry rays in water and neuron to what they meet next; those that meet nothing are gone."""
    inside = rays.medium == NEURON
    v_x, _, v_z = rays.direction.T
    with np.errstate(divide="ignore", invalid="ignore"):
        to_plane = np.where(
            ~inside & (v_z < 0), np.maximum(0.0, -rays.position[:, 2] / v_z), np.inf
        )
        x = setup.x - rays.position[:, 0]
        z = setup.gap + setup.diameter / 2 - rays.position[:, 2]
        v_par = np.hypot(v_x, v_z)
        m = (x * v_x + z * v_z) / v_par
        h_squared = (setup.diameter / 2) ** 2 - (x**2 + z**2) + m**2
        from_outside = np.where(
            ~rays.on_cylinder & (m > 0) & (h_squared >= 0),
            np.maximum(0.0, m - np.sqrt(h_squared)) / v_par,
            np.inf,
        )
        # Inside, a ray stands on the circle: h = |m|.
        to_cylinder = np.where(inside, (m + np.abs(m)) / v_par, from_outside)
    on_cylinder = to_cylinder < to_plane
    distance = np.where(on_cylinder, to_cylinder, to_plane)
    met = np.isfinite(distance)
    rays, on_cylinder = rays[met], on_cylinder[met]
    position, path, carried = rays.on(distance[met], colour)
    position[~on_cylinder, 2] = 0.0
    return Rays(position, rays.direction, carried, path, rays.medium, on_cylinder)


def collect(setup: Setup, colour: Colour, rays: Rays) -> Array:
    """Return the field, a number or a Jones matrix (2, 2), of rays that leave z = 0 downward."""
    v = rays.direction
    to_objective = (colour.focus - setup.focus_distance) / v[:, 2]
    at_objective = rays.position[:, :2] + to_objective[:, np.newaxis] * v[:, :2]
    # the rim is the pupil's, to which an aberrated ray is that of no aberration
    _, moved = aberration(setup, colour.n[GLASS] * v[:, :2] / setup.numerical_aperture)
    within = np.hypot(*(at_objective - moved).T) <= colour.aperture * RIM
    rays, v, to_objective = rays[within], v[within], to_objective[within]

    to_focal_plane = colour.focus / v[:, 2]  # back, where the focus is above z = 0
    crossing = rays.position[:, :2] + to_focal_plane[:, np.newaxis] * v[:, :2]
    added, moved = aberration(setup, colour.n[GLASS] * v[:, :2] / setup.numerical_aperture)
    rho = np.hypot(*(crossing - moved).T)
    f = setup.focus_distance * setup.magnification / (setup.magnification + 1)
    correction = setup.magnification * rho**2 / (np.sqrt(f**2 + rho**2) + f)
    path = rays.path + colour.n[GLASS] * to_focal_plane + added + correction

    weight = falloff_of(setup, colour.k, rho) * np.exp(-colour.mu[GLASS] * to_objective / 2)
    if setup.apodisation == "aplanatic":
        weight = weight / np.sqrt(-v[:, 2])
    arrived = rays.carried if setup.polarisation is None else leave_lens(v, rays.carried)
    total: Array = np.sum(times(arrived, weight * np.exp(1j * colour.k * path)), axis=0)
    return total


def fields(setup: Setup, colour: Colour, disk: Array) -> Iterator[Array]:
    """Trace the tree, one meeting after the other; yield what each brings to the detector."""
    rays = launch(setup, colour, disk)
    for meetings in range(1, setup.max_intersections + 1):
        children = split(setup, colour, rays)
        yield collect(setup, colour, children[children.medium == GLASS])
        if meetings < setup.max_intersections:
            rays = meet(setup, colour, children[children.medium != GLASS])


def intensity(setup: Setup, wavenumbers: Array, disk: Array | None = None) -> Array:
    """Return I (K,) at wavenumbers (K,).

    Parameters
    ----------
    disk : ndarray, (N, 2)
        Points of the unit disk that take the place of the thesis's spiral, all of one weight.
    """
    disk = vogel_disk(setup.rays) if disk is None else disk
    intensities = np.zeros(len(wavenumbers))
    for i, k in enumerate(np.asarray(wavenumbers, dtype=float)):
        field_at_k = sum(fields(setup, Colour.of(setup, float(k)), disk), start=np.zeros(()))
        amplitude, length = setup.reference or (0.0, 0.0)
        arm = amplitude * np.exp(2j * k * length)
        if setup.polarisation is None:
            intensities[i] = abs(field_at_k + arm) ** 2
        else:
            intensities[i] = polarised_intensity(setup, field_at_k + arm * np.eye(2))
    return intensities


def polarised_intensity(setup: Setup, jones: Array) -> float:
    """Return what the analyser lets through of the field that a Jones matrix (2, 2) makes."""
    given, analyser = setup.polarisation or (None, None)
    inputs = np.eye(2) if given is None else np.array([given])
    out = jones @ inputs.T  # a column for each input
    if analyser is not None:
        out = np.array([[np.cos(np.radians(analyser)), np.sin(np.radians(analyser))]]) @ out
    return float(np.sum(np.abs(out) ** 2) / len(inputs))
