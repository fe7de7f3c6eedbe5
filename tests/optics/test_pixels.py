"""The mean of a spectrum over a pixel's width: the roll-off of a fringe is a sinc."""

import numpy as np

from octsim.optics.pixels import pixel_means


def test_a_fringe_rolls_off_by_the_sinc_of_depth_and_width() -> None:
    k = np.linspace(7.0, 8.0, 400)
    width = 0.004 + 0.001 * (k - 7.5)
    for depth in (5.0, 60.0, 150.0):
        fringe = np.cos(2 * depth * k + 0.4)
        expected = fringe * np.sinc(depth * width / np.pi)
        inner = slice(10, -10)  # a spline knows less at its ends
        found = pixel_means(1 + fringe, k, width)
        assert np.abs(found - 1 - expected)[inner].max() < 1e-4
    assert np.abs(pixel_means(1 + 0 * k, k, width) - 1).max() < 1e-10
