"""Noise: means and variances are as stated, and so is the ratio of the signal to it."""

import numpy as np
import pytest

from octsim.phase.noise import (
    expected_counts,
    measured_counts,
    photons_for,
    shot_noise,
    signal_to_noise,
)

K = np.linspace(7, 9.7, 400)
SPECTRUM = 3e-7 * (1 + 0.8 * np.cos(2 * 1.9 * K))


def test_counts_have_the_mean_and_the_variance_of_shot_and_read_noise() -> None:
    expected = expected_counts(SPECTRUM, 20_000)
    assert expected.sum() == pytest.approx(20_000)
    many = np.broadcast_to(SPECTRUM, (4000, K.size))
    for read_noise in (0.0, 6.0):
        counts = measured_counts(many, 20_000, read_noise, np.random.default_rng(1))
        variance = expected + read_noise**2
        # means and variances of 4000 draws, within five of their own deviations
        assert np.abs((counts.mean(axis=0) - expected) / np.sqrt(variance / 4000)).max() < 5
        # the variance of a variance of n draws is (mu_4 - mu_2^2) / n; a Poisson's mu_4 has + mu
        spread = np.sqrt((2 * variance**2 + expected) / 4000)
        assert np.abs((counts.var(axis=0) - variance) / spread).max() < 5


def test_the_same_seed_gives_the_same_counts() -> None:
    one, same, other = (
        measured_counts(SPECTRUM, 100, 1.0, np.random.default_rng(seed)) for seed in (5, 5, 6)
    )
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)


def test_the_ratio_is_that_of_the_peak_over_the_noise_in_the_depth_profile() -> None:
    # a whole number of oscillations, weak beside the offset
    num, component, photons, read_noise = 400, 20, 40_000.0, 3.0
    spectrum = 1 + 0.2 * np.cos(2 * np.pi * component * np.arange(num) / num)
    ratio = float(signal_to_noise(spectrum, photons, read_noise))
    counts = measured_counts(
        np.broadcast_to(spectrum, (3000, num)), photons, read_noise, np.random.default_rng(2)
    )
    profile = np.fft.rfft(counts, axis=1)
    peak = np.abs(profile[:, component].mean()) ** 2
    assert ratio == pytest.approx(peak / profile[:, 60:150].var(), rel=0.02)
    assert np.angle(profile[:, component]).std() == pytest.approx(1 / np.sqrt(2 * ratio), rel=0.06)


@pytest.mark.parametrize("read_noise", [0.0, 10.0])
def test_photons_for_a_ratio_give_that_ratio(read_noise: float) -> None:
    for ratio in (100.0, 1e6):
        photons = photons_for(SPECTRUM, ratio, read_noise)
        assert float(signal_to_noise(SPECTRUM, photons, read_noise)) == pytest.approx(ratio)


def test_shot_noise_is_poissonian() -> None:
    spectra = np.full((400, 50), 2.0)
    counts = shot_noise(spectra, 5000, np.random.default_rng(1))
    assert counts.mean() == pytest.approx(100, rel=0.005)
    assert counts.var() == pytest.approx(100, rel=0.05)
    dimmer = shot_noise(np.stack((spectra[0], 3 * spectra[0])), 1e9, np.random.default_rng(1))
    assert dimmer[1].sum() / dimmer[0].sum() == pytest.approx(3, rel=1e-3)
