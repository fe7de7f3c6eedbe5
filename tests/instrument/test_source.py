"""A source that is not flat multiplies intensities, and phases are those of a flat one."""

from typing import Any

import numpy as np
import pytest

from octsim.config.derive import merge
from octsim.config.load import load_config
from octsim.instrument.instrument import Instrument
from octsim.phase.estimators import estimate
from octsim.phase.fringe_status import FringeStatus
from octsim.phase.local_slopes import local_slope
from octsim.phase.noise import measured_counts

LAW = {"slope": 0.581, "intercept": "69 nm"}
RUN: dict[str, Any] = {
    "tracing": {"scheme": "fullwave", "accuracy": 1e-5},
    "spectrum": {"samples": 400},
    "sweep": {"focus": LAW},
    "processing": {"estimator": "sinusoid", "sinusoid": {"weights": "shot"}},
}


def instrument(fwhm: int | None = None) -> Instrument:
    source = {"gaussian": {"centre": "775 nm", "fwhm": f"{fwhm} nm"}}
    return Instrument(load_config(merge(RUN, {"spectrum": {"source": source}} if fwhm else {})))


def test_intensities_are_those_of_a_flat_source_times_its_power() -> None:
    flat, lit = instrument(), instrument(100)
    one, other = flat.spectrum(1.4, 0.88), lit.spectrum(1.4, 0.88)
    away = (2e3 * np.pi / flat.wavenumber - 775) / 100
    power = np.exp(-4 * np.log(2) * away**2)
    np.testing.assert_allclose(other.intensity, one.intensity * power, rtol=1e-13)
    # the same error somewhere in the band, over a smaller largest intensity
    assert other.error * other.intensity.max() == pytest.approx(one.error * one.intensity.max())


@pytest.mark.parametrize("fwhm", [200, 150, 100])
def test_the_slope_is_that_of_a_flat_source(fwhm: int) -> None:
    flat, lit = instrument(), instrument(fwhm)
    diameters = np.array([1.398, 1.4, 1.402])
    slopes = [
        local_slope(
            one.spectra(diameters, [0.88] * 3), one.wavenumber, diameters, 1.39,
            one.config.processing, one.power,
        )
        for one in (flat, lit)
    ]  # fmt: skip
    # another weight over the band sees another part of what is no sinusoid
    assert slopes[1] == pytest.approx(slopes[0], rel=0.015)


def test_without_it_the_source_s_shape_is_taken_for_the_fringe() -> None:
    lit, diameters = instrument(100), np.array([1.398, 1.4, 1.402])
    spectra = lit.spectra(diameters, [0.88] * 3)
    known, unknown = (
        local_slope(spectra, lit.wavenumber, diameters, 1.39, lit.config.processing, power)
        for power in (lit.power, None)
    )
    assert abs(unknown / known - 1) > 0.2


def test_stated_errors_of_phases_through_a_source_are_their_scatter() -> None:
    lit = instrument(150)
    spectrum = lit.spectrum(1.7, 1.06).intensity
    counts = measured_counts(
        np.broadcast_to(spectrum, (300, spectrum.size)), 1e6, 3.0, np.random.default_rng(1)
    )
    processing = lit.config.processing.model_copy(update={"read_noise": 3.0})
    depth = np.full(300, 1.39 * 1.7)
    found = estimate(counts, lit.wavenumber, depth, processing, source=lit.power)
    assert (found.status != FringeStatus.NO_FRINGE).all()
    ratio = found.phase.std() / found.phase_standard_error.mean()
    assert ratio == pytest.approx(1, abs=0.12)


def test_a_pixel_sees_the_mean_over_its_width() -> None:
    pixels = {"polynomial": [640, 12, -0.05]}
    coarse = Instrument(load_config(merge(RUN, {"spectrum": {"pixels": pixels}})))
    fine = Instrument(load_config(merge(RUN, {"spectrum": {"samples": 20001}})))
    nm = np.polynomial.Polynomial([640, 12, -0.05])(np.arange(30.0))
    assert coarse.wavenumber.size == ((nm >= 650) & (nm <= 900)).sum()
    middle = 2e3 * np.pi / nm[::-1]
    width = np.interp(coarse.wavenumber, middle, np.gradient(middle))
    exact = fine.spectrum(1.4, 0.88).intensity
    seen = coarse.spectrum(1.4, 0.88).intensity
    inner = slice(2, -2)  # the outermost pixels look beyond the band
    expected = np.array([
        exact[np.abs(fine.wavenumber - k) <= w / 2].mean()
        for k, w in zip(coarse.wavenumber, width, strict=True)
    ])  # fmt: skip
    off = np.abs(seen - expected)[inner].max() / exact.max()
    sampled = np.interp(coarse.wavenumber, fine.wavenumber, exact)
    rolled = np.abs(sampled - expected)[inner].max() / exact.max()
    assert off < 2e-3 < rolled / 3
