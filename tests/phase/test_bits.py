"""Where bits are promised, each spectrum's are its own, whatever stands beside it, and where.

Other processors sum, and fuse products, in other ways: `make test-processors` runs this on some.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from trials import trials

from octsim.config.processing import Processing
from octsim.optics.two_beams import ideal_spectra
from octsim.phase.estimators import ESTIMATORS, estimate
from octsim.phase.estimators.estimate import product
from octsim.phase.estimators.likelihood import Model, maximum_likelihood
from octsim.phase.slopes import phase_slopes, slope_of
from octsim.phase.transform import fourier_components
from octsim.schemes.light import AccuracyStatus, Light
from octsim.stages.gaussian_fits import fit_gaussian
from octsim.stages.ray_shares import ray_shares

Array = NDArray[np.float64]
Function = Callable[[Array, Array], tuple[NDArray[Any], ...]]
"""From spectra (D, K) and their diameters (D,) to values by diameter."""
N_NEURON = 1.38
CENTRES: list[dict[str, Any]] = [
    {"centre": "midpoint"},
    {"centre": "mean", "window": "boxcar"},
    {"centre": "weighted", "window": "hann"},
    *({"centre": "polynomial", "centre_degree": degree} for degree in (0, 1, 5)),
]
FITTED = {"estimator": "sinusoid", "depth": "peak"}
ESTIMATES: list[dict[str, Any]] = [
    *({"estimator": name} for name in ESTIMATORS),
    *({"estimator": name, "depth": "peak"} for name in ("zero_padded", "hilbert", "esprit")),
    *(FITTED | {"sinusoid": {"depth": "fitted", "weights": kind}} for kind in ("equal", "shot")),
    {"estimator": "sinusoid", "sinusoid": {"offset_degree": 3, "amplitude_degree": 2}},
    FITTED | {"sinusoid": {"depth": "fitted", "amplitude_degree": 3}},
]


def wavenumber(samples: int) -> Array:
    return np.linspace(7.2, 9.6, samples)


def _spectra(count: int, samples: int) -> tuple[Array, Array]:
    diameter = np.linspace(1.2, 1.5, count)
    random = np.random.default_rng(7)
    ideal = ideal_spectra(N_NEURON, diameter, wavenumber(samples))
    return 2 - ideal + 0.3 * random.random((count, samples)), diameter


def _transform(options: dict[str, Any]) -> Function:
    processing = Processing.model_validate(options)

    def parts(spectra: Array, _: Array) -> tuple[NDArray[Any], ...]:
        components = fourier_components(spectra, processing)
        return components, np.abs(components), np.angle(components)

    return parts


def _estimated(options: dict[str, Any]) -> Function:
    processing = Processing.model_validate(options)

    def estimated(spectra: Array, diameter: Array) -> tuple[NDArray[Any], ...]:
        k = wavenumber(spectra.shape[1])
        return tuple(estimate(spectra, k, N_NEURON * diameter, processing))

    return estimated


def _likeliest(spectra: Array, _: Array) -> tuple[NDArray[Any], ...]:
    modelled = np.linspace(1.1, 1.6, 40)
    model = Model(modelled, 2 - ideal_spectra(N_NEURON, modelled, wavenumber(spectra.shape[1])))
    return (maximum_likelihood(spectra, model, 0.1),)


def _ideal(spectra: Array, diameter: Array) -> tuple[NDArray[Any], ...]:
    return (ideal_spectra(N_NEURON, diameter, wavenumber(spectra.shape[1])),)


def _gaussians(spectra: Array, _: Array) -> tuple[NDArray[Any], ...]:
    focus = np.linspace(0.3, 0.9, spectra.shape[1])
    bumps = spectra[:, :1] * np.exp(-((focus - 0.6) ** 2) * 40) + 0.01 * spectra
    fits = [fit_gaussian(focus, bump) for bump in bumps]
    return tuple(np.array([part[place] for part in fits]) for place in (0, 1, 2))


FUNCTIONS: Mapping[str, Function] = {
    **{" ".join(map(str, one.values())): _transform(one) for one in CENTRES},
    **{str(one): _estimated(one) for one in ESTIMATES},
    "maximum_likelihood": _likeliest,
    "ideal_spectra": _ideal,
}


def shifted(values: Array, by: int) -> Array:
    """Give the same values so many bytes further from what a vector register would like."""
    memory = np.empty(values.nbytes + 128, np.uint8)
    begin = -memory.ctypes.data % 64 + by
    moved: Array = memory[begin : begin + values.nbytes].view(float).reshape(values.shape)
    moved[...] = values
    return moved


def strided(values: Array) -> Array:
    wide = np.empty((values.shape[0], 2 * values.shape[1]))
    wide[:, ::2] = values
    return wide[:, ::2]


def assert_same(found: tuple[NDArray[Any], ...], whole: tuple[NDArray[Any], ...]) -> None:
    for one, other in zip(found, whole, strict=True):
        np.testing.assert_array_equal(one, other, strict=True)


def check(function: Function, spectra: Array, diameter: Array) -> None:
    """Compare blocks of several sizes, in several places, with the whole."""
    whole = function(spectra, diameter)
    for size in (1, 2, 3, 5):
        parts = [
            function(spectra[begin : begin + size], diameter[begin : begin + size])
            for begin in range(0, diameter.size, size)
        ]
        assert_same(tuple(map(np.concatenate, zip(*parts, strict=True))), whole)
    for by in (8, 16, 40):
        assert_same(function(shifted(spectra, by), shifted(diameter, by)), whole)
    assert_same(function(strided(spectra), diameter), whole)
    assert_same(function(np.asfortranarray(spectra), diameter), whole)


@pytest.mark.parametrize("samples", [1000, 37, *trials(333)])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_spectrum_has_its_own_bits_beside_whichever_others(name: str, samples: int) -> None:
    check(FUNCTIONS[name], *_spectra(11, samples))


def test_a_gaussian_has_its_own_bits_beside_whichever_others() -> None:
    check(_gaussians, *_spectra(6, 21))


@pytest.mark.parametrize("components", [21, 501])
def test_a_phase_slope_has_its_own_bits_in_every_sweep_that_has_its_neighbours(
    components: int,
) -> None:
    random = np.random.default_rng(3)
    diameter = np.linspace(1.2, 1.5, 12)
    phase = random.uniform(-np.pi, np.pi, (12, components))
    magnitude = random.random((12, components))
    whole = phase_slopes(diameter, magnitude, phase)
    single = slope_of(diameter, phase[:, 0])
    for size in (1, 2, 3, 5):
        for begin in range(1, 12 - size):
            wide, inner = slice(begin - 1, begin + size + 1), slice(begin, begin + size)
            part = phase_slopes(diameter[wide], magnitude[wide], phase[wide])
            for one, other in zip(part, whole, strict=True):
                np.testing.assert_array_equal(one[1:-1], other[inner])
            np.testing.assert_array_equal(
                slope_of(diameter[wide], phase[wide, 0])[1:-1], single[inner]
            )


def test_a_path_has_its_own_bits_beside_whichever_others_the_other_spectra_have() -> None:
    random = np.random.default_rng(5)
    path = np.repeat([4, 9, 17, 30, 31], [3, 1, 7, 2, 40])
    light = Light(
        path, random.normal(size=53), np.zeros(53), 15 + random.random(53), 0.0, 0,
        AccuracyStatus.REACHED,
    )  # fmt: skip

    def found(codes: list[int]) -> dict[str, NDArray[Any]]:
        """Share the light among paths that are listed in some order, as the strongest first."""
        listed = np.array(codes)
        given = ray_shares(light, listed, 7.2, 0.024)
        return {
            name: values[[codes.index(code) for code in (4, 9, 17, 30, 31)]]
            for name, values in given.items()
        }

    whole = found([4, 9, 17, 30, 31])
    for codes in ([31, 4, 30, 9, 17], [8, 31, 2, 4, 17, 50, 30, 9], [*range(60, 3, -1)]):
        for name, values in found(codes).items():
            np.testing.assert_array_equal(values, whole[name], err_msg=name)


@pytest.mark.parametrize("shape", [(1, 7), (3, 5), (4, 101)])
def test_a_complex_product_is_that_of_its_parts_wherever_it_stands(shape: tuple[int, int]) -> None:
    random = np.random.default_rng(1)
    one, other = (random.normal(size=shape) + 1j * random.normal(size=shape) for _ in range(2))
    whole = product(one, other)
    for row in range(shape[0]):
        for column in range(shape[1]):
            a, b = complex(one[row, column]), complex(other[row, column])
            assert whole[row, column] == complex(
                a.real * b.real - a.imag * b.imag, a.real * b.imag + a.imag * b.real
            )
