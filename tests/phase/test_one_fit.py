"""A series by one fit: phases of known fringes, and errors that are those of its noise."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from octsim.config.processing import Processing, Sinusoid
from octsim.phase.cramer_rao import phase_bound
from octsim.phase.derivatives import wrapped
from octsim.phase.estimators import phases
from octsim.phase.estimators.one_fit import Model, design_of, fitted, residuals
from octsim.phase.estimators.series import series_phases

Array = NDArray[np.float64]
# pixels evenly spaced in wavelength
WAVELENGTH = np.linspace(0.9, 0.65, 600)
K = 2 * np.pi / WAVELENGTH
MIDDLE = (K[0] + K[-1]) / 2
SOURCE = np.exp(-4 * np.log(2) * ((WAVELENGTH - 0.775) / 0.1) ** 2)
PHASE = np.linspace(-3, 3, 25)
DEPTH = 3.0


def fringes(phase: Array = PHASE, depth: float = DEPTH, turned: Array | float = 0.0) -> Array:
    angle = 2 * depth * (K - MIDDLE) + phase[:, np.newaxis] + turned
    return np.asarray(SOURCE * (2 + np.cos(angle)))


def fit_of(spectra: Array, model: Model, variance: Array | None = None) -> Any:
    design = design_of(model, spectra.mean(axis=0), 0.0)
    return fitted(design, spectra, np.ones(K.size) if variance is None else variance)


def model(depth: float = DEPTH, **options: Any) -> Model:
    return Model(K, depth, Sinusoid.model_validate(options), SOURCE)


@pytest.mark.parametrize("weights", ["equal", "shot"])
def test_phases_of_known_fringes_come_back(weights: str) -> None:
    found = fit_of(fringes(), model(weights=weights))
    np.testing.assert_allclose(wrapped(found.phase - PHASE), 0, atol=1e-10)
    np.testing.assert_allclose(found.visibility, 0.5, rtol=1e-10)
    assert found.residual.max() < 1e-12


def test_a_fringe_s_own_shape_is_kept_by_a_common_envelope() -> None:
    near = PHASE[12] + np.linspace(-1e-3, 1e-3, 5)
    found = fit_of(fringes(near), model(envelope="common", weights="shot"))
    # it is known of the mean, and so of what moves little
    np.testing.assert_allclose(np.diff(found.phase), np.diff(near), rtol=1e-6)


def test_dispersion_that_is_known_moves_no_phase() -> None:
    x = (K - MIDDLE) / (K[-1] - MIDDLE)
    turned = 3.0 * x**2 - 1.5 * x**3
    spectra = fringes(turned=turned)
    known = fit_of(spectra, model()._replace(turned=turned))
    np.testing.assert_allclose(wrapped(known.phase - PHASE), 0, atol=1e-10)
    assert fit_of(spectra, model()).residual.max() > 1e-2


def test_what_moves_all_alike_is_taken_off_by_a_reflector_that_does_not_move() -> None:
    bulk = np.linspace(0, 2, PHASE.size)
    still = SOURCE * 0.7 * np.cos(2 * 9.0 * (K - MIDDLE) + bulk[:, np.newaxis])
    spectra = fringes(PHASE + bulk) + still
    found = fit_of(spectra, model()._replace(reference_depth=9.0))
    np.testing.assert_allclose(wrapped(found.phase - PHASE), 0, atol=1e-10)


@pytest.mark.parametrize("envelope", ["each", "common"])
@pytest.mark.parametrize("reference", [None, 9.0])
def test_stated_errors_are_the_scatter_of_noise(envelope: str, reference: float | None) -> None:
    clean = fringes(np.array([0.4]))[0]
    if reference:
        clean = clean + SOURCE * 0.7 * np.cos(2 * reference * (K - MIDDLE) + 0.3)
    variance = 0.01 * clean + 1e-4
    generator = np.random.default_rng(5)
    noisy = clean + np.sqrt(variance) * generator.standard_normal((4000, K.size))
    asked = model(weights="shot", envelope=envelope)._replace(reference_depth=reference)
    found = fitted(design_of(asked, clean, 0.01), noisy, variance)
    assert found.phase.std() / found.phase_error.mean() == pytest.approx(1, abs=0.03)


def test_a_common_envelope_is_as_good_as_noise_allows() -> None:
    clean = 1e4 * fringes(np.array([0.4]))[0]
    found = fitted(
        design_of(model(weights="shot", envelope="common"), clean, 0.0), clean[np.newaxis], clean
    )
    angle = 2 * DEPTH * (K - MIDDLE) + 0.4
    offset, amplitude = 2e4 * SOURCE, 1e4 * SOURCE
    nuisances = np.stack([offset, amplitude * np.cos(angle)])
    bound = phase_bound(offset, amplitude, angle, nuisances)
    assert found.phase_error[0] / bound == pytest.approx(1, abs=0.01)


def test_residuals_are_what_the_model_does_not_have() -> None:
    spectra = fringes()
    left = residuals(design_of(model(), spectra.mean(axis=0), 0.0), spectra)
    assert np.abs(left).max() < 1e-12


def test_a_series_on_even_samples_has_the_weights_of_its_mean() -> None:
    k = np.linspace(7.0, 9.6, 400)
    angle = 2 * DEPTH * (k - k.mean()) + PHASE[:, np.newaxis]
    spectra = 2 + np.cos(angle) + 0.05 * np.cos(3 * angle)  # no sinusoid
    shot = Processing.model_validate({"estimator": "sinusoid", "sinusoid": {"weights": "shot"}})
    found = series_phases(spectra, k, DEPTH, shot)
    design = design_of(Model(k, DEPTH, shot.sinusoid), spectra.mean(axis=0), 0.0)
    np.testing.assert_array_equal(found, fitted(design, spectra, np.ones(k.size)).phase)
    # of one spectrum it is the same fit as of a sweep's
    alone = series_phases(spectra[3:4], k, DEPTH, shot)
    np.testing.assert_allclose(
        alone, phases(spectra[3:4], k, np.array([DEPTH]), shot).phase, atol=1e-6
    )
