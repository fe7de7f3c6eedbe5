"""The photon transfer curve tells photoelectrons and read noise; where a camera is full."""

import numpy as np
import pytest

from octsim.measured.full_scale import full_scale_of, saturated
from octsim.measured.noise import transfer


@pytest.mark.parametrize(("gain", "read"), [(1.0, 3.0), (8.0, 0.5), (0.2, 20.0)])
def test_the_scatter_of_counts_tells_their_photoelectrons(gain: float, read: float) -> None:
    generator = np.random.default_rng(3)
    electrons = np.linspace(20, 20_000, 400)
    counts = generator.poisson(electrons, (2000, 400)) / gain
    counts = counts + read * generator.standard_normal(counts.shape)
    found = transfer(counts.mean(axis=0), counts.var(axis=0))
    assert 1 / found.per_count == pytest.approx(gain, rel=0.02)
    assert found.read_variance == pytest.approx(read**2, rel=0.2, abs=20 / gain**2)
    expected = electrons / gain**2 + read**2
    np.testing.assert_allclose(found.variance(electrons / gain), expected, rtol=0.1)


def test_nothing_that_scatters_has_no_variance_below_none() -> None:
    found = transfer(np.linspace(0, 100, 50), np.zeros(50))
    assert (found.variance(np.array([-5.0, 0.0, 10.0])) > 0).all()
    assert found.read_noise == 0


def spectra(
    most: float = 3000.0, kind: str = "uint16"
) -> "np.ndarray[tuple[int, int], np.dtype[np.float64]]":
    fringe = most * (1 + np.cos(np.linspace(0, 9, 200))) / 2
    return np.stack([fringe, 0.5 * fringe]).astype(kind)


def test_a_converter_of_12_bits_that_is_full_is_seen_in_16() -> None:
    counts = spectra()
    counts[0, 90:110] = 4095
    full = full_scale_of(counts, None)
    assert full == 4095
    assert saturated(counts, full).tolist() == [20, 0]
    # also where the first spectra do not reach it
    assert full_scale_of(spectra(), None) == np.inf
    assert saturated(counts, np.inf).tolist() == [20, 0]


def test_one_sample_on_a_level_may_be_chance() -> None:
    counts = spectra()
    counts[0, 90] = 4095
    assert saturated(counts, np.inf).tolist() == [0, 0]


def test_what_is_given_is_where_it_is_full() -> None:
    assert full_scale_of(spectra(), 2000.0) == 2000
    assert saturated(spectra(), 2000.0)[0] > 50
    assert saturated(spectra(kind="float64"), np.inf).tolist() == [0, 0]
