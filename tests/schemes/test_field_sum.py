"""The spectrum: two beams, exact sums, and long ones."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from octsim.config.load import load_config
from octsim.schemes.field_sum import field_at, fields_in_groups, intensity


def test_wavenumbers_are_even_and_hold_both_ends() -> None:
    k = load_config().spectrum.wavenumbers()
    assert k.size == 1000
    assert (k[0], k[-1]) == (2 * np.pi / 0.9, 2 * np.pi / 0.65)
    assert np.allclose(np.diff(k), (k[-1] - k[0]) / 999, rtol=1e-11)


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(-20, 20))
def test_two_beams_interfere_as_in_equation_1(
    first: float, second: float, difference: float
) -> None:
    k = np.linspace(6.98, 9.67, 500)
    paths = np.array([0.3, 0.3 + difference])
    expected = first**2 + second**2 + 2 * first * second * np.cos(k * difference)
    assert np.allclose(intensity(np.array([first, second]), paths, k), expected, atol=1e-12)


@pytest.mark.parametrize("num", [2, 3, 1000, 100_000])
def test_the_sum_is_exact_to_rounding(num: int) -> None:
    rng = np.random.default_rng(7)
    amplitude, path = rng.normal(size=400), rng.uniform(-30, 30, 400)
    k = np.linspace(6.98, 9.67, num)
    summed = intensity(amplitude, path, k)
    for i in np.unique(np.linspace(0, num - 1, 40).astype(int)):
        real = math.fsum(a * math.cos(k[i] * p) for a, p in zip(amplitude, path, strict=True))
        imaginary = math.fsum(a * math.sin(k[i] * p) for a, p in zip(amplitude, path, strict=True))
        assert summed[i] == pytest.approx(real**2 + imaginary**2, abs=1e-11 * summed.max())


def test_no_light_is_a_dark_spectrum() -> None:
    assert np.array_equal(intensity(np.empty(0), np.empty(0), np.linspace(7, 9, 10)), np.zeros(10))


def test_rays_are_summed_in_groups() -> None:
    rng = np.random.default_rng(3)
    group, amplitude, path = rng.integers(0, 3, 50), rng.normal(size=50), rng.uniform(-9, 9, 50)
    first, step = 7.0, 0.02
    real, imaginary = fields_in_groups(group, amplitude, path, 4, first, step, 100)
    fields = real + 1j * imaginary
    assert fields.shape == (4, 100)
    for number in range(4):
        one = amplitude[group == number], path[group == number]
        expected = [field_at(*one, first + step * i) for i in range(100)]
        assert np.allclose(fields[number], expected, atol=1e-12)
    assert (fields[3] == 0).all()
