"""A sample that stands alone in a spectrum is named; fringes, noise and steep sources are none."""

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

import octsim
from octsim.base.errors import OctsimWarning
from octsim.phase.fringe_status import FringeStatus
from octsim.phase.lone_samples import lone

Array = NDArray[np.float64]


def counts(samples: int, turns: float = 9.0, width: float = np.inf) -> Array:
    source = np.exp(-0.5 * (np.linspace(-1, 1, samples) / width) ** 2)
    return 2000 * source * (1 + 0.8 * np.cos(np.linspace(0, turns, samples)))


@pytest.mark.parametrize("samples", [50, 200, 2048])
@pytest.mark.parametrize("value", [-998.5, -1.0, 0.0, 65535.0])
def test_a_wrong_sample_among_noisy_ones_is_found_wherever_it_stands(
    samples: int, value: float
) -> None:
    noise = 20 * np.random.default_rng(3).normal(size=samples)
    for at in (2, 5, samples // 2, samples - 3):
        spectrum = counts(samples) + noise
        spectrum[at] = value
        assert np.flatnonzero(lone(spectrum)).tolist() == [at]


@pytest.mark.parametrize("samples", [30, 60, 400, 2048])
@pytest.mark.parametrize("turns", [3.0, 30.0, 100.0])
@pytest.mark.parametrize("width", [0.1, 0.3, np.inf])
@pytest.mark.parametrize("noise", [0.0, 10.0, 1000.0])
def test_fringes_noise_and_steep_sources_have_none(
    samples: int, turns: float, width: float, noise: float
) -> None:
    drawn = noise * np.random.default_rng(5).normal(size=(20, samples))
    for spectrum in np.round(counts(samples, turns, width) + drawn):
        assert not lone(spectrum).any()


def test_phase_of_names_the_sample_that_moves_the_phase() -> None:
    wavelength = np.linspace(650, 900, 400)
    k = 2e3 * np.pi / wavelength
    spectrum = 3000 * (1 + 0.6 * np.cos(3.8 * (k - k.mean()) + 0.3))
    right = octsim.phase_of(_dataset(wavelength, spectrum)).phase[0]
    spectrum[200] = 65535
    with pytest.warns(OctsimWarning, match=r"the first 6.554e\+04 in spectrum 0 at 775.313 nm"):
        found = octsim.phase_of(_dataset(wavelength, spectrum)).phase[0]
    assert abs(found - right) > 5e-3


def test_what_is_said_of_measured_spectra_speaks_of_no_config() -> None:
    k = np.linspace(7, 9.7, 500)
    mixed = 2 + np.cos(3.8 * k) + 0.2 * np.cos(10 * k)
    with pytest.warns(OctsimWarning, match="mixed") as said:
        octsim.phase_of(
            xr.Dataset({"intensity": ("wavenumber", mixed)}, {"wavenumber": ("wavenumber", k, UM)})
        )
    (line,) = [str(one.message) for one in said]
    assert "divide the spectra by the source's own" in line
    assert "gap" not in line
    assert "detector" not in line
    for status in FringeStatus:
        assert bool(status.measured_remedy) == bool(status.remedy)
        for key in ("spectrum.", "scene.", "detector.", "focus", "neuron", "tracing."):
            assert key not in status.measured_remedy, status
        assert "measured" not in status.remedy


UM = {"units": "um-1"}


def _dataset(wavelength: Array, spectrum: Array) -> xr.Dataset:
    along = {"wavelength": ("wavelength", wavelength, {"units": "nm"})}
    return xr.Dataset({"intensity": ("wavelength", spectrum)}, along)
