"""The aberration of a slide beside paths through one, and the closed form of small apertures."""

from math import sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from octsim.optics.slide import slide_aberration
from octsim.optics.zernike import Aberration

SLIDES = [(1.2, 1.515, 1.52, 170.0), (1.0, 1.33, 1.52, 30.0), (0.9, 1.47, 1.515, 1000.0)]


def paths_added(
    aperture: float, before: float, slide: float, thickness: float, rho: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return what a slide adds to paths up to one plane wavefront in it, by Snell's law, µm.

    Of a ray that is aimed at the origin, on the slide's far face: from where it meets the near face
    to the foot of its perpendicular from the origin, less what it had without the slide.
    """
    sine = rho * aperture / before
    outside, inside = np.arcsin(sine), np.arcsin(sine * before / slide)
    enters = -thickness * np.tan(outside)  # x of it on the near face, z = -thickness
    aimed = np.hypot(enters, thickness)
    foot = -enters * np.sin(inside) + thickness * np.cos(inside)
    return slide * foot - before * aimed


@pytest.mark.parametrize(("aperture", "before", "slide", "thickness"), SLIDES)
def test_the_wavefront_is_that_of_rays_through_the_slide_but_for_piston_and_focus(
    aperture: float, before: float, slide: float, thickness: float
) -> None:
    rho = np.sqrt((np.arange(400) + 0.5) / 400)  # of equal areas
    added = paths_added(aperture, before, slide, thickness, rho)
    known = np.stack([np.ones(len(rho)), np.sqrt(slide**2 - (aperture * rho) ** 2)], axis=1)
    left = added - known @ np.linalg.lstsq(known, added)[0]
    found = slide_aberration(aperture, before, slide, thickness)
    wavefront = Aberration(found.terms).wavefront(rho, 0 * rho)
    assert found.rms == pytest.approx(np.sqrt(np.mean(left**2)), rel=1e-3)
    assert np.sqrt(np.mean((wavefront - left) ** 2)) <= 1.05 * found.remainder + 1e-5 * found.rms


def test_at_a_small_aperture_it_is_seidels_spherical_aberration_of_a_plate() -> None:
    aperture, before, slide, thickness = 0.1, 1.33, 1.52, 170.0
    found = slide_aberration(aperture, before, slide, thickness)
    seidel = thickness * (slide**2 - before**2) / (8 * before**3 * slide**2) * aperture**4
    assert dict(found.terms)[11] == pytest.approx(seidel / (6 * sqrt(5)), rel=0.01)


def test_a_slide_of_the_immersions_index_adds_nothing() -> None:
    found = slide_aberration(1.2, 1.52, 1.52, 170.0)
    assert found.rms == found.remainder == 0


def test_it_grows_with_the_thickness_and_changes_sign_with_the_order_of_the_indices() -> None:
    one, two = (slide_aberration(1.2, 1.515, 1.52, thick) for thick in (100.0, 200.0))
    np.testing.assert_allclose([a for _, a in two.terms], [2 * a for _, a in one.terms], rtol=1e-9)
    swapped = slide_aberration(1.2, 1.52, 1.515, 100.0)
    assert dict(swapped.terms)[11] < 0 < dict(one.terms)[11]
