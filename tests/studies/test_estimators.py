"""The estimators compared on a sweep: its true slopes, resolution under noise, a wrong scene."""

import time

import numpy as np
import pytest
import xarray as xr
from made_runs import SWEEP
from missing import unexplained
from numpy.typing import NDArray

import octsim
from octsim.config.models import Config, Processing
from octsim.figures.estimators import estimators_figure
from octsim.figures.style import look
from octsim.phase.estimators import estimate
from octsim.phase.estimators.estimate import middle
from octsim.phase.estimators.likelihood import Model, maximum_likelihood
from octsim.phase.modelled_spectra import model_of_sweep, modelled
from octsim.phase.slopes import slope_of
from octsim.stages.detections import stored_rays
from octsim.studies.estimators.contenders import COMMON, CONTENDERS, Band, contenders, sweep_slopes
from octsim.studies.estimators.path_phase import path_slopes
from octsim.studies.estimators.resolution import resolution, surroundings_of
from octsim.studies.estimators.study import estimators, from_trend, summary
from octsim.studies.estimators.wrong_scene import misreading

Array = NDArray[np.float64]
K = Config().spectrum.wavenumbers()


def processing(**given: object) -> Processing:
    return Processing.model_validate(given)


def test_slopes_of_a_sweep_are_those_of_the_light_s_own_phase(spectra: xr.Dataset) -> None:
    diameter = spectra["diameter"].values
    true, _ = path_slopes(stored_rays(octsim.detections(SWEEP)), diameter, middle(K))
    intensity = spectra["intensity"].values
    for asked in (
        processing(estimator="sinusoid", sinusoid={"depth": "fitted"}),
        processing(estimator="esprit"),
    ):
        slope = slope_of(diameter, estimate(intensity, K, 1.39 * diameter, asked).phase)
        assert np.abs(slope - true).max() < 0.02
        assert from_trend(diameter, slope).std() < 0.01
    thesis = octsim.phase_slope(SWEEP, octsim.fourier(SWEEP, spectra))["phase_slope"].values
    assert np.abs(thesis - true).max() > 0.2


def test_a_sweep_of_151_goes_through_every_estimator_in_5_seconds() -> None:
    diameter = np.linspace(1, 2, 151)
    intensity = 2 - 0.99 * np.cos(2 * 1.39 * diameter[:, np.newaxis] * K)
    model, band = Model(diameter, intensity), Band(1.39, K)
    start = time.thread_time()
    found = {
        name: sweep_slopes(asked, band, diameter, intensity, model)
        for name, asked in contenders(Config()).items()
        if name != COMMON
    }
    assert time.thread_time() - start < 5
    assert len(found) >= 6
    # an ideal spectrum has the predicted slope, by all that fit what it is
    for name in ("esprit", "sinusoid_plain", "sinusoid", "maximum_likelihood"):
        assert np.allclose(found[name], band.predicted, atol=1e-4)


def test_likelihood_on_its_own_model_is_exact_and_on_another_is_not(spectra: xr.Dataset) -> None:
    diameter, intensity = spectra["diameter"].values, spectra["intensity"].values
    model = model_of_sweep(SWEEP, spectra["focus"].values)
    assert np.abs(maximum_likelihood(intensity, model) - diameter).max() < 1e-6
    wider = octsim.load_config(SWEEP.to_dict(), {"scene": {"refractive_index": {"neuron": 1.4}}})
    other = modelled(wider, diameter, spectra["focus"].values).intensity
    band, by_likelihood = Band(1.39, K), processing(estimator="maximum_likelihood")
    read = misreading(by_likelihood, band, diameter, intensity, other, model)
    # an optical depth is index times diameter
    assert read.mean == pytest.approx(0.01 / 1.39, abs=5e-4)
    assert abs(misreading(by_likelihood, band, diameter, intensity, intensity, model).mean) < 1e-5


def test_the_best_phase_of_a_series_is_within_1_3_of_the_bound() -> None:
    band, compared = Band(1.39, K), contenders(Config())
    asked = {name: compared[name] for name in ("sinusoid_common_envelope", "fft", "sinusoid")}
    around = surroundings_of(SWEEP, 1.1, 0.58 * 1.1 + 0.064)
    for ratio in (20.0, 60.0):
        found = resolution(around, band, asked, ratio, 0.0, (3,))
        assert found == resolution(around, band, asked, ratio, 0.0, (3,))  # of the same seed
        over = {name: error / found.bound for name, error in found.of_each.items()}
        assert 0.85 < over["sinusoid_common_envelope"] < 1.3
        # with little more than one oscillation, a slope not known costs twice the error
        assert over["sinusoid"] > 1.8
        assert over["fft"] > 1.8


def test_the_comparison_holds_every_estimator_and_draws() -> None:
    config = octsim.load_config(
        SWEEP.to_dict(),
        {
            "tracing": {"scheme": "vogel", "rays": 300},
            "spectrum": {"samples": 200},
            "sweep": {"diameters": {"num": 31}},
            "processing": {"centre": "mean", "window": "hann"},
        },
    )
    found = estimators(config, threads=2, runs=30)
    assert found["estimator"].values.tolist() == [*CONTENDERS, "run"]
    known = found.isel(estimator=found["estimator"] != "sinusoid_common_envelope")
    assert np.isfinite(known["phase_slope"]).all()
    assert np.isfinite(known["misreading"]).all()
    assert (found["bound"].diff("snr") < 0).all()
    of_likelihood = found["resolution_over_bound"].sel(estimator="maximum_likelihood")
    assert ((of_likelihood > 0.6) & (of_likelihood < 1.6)).all()
    best = found.sel(estimator="sinusoid_fitted_depth")
    assert float(best["converged_scatter"]) < 0.1 * float(
        found["converged_scatter"].sel(estimator="fft")
    )
    assert "Cramér–Rao" in summary(found)
    assert list(unexplained(found)) == []
    with look():
        assert len(estimators_figure(found).axes) == 3
