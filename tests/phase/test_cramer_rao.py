"""The bound: the information is the exact one, and what is not known beside it never helps."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import norm, poisson

from octsim.base.errors import OctsimError
from octsim.phase.cramer_rao import checked_slope, diameter_bound, fisher_information, phase_bound

K = np.linspace(7, 9.7, 400)


def test_the_information_of_counts_is_the_exact_one() -> None:
    # from the probabilities themselves: sum of (dp/dmu)^2 / p
    for mean in (0.3, 4.0, 50.0):
        n = np.arange(200)
        p, change = poisson.pmf(n, mean), poisson.pmf(n, mean + 1e-5) - poisson.pmf(n, mean - 1e-5)
        seen = p > 1e-250
        exact = float(((change[seen] / 2e-5) ** 2 / p[seen]).sum())
        found = fisher_information(np.array([mean]), np.ones((1, 1)))[0, 0]
        assert found == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize(("read_noise", "mean"), [(1.0, 0.5), (2.0, 3.0), (3.0, 10.0), (1.0, 30.0)])
def test_the_information_with_read_noise_is_a_close_lower_limit(
    read_noise: float, mean: float
) -> None:
    n = np.arange(int(mean + 12 * np.sqrt(mean) + 30))
    y = np.linspace(-10 * read_noise, n[-1] + 10 * read_noise, 8001)
    each, p = norm.pdf(y[:, np.newaxis], n, read_noise), poisson.pmf(n, mean)
    density, change = each @ p, each @ (p * (n / mean - 1))
    exact = float(np.trapezoid(change**2 / np.maximum(density, 1e-300), y))
    found = fisher_information(np.array([mean]), np.ones((1, 1)), read_noise)[0, 0]
    assert exact / (1.01 if mean >= 10 else 1.15) < found < exact * (1 + 1e-6)


def test_the_bound_of_a_phase_is_the_closed_form() -> None:
    # whole oscillations of visibility v: the mean of sin^2 / (1 + v cos) is (1 - sqrt(1-v^2)) / v^2
    angle = 2 * np.pi * 5 * np.arange(4000) / 4000
    none = np.empty((0, 4000))
    for v in (0.05, 0.6, 0.95):
        bound = phase_bound(np.full(4000, 10.0), np.full(4000, 10 * v), angle, none)
        information = 4000 * 10 * (1 - np.sqrt(1 - v**2))
        assert bound == pytest.approx(1 / np.sqrt(information), rel=1e-9)


def test_what_is_unknown_beside_the_phase_never_helps() -> None:
    offset, amplitude, angle = np.full(400, 9.0), np.full(400, 6.0), 3.8 * (K - 8)
    known = phase_bound(offset, amplitude, angle, np.empty((0, 400)))
    nuisances = np.stack([np.ones(400), np.cos(angle)])
    assert phase_bound(offset, amplitude, angle, nuisances) > known


def test_a_diameter_s_bound_falls_with_the_root_of_the_photons() -> None:
    def spectra(d: float) -> NDArray[np.float64]:
        return np.asarray(2 - np.cos(2 * 1.39 * d * K))

    step = 1e-4
    slope = checked_slope(np.stack([spectra(1.5 + i * step) for i in range(-2, 3)]), step)
    exact = 2 * 1.39 * K * np.sin(2 * 1.39 * 1.5 * K)
    assert np.abs(slope - exact).max() < 1e-9 * np.abs(exact).max() + 1e-9
    dim, bright = (diameter_bound(spectra(1.5), slope, n) for n in (1e3, 1e5))
    assert dim / bright == pytest.approx(10)
    assert diameter_bound(spectra(1.5), slope, 1e3, 5.0) > dim


def test_a_derivative_that_two_steps_disagree_on_is_refused() -> None:
    wild = np.cos(np.arange(5)[:, np.newaxis] * 2.0 + K)
    with pytest.raises(OctsimError, match="take a smaller step or a finer accuracy"):
        checked_slope(wild, 1.0)
