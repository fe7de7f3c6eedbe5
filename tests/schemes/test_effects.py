"""Every effect and every pair of them: rays against a literal tracer, all to their accuracy."""

from itertools import combinations
from typing import Any

import numpy as np
import pytest
from effect_cases import MORE, SLOTS, Case, glass, neuron, water
from literal_effects import Setup, intensity

from octsim.config.abilities import asked_of_scheme
from octsim.config.derive import merge
from octsim.config.load import load_config
from octsim.config.scheme import sampled, way_varies
from octsim.instrument.build import optics_of
from octsim.instrument.instrument import Instrument
from octsim.optics.zernike import Aberration
from octsim.schemes.light import AccuracyStatus
from octsim.schemes.table import SCHEMES

pytestmark = pytest.mark.filterwarnings("ignore::octsim.base.errors.OctsimWarning")
DIAMETER, FOCUS = 1.4, 0.877
PAIRS = [*combinations(SLOTS, 2)]


def pair(first: str, second: str) -> Case:
    one, other = SLOTS[first], SLOTS[second]
    return Case(merge(one.overlay, other.overlay), {**one.literal, **other.literal})


EVERY = {
    **MORE,
    **SLOTS,
    **{f"{first}, {second}": pair(first, second) for first, second in PAIRS},
}


def instrument(
    scheme: str, overlay: dict[str, Any], samples: int = 12, **tracing: Any
) -> Instrument:
    settings = {"tracing": {"scheme": scheme, **tracing}, "spectrum": {"samples": samples}}
    return Instrument(load_config(settings, overlay))


def able(scheme: str, overlay: dict[str, Any]) -> bool:
    """Return whether a scheme can do what an overlay asks for."""
    config = load_config({}, overlay)
    return {one.ability for one in asked_of_scheme(config)} <= SCHEMES[scheme].honours


@pytest.mark.parametrize("name", EVERY)
def test_counted_rays_are_those_of_a_literal_tracer(name: str) -> None:
    case = EVERY[name]
    # each wavenumber is traced for itself, so that a few are as sharp as many
    found = instrument("vogel", case.overlay, samples=4, rays=300)
    expected = intensity(
        Setup(rays=300, diameter=DIAMETER, focus=FOCUS, **case.literal), found.wavenumber
    )
    # amplitudes that cancel to nothing are as exact as those that don't
    size = max(expected.max(), 1e-8)
    off = np.abs(found.spectrum(DIAMETER, FOCUS).intensity - expected).max()
    assert off <= 1e-8 * size


# each falloff is compiled for itself
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.trial if name == "top hat" else [])
        for name, case in EVERY.items()
        if able("paths", case.overlay)
    ],
)
def test_light_paths_are_within_the_accuracy(name: str) -> None:
    overlay = EVERY[name].overlay
    exact = instrument("paths", overlay, accuracy=1e-7).spectrum(DIAMETER, FOCUS).intensity
    found = instrument("paths", overlay, accuracy=1e-4).spectrum(DIAMETER, FOCUS)
    off = np.abs(found.intensity - exact).max() / exact.max()
    assert off <= found.error
    assert (found.error <= 1e-4) == (found.status == AccuracyStatus.REACHED) == (name != "crossed")


@pytest.mark.parametrize("name", ["falloff", "aberration, polarisation", "pupil, dispersion"])
def test_light_paths_are_what_many_rays_come_to(name: str) -> None:
    overlay = EVERY[name].overlay
    exact = instrument("paths", overlay, accuracy=1e-6).spectrum(DIAMETER, FOCUS).intensity
    rays = instrument("vogel", overlay, rays=30_000).spectrum(DIAMETER, FOCUS)
    assert np.abs(rays.intensity - exact).max() <= 3e-3 * exact.max()


@pytest.mark.parametrize(
    "name", [name for name, case in EVERY.items() if able("fullwave", case.overlay)]
)
def test_waves_are_within_the_accuracy(name: str) -> None:
    overlay = EVERY[name].overlay
    exact = instrument("fullwave", overlay, accuracy=1e-7).spectrum(DIAMETER, FOCUS).intensity
    found = instrument("fullwave", overlay, accuracy=1e-3).spectrum(DIAMETER, FOCUS)
    assert found.status == AccuracyStatus.REACHED
    off = np.abs(found.intensity - exact).max() / exact.max()
    # little is left of waves that are within it where both polarisations nearly cancel
    assert off <= found.error <= (1e-3 if name != "crossed" else 1e-2)


@pytest.mark.parametrize("scheme", ["paths", "fullwave"])
def test_with_dispersion_each_wavenumber_is_that_of_constant_indices(scheme: str) -> None:
    found = instrument(scheme, SLOTS["dispersion"].overlay, accuracy=1e-7)
    spectrum = found.spectrum(DIAMETER, FOCUS).intensity
    for sample in (0, 5, 11):
        wavelength = 2 * np.pi / found.wavenumber[sample]
        named = {"glass": glass, "water": water, "neuron": neuron}
        index = {name: of(wavelength).real for name, of in named.items()}
        constant = instrument(scheme, {"scene": {"refractive_index": index}}, accuracy=1e-7)
        expected = constant.spectrum(DIAMETER, FOCUS).intensity[sample]
        assert abs(spectrum[sample] - expected) <= 3e-7 * spectrum.max()


def test_what_a_neuron_takes_of_waves_is_what_beer_and_lambert_say() -> None:
    plain = instrument("fullwave", {}, accuracy=1e-7).light(DIAMETER, FOCUS)
    overlay = {"scene": {"attenuation": {"neuron": "1000 /cm"}}}
    taken = instrument("fullwave", overlay, accuracy=1e-7).light(DIAMETER, FOCUS)
    far, near = (
        np.abs(taken.terms[term]).mean() / np.abs(plain.terms[term]).mean()  # type: ignore[union-attr]
        for term in (2, 1)
    )
    # there and back, of the amplitude; light off the axis goes as far, nearly
    assert far == pytest.approx(np.exp(-0.1 * DIAMETER), rel=0.01)
    index = complex(1.39, 0.1 / (2 * 8.3))
    reflected = abs((1.33 - index) / (1.33 + index)) / ((1.39 - 1.33) / (1.39 + 1.33))
    assert near == pytest.approx(reflected, rel=1e-3)


@pytest.mark.parametrize("scheme", ["vogel", "paths", "fullwave"])
def test_even_aberrations_of_a_focus_shift_are_that_shift(scheme: str) -> None:
    aperture, shift, n = 0.3, 0.1, 1.52
    # W = -dz n cos θ over the pupil, by Gauss's rule in the square of its radius
    x, w = np.polynomial.legendre.leggauss(40)
    radius = np.sqrt((x + 1) / 2)
    path = -shift * np.sqrt(n**2 - (radius * aperture) ** 2)
    terms = {
        number: f"{float((w / 2 * path * of.wavefront(radius, 0 * radius)).sum())!r} um"
        for number in (1, 4, 11, 22, 37)
        for of in [Aberration(((number, 1.0),))]
    }
    wide = {"objective": {"numerical_aperture": aperture}}
    settings: dict[str, Any] = {"accuracy": 1e-7, "rays": 3000}
    aberrated = instrument(scheme, merge(wide, {"objective": {"zernike": terms}}), **settings)
    moved = instrument(scheme, wide, **settings).spectrum(DIAMETER, FOCUS + shift).intensity
    off = np.abs(aberrated.spectrum(DIAMETER, FOCUS).intensity - moved).max()
    assert off <= 1e-5 * moved.max()


@pytest.mark.parametrize("offset", [0.0, 0.15])
def test_a_tilted_wavefront_moves_the_focus_of_waves_sideways(offset: float) -> None:
    # W = 2 a p_x has the focus at 2 a / NA
    tilt = 0.05
    cylinder = {"medium": "neuron", "x": f"{offset!r} um"}
    tilted = instrument(
        "fullwave",
        {
            "objective": {"zernike": {2: f"{tilt!r} um"}, "pupil": {"gaussian": 1.0}},
            "scene": {"cylinders": [cylinder]},
        },
        accuracy=1e-8,
    )
    beside = offset - 2 * tilt / 1.2
    moved = instrument(
        "fullwave",
        {
            "objective": {"pupil": {"gaussian": 1.0}},
            "scene": {"cylinders": [{**cylinder, "x": f"{beside!r} um"}]},
        },
        accuracy=1e-8,
    )
    found, expected = (one.spectrum(DIAMETER, FOCUS).intensity for one in (tilted, moved))
    assert np.abs(found - expected).max() <= 2e-8 * expected.max()


@pytest.mark.parametrize("width", [0.003, 0.02])
def test_an_absorption_line_is_seen_however_narrow(width: float) -> None:
    line = [0.6, 0.777 - width, 0.777, 0.777 + width, 1.0]
    table = {"table": {"wavelength": line, "n": [1.39] * 5, "kappa": [0, 0, 0.05, 0, 0]}}
    few = {"spectrum": {"samples": 400}, "tracing": {"rays": 300}}
    overlay = {"scene": {"refractive_index": {"neuron": table}}}
    found = Instrument(load_config(few, overlay))
    sample = int(np.abs(found.wavenumber - 2 * np.pi / 0.777).argmin())
    k = float(found.wavenumber[sample])
    taken = 2 * k * found.config.swept_material.index(k).imag
    constant = {"scene": {"attenuation": {"neuron": f"{taken!r} 1/um"}}}
    expected = Instrument(load_config(few, constant)).spectrum(DIAMETER, FOCUS).intensity
    spectrum = found.spectrum(DIAMETER, FOCUS).intensity
    assert abs(spectrum[sample] - expected[sample]) <= 1e-10 * expected.max()


def test_of_light_that_glass_takes_the_error_is_that_of_what_is_left() -> None:
    overlay = {"scene": {"attenuation": {"glass": "300 /cm"}}}
    found = instrument("paths", overlay, accuracy=1e-4).spectrum(DIAMETER, FOCUS)
    assert found.status == AccuracyStatus.REACHED
    assert found.error <= 3e-4


@pytest.mark.parametrize("name", EVERY)
def test_a_config_knows_what_its_optics_do_with_the_wavenumber(name: str) -> None:
    config = instrument("vogel", EVERY[name].overlay).config
    optics = optics_of(config)
    assert sampled(config) == optics.sampled
    assert way_varies(config) == optics.way_varies
