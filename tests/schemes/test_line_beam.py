"""A line beam on a cylinder over a plane, in two dimensions, beside what is not it."""

import numpy as np
import pytest
from line_beam import (
    LineBeam,
    Polarisation,
    Slide,
    cylinder,
    detected,
    gaussian_beam,
    normal,
    reflection,
    returned,
)

K = 8.0
FOCUS = 0.75
LIGHTS: tuple[Polarisation, ...] = ("along", "across")


def tilted(beam: LineBeam, at: float) -> LineBeam:
    """Return a beam that is brightest off the axis, and focused at x = 0.2 µm."""
    shape = np.exp(-((beam.kx - at) ** 2) / 9 - 0.2j * beam.kx)
    return beam._replace(amplitude=beam.amplitude * shape)


@pytest.mark.parametrize("light", LIGHTS)
def test_a_cylinder_without_contrast_is_not_there(light: Polarisation) -> None:
    slide = Slide(neuron=1.33)
    beam = gaussian_beam(slide, K, FOCUS, 1)
    plane = reflection(slide.glass, slide.water, K, beam.kx, light) * beam.amplitude
    np.testing.assert_array_equal(returned(slide, K, beam, light), plane)


@pytest.mark.parametrize("light", LIGHTS)
def test_what_one_beam_sends_to_another_is_what_that_sends_back(light: Polarisation) -> None:
    slide = Slide(gap=0.05, diameter=1.7, neuron=1.5)
    beam = gaussian_beam(slide, K, FOCUS, 1)
    one, other = tilted(beam, 4), tilted(beam, -1)
    flux = normal(slide.glass, K, beam.kx) * beam.weight

    def sent(by: LineBeam, to: LineBeam) -> complex:
        received = flux * to.amplitude[::-1] * returned(slide, K, by, light)
        return complex(received.sum() / flux.sum())

    assert abs(sent(one, other)) > 1e-3
    assert sent(one, other) == pytest.approx(sent(other, one), rel=0, abs=1e-12)


@pytest.mark.parametrize("light", LIGHTS)
def test_a_cylinder_without_loss_sends_out_what_comes_in(light: Polarisation) -> None:
    scatter = cylinder(Slide(neuron=1.6, diameter=3), K, np.arange(-20, 21), light)
    np.testing.assert_allclose(abs(1 + 2 * scatter), 1, rtol=0, atol=1e-13)


def by_born(slide: Slide, beam: LineBeam) -> complex:
    """Return what a faint cylinder adds for light along it: i k² / 4π ∫ Δε E² dA, by area."""
    radial, radial_weight = np.polynomial.legendre.leggauss(40)
    radius = slide.diameter / 4 * (1 + radial)
    turn = 2 * np.pi * np.arange(120) / 120
    area = (radial_weight * slide.diameter / 4 * radius)[:, None] * np.full(120, 2 * np.pi / 120)
    x = radius[:, None] * np.cos(turn)
    z = slide.height + radius[:, None] * np.sin(turn)
    glass, water = normal(slide.glass, K, beam.kx), normal(slide.water, K, beam.kx)
    lit = beam.weight * beam.amplitude * 2 * glass / (glass + water)
    field = (lit * np.exp(1j * (x[..., None] * beam.kx + z[..., None] * water))).sum(axis=-1)
    # the light that is reflected by the plane from above stays out: it is of second order
    contrast = slide.neuron**2 - slide.water**2
    sent = (glass.real * beam.weight * abs(beam.amplitude) ** 2).sum()
    return complex(1j * K**2 / (4 * np.pi) * contrast * (field**2 * area).sum() / sent)


def test_a_faint_cylinder_is_as_born_has_it_to_first_order() -> None:
    ratios = []
    for contrast in (1e-4, 1e-5):
        slide = Slide(neuron=1.33 + contrast)
        beam = gaussian_beam(slide, K, FOCUS, 1)
        without = detected(slide._replace(neuron=1.33), K, beam, "along")
        added = detected(slide, K, beam, "along") - without
        ratios.append(abs(added / by_born(slide, beam) - 1) / contrast)
    assert max(ratios) < 25
    assert ratios[0] == pytest.approx(ratios[1], rel=1e-2)


@pytest.mark.parametrize("light", LIGHTS)
def test_more_partial_waves_and_more_directions_change_nothing(light: Polarisation) -> None:
    slide = Slide(diameter=2.5)
    coarse, fine = (gaussian_beam(slide, K, FOCUS, 1, nodes=nodes) for nodes in (120, 240))
    found = detected(slide, K, coarse, light)
    assert found == pytest.approx(detected(slide, K, fine, light), rel=0, abs=1e-12)
    more = returned(slide, K, coarse, light, 32) - returned(slide, K, coarse, light)
    assert abs(more).max() < 1e-10


# Meep 1.25 at 120 and 160 pixels a µm, by `benchmarks/peers/fdtd.py`
MEEP: dict[Polarisation, tuple[complex, complex]] = {
    "along": (0.04699033048584 + 0.05004869918594j, 0.04713864374126 + 0.05001886825281j),
    "across": (0.04458146243715 + 0.04537122187352j, 0.04472012082647 + 0.04534799237820j),
}


@pytest.mark.parametrize("light", LIGHTS)
def test_finite_differences_in_time_come_to_the_same_with_the_pixel_squared(
    light: Polarisation,
) -> None:
    slide = Slide()
    exact = detected(slide, K, gaussian_beam(slide, K, FOCUS, 0.5), light)
    coarse, fine = MEEP[light]
    assert abs(fine / exact - 1) < 3e-3
    assert abs(coarse / exact - 1) / abs(fine / exact - 1) == pytest.approx(
        (160 / 120) ** 2, rel=0.05
    )
    without_pixels = (160**2 * fine - 120**2 * coarse) / (160**2 - 120**2)
    assert abs(without_pixels / exact - 1) < 3e-4
