"""Maxwell's equations in two dimensions: a line beam on a cylinder over a plane, at k_y = 0.

A slow and literal reference, which shares no line with the package: plane waves in the glass,
partial waves about the cylinder's axis, a linear system for what goes to and fro between the two,
and what leaves downwards, found from its own plane waves instead of by reciprocity.

Lengths are in µm,
wavenumbers in 1/µm, z = 0 is the plane, time goes as exp(−iωt). F is E_y of light polarised along
the cylinder ("along", TE) or Z₀H_y of light polarised across it ("across", TM).
"""

import itertools
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import h1vp, hankel1, jv, jvp

Complex = NDArray[np.complex128]
Floats = NDArray[np.float64]
Polarisation = Literal["along", "across"]


class Slide(NamedTuple):
    """A cylinder over a plane: refractive indices, and lengths in µm."""

    glass: float = 1.52
    water: float = 1.33
    neuron: float = 1.39
    gap: float = 0.005
    diameter: float = 1.2

    @property
    def height(self) -> float:
        """Of the cylinder's axis over the plane, µm."""
        return self.gap + self.diameter / 2


class LineBeam(NamedTuple):
    """A beam as plane waves: F = Σ weight · amplitude · exp(i(k_x x + k_z z)) at z = 0."""

    kx: Floats
    """Their k_x, (S,), symmetric about 0."""
    weight: Floats
    """Of a quadrature over k_x, (S,)."""
    amplitude: Complex
    """Of F in the plane z = 0, (S,)."""


def root(squared: Complex) -> Complex:
    """Return a square root whose wave decays, or goes, along +z."""
    found = np.sqrt(squared.astype(complex))
    return np.where(found.imag < 0, -found, found)


def normal(index: float, k: float, kx: Complex | Floats) -> Complex:
    """Return k_z in a medium."""
    return root(np.asarray((index * k) ** 2 - kx**2))


def reflection(
    n_from: float, n_to: float, k: float, kx: Complex | Floats, light: Polarisation
) -> Complex:
    """Return Fresnel's r of F; t = 1 + r."""
    here, there = normal(n_from, k, kx), normal(n_to, k, kx)
    if light == "across":
        here, there = here / n_from**2, there / n_to**2
    return (here - there) / (here + there)


def gaussian_beam(
    slide: Slide, k: float, focus: float, fill: float, aperture: float = 1.2, nodes: int = 200
) -> LineBeam:
    """Return the aplanatic beam of a Gaussian pupil, focused at a height as if all were glass."""
    point, weight = np.polynomial.legendre.leggauss(nodes)
    sine = aperture * point
    cosine = np.sqrt(1 - (sine / slide.glass) ** 2)
    pupil = np.exp(-((sine / (fill * aperture)) ** 2)) / np.sqrt(cosine)
    phase = np.exp(-1j * normal(slide.glass, k, k * sine) * focus)
    return LineBeam(k * sine, k * aperture * weight, pupil * phase)


def cylinder(slide: Slide, k: float, order: NDArray[np.int64], light: Polarisation) -> Complex:
    """Return the factors from the partial waves J_m that come to the outgoing H_m, (orders,)."""
    outside, inside = slide.water, slide.neuron
    x2, x3 = k * outside * slide.diameter / 2, k * inside * slide.diameter / 2
    n2, n3 = (outside, inside) if light == "along" else (1 / outside, 1 / inside)
    regular = n2 * jvp(order, x2) * jv(order, x3) - n3 * jvp(order, x3) * jv(order, x2)
    outgoing = n2 * h1vp(order, x2) * jv(order, x3) - n3 * jvp(order, x3) * hankel1(order, x2)
    return -regular / outgoing


def echo(slide: Slide, k: float, order: NDArray[np.int64], light: Polarisation) -> Complex:
    r"""Return :math:`C_p = (1/\pi) \int d\beta\, r(\beta) e^{2i\kappa h \cos\beta + ip\beta}`.

    β goes from π/2 + i∞ over −π/2 … π/2 to π/2 − i∞; r is even in it. Nodes crowd at the ends of
    the pieces: r has a root at the critical angle.
    """
    size = slide.water * k
    critical = np.arccosh(max(slide.glass / slide.water, 1))
    end = np.arcsinh((40 + 3 * order.max()) / (2 * size * slide.height)) + critical + 1
    point, weight = np.polynomial.legendre.leggauss(300)
    turn = (point + 1) * np.pi / 4
    place, measure = np.sin(turn) ** 2, weight * np.pi / 4 * np.sin(2 * turn)
    total = np.zeros(order.size, complex)
    corners = (0, np.pi / 2, np.pi / 2 - 1j * critical, np.pi / 2 - 1j * end)
    for start, stop in itertools.pairwise(corners):
        step = stop - start
        beta = start + step * place
        r = reflection(slide.water, slide.glass, k, size * np.sin(beta), light)
        there = 2 * size * slide.height * np.cos(beta)
        waves = np.exp(1j * (there + order[:, None] * beta))
        waves += np.exp(1j * (there - order[:, None] * beta))
        total += (waves * r * measure).sum(axis=1) * step
    return total / np.pi


def returned(
    slide: Slide, k: float, beam: LineBeam, light: Polarisation, orders: int | None = None
) -> Complex:
    """Return the amplitude of F going down at z = 0, for each k_x of a beam, (S,).

    It is a density over k_x, as the beam's amplitude is.
    """
    size, height = slide.water * k, slide.height
    if orders is None:
        x = k * slide.neuron * slide.diameter / 2
        orders = int(x + 6 * x ** (1 / 3) + 6)
    m = np.arange(-orders, orders + 1)
    kz = normal(slide.water, k, beam.kx)
    turn = np.log((kz + 1j * beam.kx) / size) * m[:, None]  # i m beta, with sin beta = kx / size
    into = 1 + reflection(slide.glass, slide.water, k, beam.kx, light)
    out = 1 + reflection(slide.water, slide.glass, k, beam.kx, light)
    at_axis = beam.weight * beam.amplitude * into * np.exp(1j * kz * height)
    incident = (at_axis * np.exp(turn)).sum(axis=1)
    sums = np.arange(-2 * orders, 2 * orders + 1)
    coupling = (-1.0) ** m * echo(slide, k, sums, light)[m[:, None] + m + 2 * orders]
    scatter = cylinder(slide, k, m, light)
    outgoing = np.linalg.solve(np.eye(m.size) - scatter[:, None] * coupling, scatter * incident)
    down = (((-1.0) ** m * outgoing)[:, None] * np.exp(turn)).sum(axis=0) / (np.pi * kz)
    plane = reflection(slide.glass, slide.water, k, beam.kx, light) * beam.amplitude
    return np.asarray(plane + out * np.exp(1j * kz * height) * down)


def detected(slide: Slide, k: float, beam: LineBeam, light: Polarisation) -> complex:
    """Return the overlap of what returns with the beam's own mode; a mirror in the focus has 1."""
    back = returned(slide, k, beam, light)
    flux = normal(slide.glass, k, beam.kx).real * beam.weight
    overlap = (flux * beam.amplitude[::-1] * back).sum() / (flux * abs(beam.amplitude) ** 2).sum()
    return complex(overlap if light == "along" else -overlap)
