"""Zernike terms, pupils, rulings and the fibre's sight (for literal_effects)."""

from collections.abc import Mapping
from math import factorial
from typing import Any

import numpy as np
from literal_effects_setup import Setup
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import j0, j1, jn_zeros, k0e, k1e

Array = NDArray[Any]


def noll(j: int) -> tuple[int, int]:
    """Return n and m of a Noll index from 1; m < 0 is a sine (of odd j)."""
    n, first = 0, 1
    while first + n + 1 <= j:
        first += n + 1
        n += 1
    left = j - first  # among the n + 1 terms of order n
    m = 2 * ((left + 1) // 2) if n % 2 == 0 else 2 * (left // 2) + 1
    return n, (m if j % 2 == 0 else -m)


def zernike(j: int, p: Array) -> tuple[Array, Array]:
    """Return a Noll polynomial of rms 1 at points (R, 2), and its gradient (R, 2).

    It is N Q(rho^2) times the real or imaginary part of (x + iy)^m.
    """
    n, signed = noll(j)
    m = abs(signed)
    half = (n - m) // 2
    q = np.polynomial.Polynomial(
        [
            (-1) ** s
            * factorial(n - s)
            / (factorial(s) * factorial((n + m) // 2 - s) * factorial(half - s))
            for s in range(half, -1, -1)  # the power of rho^2 is half - s
        ]
    )
    x, y = p.T
    square = x**2 + y**2
    w = x + 1j * y
    power = w**m
    slope = m * w ** (m - 1) if m else np.zeros_like(w)  # d/dx; d/dy is i times that
    size = np.sqrt(n + 1) if m == 0 else np.sqrt(2 * (n + 1))

    def part(values: Array) -> Array:
        return values.imag if signed < 0 else values.real

    value = size * q(square) * part(power)
    rate = 2 * q.deriv()(square) * part(power)
    gradient = size * np.stack(
        [rate * x + q(square) * part(slope), rate * y + q(square) * part(1j * slope)], axis=1
    )
    return value, gradient


def zernike_sum(coefficients: Mapping[int, float], p: Array) -> tuple[Array, Array]:
    """Return W (R,) at pupil points (R, 2), and its gradient (R, 2)."""
    wavefront, gradient = np.zeros(len(p)), np.zeros_like(p)
    for j, rms in coefficients.items():
        value, slope = zernike(j, p)
        wavefront, gradient = wavefront + rms * value, gradient + rms * slope
    return wavefront, gradient


def pupil_of(setup: Setup, k: float, rho: Array) -> Array:
    """Return the amplitude at launch, of rho = n sin(theta) / NA."""
    if setup.pupil is None:
        return np.ones_like(rho)
    kind, size = setup.pupil
    if kind == "gaussian":
        exponent = rho / size
    else:
        exponent = k * (size / 2) * rho * setup.numerical_aperture / (2 * setup.magnification)
    weight: Array = np.exp(-(exponent**2))
    return weight


def ruling_length(setup: Setup, k: float) -> float:
    """Return z_R = pi n w0^2 / lambda, all at each wavelength or all at the one that is given."""
    each = setup.waist_wavelength == "each"
    wavelength = 2 * np.pi / k if each else float(setup.waist_wavelength)
    diffraction = wavelength / (np.pi * setup.numerical_aperture)
    w0 = diffraction if setup.waist == "diffraction" else float(setup.waist or 0.0)
    return float(np.pi * setup.index("glass", wavelength).real * w0**2 / wavelength)


def falloff_of(setup: Setup, k: float, rho: Array) -> Array:
    """Return the detected share of an amplitude at radius rho in the focal plane."""
    radius = setup.core_diameter / (2 * setup.magnification)
    u = rho / radius
    if isinstance(setup.falloff, tuple):
        kind, size = setup.falloff
        if kind == "fibre":
            return lp01(k, setup.core_diameter / 2, size or 0.0, rho * setup.magnification)
        w = radius if size is None else size / (2 * setup.magnification)
        uncut: Array = np.exp(-((rho / w) ** 2))
        return uncut
    shape = {"parabolic": 1 - u**2, "top_hat": np.ones_like(u), "cosine": np.cos(np.pi * u / 2)}
    return np.where(rho < radius, shape[setup.falloff], 0.0)


def lp01(k: float, core: float, aperture: float, r: Array) -> Array:
    """Return the mode of a weakly guiding step fibre at radii r, 1 on the axis.

    U J1(U) / J0(U) = W K1(W) / K0(W) with U^2 + W^2 = V^2 = (k core NA)^2.
    """
    v = k * core * aperture

    def mismatch(u: float) -> float:
        w = np.sqrt(v**2 - u**2)
        return float(u * j1(u) * k0e(w) - w * k1e(w) * j0(u))

    u = brentq(mismatch, 1e-9, min(v * (1 - 1e-15), jn_zeros(0, 1)[0]), xtol=1e-15, rtol=1e-15)
    w = np.sqrt(v**2 - u**2)
    s = r / core
    out = np.maximum(s, 1.0)
    cladding = j0(u) * k0e(w * out) / k0e(w) * np.exp(-w * (out - 1))
    mode: Array = np.where(s < 1, j0(u * s), cladding)
    return mode
