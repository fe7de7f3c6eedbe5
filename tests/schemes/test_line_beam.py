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

from octsim.optics.pupil import GaussianPupil
from octsim.schemes.fullwave.coupling import contour, coupling
from octsim.schemes.fullwave.cylinder import scattering
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.detection import collected
from octsim.schemes.fullwave.illumination import illumination, mirror_waves
from octsim.schemes.fullwave.operators import Operator
from octsim.schemes.fullwave.scatter import incoming, scattered

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


def slice_of_fullwave(slide: Slide, fill: float, aperture: float, offset: float) -> list[complex]:
    """Return what scheme fullwave collects of the cylinder's light at k_y = 0: across, along."""
    scene = CylinderOnPlane(*slide, offset=offset)
    k, along, waves = np.array([K]), np.zeros(1), int(K * slide.neuron * scene.radius) + 22
    path = contour(80, waves, slide.water * K * scene.height)
    operator = Operator(
        k, along, np.ones(1), scattering(scene, along, k, waves), coupling(scene, path, along, k),
        mirror_waves(path.angle, waves),
    )  # fmt: skip
    pupil = GaussianPupil(fill)
    sine, weight = np.polynomial.legendre.leggauss(80)
    squared = pupil.amplitude(aperture * sine, aperture, K) ** 2
    whole = 2 * slide.glass * aperture * (squared * weight).sum()
    found = [0j, 0j]
    for lit in illumination(scene, pupil, aperture, FOCUS, along, k, waves, 60):
        b = scattered(operator.cylinder.whole, *incoming(operator, lit, 1e-14)[:2])
        density = collected(lit, *b, scene.n_water, along)
        found[lit.polarisation] += complex(density[0, 0]) / whole
    return found


@pytest.mark.parametrize("offset", [0.0, 0.25])
@pytest.mark.parametrize(
    "slide",
    [
        Slide(),
        Slide(gap=0, diameter=0.7),
        Slide(gap=0.3, diameter=2.4, neuron=1.45),
        Slide(glass=1.45, water=1.36, neuron=1.34, diameter=1.8),
        Slide(neuron=2.0),
    ],
)
def test_scheme_fullwave_is_the_same_at_right_angles_to_the_cylinder(
    slide: Slide, offset: float
) -> None:
    beam = gaussian_beam(slide, K, FOCUS, 1)
    beam = beam._replace(amplitude=beam.amplitude * np.exp(1j * beam.kx * offset))
    found = slice_of_fullwave(slide, 1, 1.2, offset)
    for light, value in zip(("across", "along"), found, strict=True):
        assert light in LIGHTS
        plane = detected(slide._replace(neuron=slide.water), K, beam, light)
        cylinder_alone = detected(slide, K, beam, light) - plane
        assert value == pytest.approx(cylinder_alone, rel=0, abs=1e-10)
