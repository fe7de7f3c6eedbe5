r"""The field of a cylinder on a plane by dense rules: nothing of scheme fullwave's is used.

Other rules (Clenshaw–Curtis over both directions of the pupil, the trapezoid over a contour of its
own), Fresnel's coefficients of s and p light in place of conical ones, Wait's matrix of scipy's
Bessel functions, all partial waves of both signs, and one linear system for each k and s_y. What
they come to is compared with denser rules, and the difference is the field's own error.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import h1vp, hankel1, jv, jvp

from octsim.optics.pupil import Pupil

Array = NDArray[Any]
_RIGHT = 0.8 * np.pi / 2
"""How far the contour turns: from a right angle on there are branch points."""


class Slide(NamedTuple):
    """A cylinder over a plane; lengths in µm."""

    n_glass: float
    n_water: float
    n_neuron: float
    gap: float
    diameter: float
    offset: float = 0.0


class Beam(NamedTuple):
    """What lights it, and is detected."""

    pupil: Pupil
    aperture: float
    focus: float


class Rules(NamedTuple):
    """How dense."""

    waves: int
    """Partial waves beyond those that the cylinder's size asks for."""
    across: int
    along: int
    contour: int
    radial: int

    def denser(self) -> "Rules":
        """Return denser rules, most of all along the cylinder, where there are resonances."""
        denser = Rules(self.waves + 4, *(math.ceil(1.25 * number) for number in self[1:]))
        return denser._replace(along=math.ceil(1.5 * self.along))


class Dense(NamedTuple):
    """A field, of light polarised across the cylinder and along it, and its error."""

    field: Array
    """(2, K)."""
    error: float
    """The largest difference from that of less dense rules."""


def dense_waves(slide: Slide, beam: Beam, k: NDArray[np.float64], wanted: float = 1e-9) -> Dense:
    """Return the detected field at wavenumbers (K,), 1/µm, by ever denser rules."""
    rules = _first(slide, beam, float(k.max()))
    field = field_by(slide, beam, k, rules)
    for _ in range(4):
        rules = rules.denser()
        coarse, field = field, field_by(slide, beam, k, rules)
        error = float(np.abs(field - coarse).max())
        if error <= wanted:
            break
    return Dense(field, error)


def field_by(slide: Slide, beam: Beam, k: NDArray[np.float64], rules: Rules) -> Array:
    """Return the field (2, K) by given rules."""
    sine, measure = _clenshaw_curtis(rules.radial)
    # over ρ², which is smooth
    rho = beam.aperture * np.sqrt((sine + 1) / 2)
    measure = measure * beam.aperture**2 / 4
    found = np.empty((2, k.size), np.complex128)
    for i, one in enumerate(k.tolist()):
        weight = beam.pupil.amplitude(rho, beam.aperture, one) ** 2 * measure
        below, above = (_normal(n, rho) for n in (slide.n_glass, slide.n_water))
        r_s, r_p = _fresnel(slide.n_glass, slide.n_water, below, above)
        phase = np.exp(-2j * one * beam.focus * below)
        plane = (weight * (r_s - r_p) / 2 * phase).sum() / weight.sum()
        whole = 4 * np.pi * slide.n_glass * weight.sum()
        found[:, i] = plane + _of_cylinder(slide, beam, one, rules) / whole
    return found


def scattering_matrices(slide: Slide, k: float, along: float, waves: int) -> Array:
    """Return Wait's matrices of orders −M … M, (2M + 1, 2, 2)."""
    order, a = np.arange(-waves, waves + 1), slide.diameter / 2
    # beyond the cylinder's own index light decays in it
    k2, k3 = np.sqrt(slide.n_water**2 - along**2), np.emath.sqrt(slide.n_neuron**2 - along**2)
    alpha = 1j * along * order / (k * a) * (1 / k2**2 - 1 / k3**2)
    j3, slope3 = jv(order, k * a * k3), jvp(order, k * a * k3)

    def boundary(wave: Array, slope: Array) -> Array:
        skew = alpha * wave * j3
        of_h = slope * j3 / k2 - slope3 * wave / k3
        of_e = slide.n_water**2 * slope * j3 / k2 - slide.n_neuron**2 * slope3 * wave / k3
        return np.stack([np.stack([skew, of_h], -1), np.stack([-of_e, skew], -1)], -2)

    outer = boundary(hankel1(order, k * a * k2), h1vp(order, k * a * k2))
    regular = boundary(jv(order, k * a * k2), jvp(order, k * a * k2))
    return -np.linalg.solve(outer, regular)


def waves_of_light(
    slide: Slide, beam: Beam, k: float, along: float, waves: int, across: int
) -> Array:
    """Return regular waves (2 polarisations, 2 components, 2M + 1) that the pupil sends."""
    u, weight = _clenshaw_curtis(across)
    reach = np.sqrt(beam.aperture**2 - along**2)
    sx, sy = reach * u, along
    rho = np.hypot(sx, sy)
    below, above = (_normal(n, rho) for n in (slide.n_glass, slide.n_water))
    cosine, cosine_2 = below / slide.n_glass, above / slide.n_water
    azimuth = np.arctan2(sy, sx)
    c, s = np.cos(azimuth), np.sin(azimuth)
    e1, e2 = slide.n_glass**2, slide.n_water**2
    t_s = 2 * below / (below + above)
    t_p = 2 * slide.n_glass * slide.n_water * below / (e2 * below + e1 * above)
    height = slide.gap + slide.diameter / 2
    size = beam.pupil.amplitude(rho, beam.aperture, k) / np.sqrt(cosine)
    phase = np.exp(1j * k * (above * height - below * beam.focus + sx * slide.offset))
    amplitude = size * phase * weight * reach
    order = np.arange(-waves, waves + 1)
    turn = np.exp(1j * order * np.arcsin(sx / np.sqrt(e2 - sy**2))[:, np.newaxis])
    found = []
    for radial, azimuthal in ((c, -s), (s, c)):
        e = t_s * azimuthal * c + t_p * radial * cosine_2 * s
        h = slide.n_water * (t_p * radial * c - t_s * azimuthal * cosine_2 * s)
        found.append(np.stack([amplitude * e, amplitude * h]) @ turn)
    return np.stack(found)


def coupling_matrices(slide: Slide, k: float, along: float, waves: int, nodes: int) -> Array:
    """Return R, (2, 2M + 1, 2, 2M + 1), from outgoing waves to those that the plane returns."""
    n, sy, height = slide.n_water, along, slide.gap + slide.diameter / 2
    kappa = math.sqrt(n**2 - sy**2)
    end = _contour_end(waves, k * height * kappa)
    # an even number: ρ can be 0 midway
    tau, step = np.linspace(-end, end, 2 * nodes, retstep=True)
    beta = _RIGHT * np.tanh(tau) - 1j * tau
    weight = step * (_RIGHT / np.cosh(tau) ** 2 - 1j)
    sx, here = kappa * np.sin(beta), kappa * np.cos(beta)
    beyond = np.sqrt(slide.n_glass**2 - sx**2 - sy**2)
    r_s, r_p = _fresnel(n, slide.n_glass, here, beyond)
    rho = np.sqrt(sx**2 + sy**2)
    c, turn = sx / rho, here / n * sy / rho
    # downwards (E_y, H_y / n) = [[c, −Cσ], [Cσ, c]] (s, p); upwards [[c, Cσ], [−Cσ, c]]
    size = c**2 + turn**2
    parts = (
        ((r_s * c**2 - r_p * turn**2) / size, (r_s + r_p) * c * turn / size / n),
        (-n * (r_s + r_p) * c * turn / size, (r_p * c**2 - r_s * turn**2) / size),
    )
    order = np.arange(-waves, waves + 1)
    powers = np.arange(-2 * waves, 2 * waves + 1)[:, np.newaxis]
    # what travels and the powers are one exponential: each by itself can overflow
    travel = np.exp(1j * (powers * beta + 2 * k * height * here)) * weight / np.pi
    place = order[:, np.newaxis] + order + 2 * waves
    signs = np.where(order % 2, -1.0, 1.0)
    found = np.empty((2, order.size, 2, order.size), np.complex128)
    for i, row in enumerate(parts):
        for j, r in enumerate(row):
            found[i, :, j, :] = (travel @ r)[place] * signs
    return found


def outgoing(regular: Array, t: Array, r: Array) -> Array:
    """Return b = (1 − T R)⁻¹ T a, (2 polarisations, 2, 2M + 1)."""
    size = len(t)
    # waves of high orders scatter next to nothing, and come from b of next to nothing
    scale = np.sqrt(np.abs(t).max(axis=(1, 2)))
    # T R, each order of T by itself
    near = np.stack(
        [sum(t[:, i, j, np.newaxis, np.newaxis] * r[j] for j in (0, 1)) for i in (0, 1)]
    )
    near *= scale / scale[:, np.newaxis, np.newaxis]
    matrix = np.eye(2 * size) - near.reshape(2 * size, 2 * size)
    right = np.einsum("mtu,pum->tmp", t, regular) / scale[:, np.newaxis]
    b = np.linalg.solve(matrix, right.reshape(2 * size, -1)).reshape(2, size, -1)
    return np.moveaxis(b * scale[:, np.newaxis], -1, 0)


def _of_cylinder(slide: Slide, beam: Beam, k: float, rules: Rules) -> Array:
    x, weight = _clenshaw_curtis(2 * rules.along)
    # s_y and −s_y are each other's mirror image; nothing comes through the rim itself
    half = np.arange(rules.along, 2 * rules.along)
    angle = np.pi / 2 * x[half]
    angle[0] = 0
    weight = weight[half] * beam.aperture * np.pi / 2 * np.cos(angle)
    weight[1:] *= 2
    total = np.zeros(2, np.complex128)
    for one, share in zip((beam.aperture * np.sin(angle)).tolist(), weight.tolist(), strict=True):
        water = slide.n_water**2 - one**2
        inside = max(slide.n_neuron**2 - one**2, water)
        size = k * slide.diameter / 2 * math.sqrt(inside)
        waves = math.ceil(size + 4.5 * size ** (1 / 3)) + rules.waves
        t = scattering_matrices(slide, k, one, waves)
        r = coupling_matrices(slide, k, one, waves, rules.contour)
        a = waves_of_light(slide, beam, k, one, waves, rules.across)
        detected = waves_of_light(slide, beam, k, -one, waves, rules.across)[..., ::-1]
        b = outgoing(a, t, r)
        signs = np.where(np.arange(-waves, waves + 1) % 2, -1.0, 1.0)
        overlap = slide.n_water**2 * detected[:, 0] * b[:, 0] - detected[:, 1] * b[:, 1]
        total += (overlap * signs).sum(-1) * share * 2 / (np.pi * water)
    return total


def _first(slide: Slide, beam: Beam, k: float) -> Rules:
    size = k * slide.diameter / 2 * max(slide.n_neuron, slide.n_water)
    height, sine = slide.gap + slide.diameter / 2, beam.aperture
    glass, water = (n - math.sqrt(n**2 - sine**2) for n in (slide.n_glass, slide.n_water))
    spread = k * (abs(height * water) + abs(beam.focus * glass) + abs(slide.offset * sine))
    return Rules(
        8, math.ceil(40 + size + spread), math.ceil(28 + 0.8 * size + spread),
        math.ceil(80 + 2.5 * size), math.ceil(60 + 2 * spread),
    )  # fmt: skip


def _contour_end(waves: int, least: float) -> float:
    tau = np.linspace(0.1, 60, 6000)
    size = 2 * waves * tau - 2 * least * np.sin(_RIGHT * np.tanh(tau)) * np.sinh(tau)
    return float(tau[np.flatnonzero(size > -45)[-1] + 1])


def _fresnel(n: float, n_beyond: float, here: Array, beyond: Array) -> tuple[Array, Array]:
    """Return r_s of E and r_p of H."""
    r_s = (here - beyond) / (here + beyond)
    r_p = (here / n**2 - beyond / n_beyond**2) / (here / n**2 + beyond / n_beyond**2)
    return r_s, r_p


def _normal(n: float, rho: NDArray[np.float64]) -> NDArray[np.float64]:
    found: NDArray[np.float64] = np.sqrt(n**2 - rho**2)
    return found


def _clenshaw_curtis(number: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return nodes and weights in −1 … 1, both ends among them, of an even number of spans."""
    n = number + number % 2
    angle = np.pi * np.arange(n + 1) / n
    weight = np.ones(n + 1)
    for j in range(1, n // 2 + 1):
        weight -= (1 if 2 * j == n else 2) * np.cos(2 * j * angle) / (4 * j**2 - 1)
    weight *= 2 / n
    weight[[0, -1]] /= 2
    return -np.cos(angle), weight
