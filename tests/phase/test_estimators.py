"""Estimators: known phases come back, by each, and none is better than the noise allows."""

import numpy as np
import pytest
import xarray as xr
from made_runs import SWEEP
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.signal import czt

import octsim
from octsim.base.errors import OctsimError
from octsim.config.models import Config, Processing
from octsim.optics.two_beams import ideal_spectra, predicted_phase_slope
from octsim.phase.by_config import estimator_of, ideal_phases
from octsim.phase.cramer_rao import phase_bound
from octsim.phase.estimators import ESTIMATORS, estimate, phases
from octsim.phase.estimators.estimate import middle, place
from octsim.phase.estimators.fft import peak_depths
from octsim.phase.estimators.likelihood import Model, maximum_likelihood
from octsim.phase.estimators.series import series_phases
from octsim.phase.slopes import slope_of
from octsim.phase.transform import centred, fourier_components, prepared, window_samples

Array = NDArray[np.float64]
K = Config().spectrum.wavenumbers()
X = place(K)
DEPTH = np.linspace(1.45, 2.75, 27)
PHASE = np.linspace(-3, 3, 27)


def fringes(offset: Array | float = 2.0, amplitude: Array | float = 1.0) -> Array:
    """Spectra of known phases and depths, (27, K)."""
    angle = 2 * DEPTH[:, np.newaxis] * (K - middle(K)) + PHASE[:, np.newaxis]
    return np.asarray(offset + amplitude * np.cos(angle))


def off(found: Array, known: Array = PHASE) -> float:
    """Give the largest difference of phases, whatever their wraps."""
    return float(np.abs(np.angle(np.exp(1j * (found - known)))).max())


def processing(**given: object) -> Processing:
    return Processing.model_validate(given)


def sinusoid(**given: object) -> Processing:
    return processing(estimator="sinusoid", sinusoid=given)


@pytest.mark.parametrize("weights", ["shot", "equal"])
@pytest.mark.parametrize("depth", ["held", "fitted"])
def test_a_sinusoid_on_its_own_polynomials_is_found_to_rounding(depth: str, weights: str) -> None:
    spectra = fringes(3 + 0.4 * X, 1 + 0.2 * X)
    found = estimate(spectra, K, DEPTH, sinusoid(depth=depth, weights=weights))
    assert off(found.phase) < 1e-9
    assert np.abs(found.depth - DEPTH).max() < 1e-9


def test_a_depth_is_fitted_from_one_that_is_off() -> None:
    spectra = fringes(3 + 0.4 * X, 1 + 0.2 * X)
    found = estimate(spectra, K, 1.05 * DEPTH, sinusoid(depth="fitted"))
    assert np.abs(found.depth - DEPTH).max() < 1e-8
    assert off(found.phase) < 1e-8


@pytest.mark.parametrize("degree", [0, 1])
def test_the_fitted_sinusoid_is_the_least_squares_one(degree: int) -> None:
    # of a spectrum that is none; against a general solver of all parameters at once
    spectrum = fringes(3 + 0.4 * X + 0.1 * X**3, 1 + 0.1 * X**2)[10]
    asked = sinusoid(depth="fitted", weights="equal", offset_degree=degree, amplitude_degree=degree)
    found = estimate(spectrum[np.newaxis], K, DEPTH[10:11], asked)

    def residual(p: Array) -> Array:
        below = np.polynomial.polynomial.polyval(X, p[2 : 3 + degree])
        on = np.polynomial.polynomial.polyval(X, p[3 + degree :])
        return np.asarray(below + on * np.cos(2 * p[0] * (K - middle(K)) + p[1]) - spectrum)

    start = [DEPTH[10], PHASE[10], 3.0, *[0.1] * degree, 1.0, *[0.1] * degree]
    best = least_squares(residual, start, xtol=1e-15, ftol=1e-15, gtol=1e-15).x
    assert found.depth[0] == pytest.approx(best[0], abs=1e-6)
    assert off(found.phase, best[1]) < 1e-6


def test_a_common_envelope_is_that_of_the_series() -> None:
    # at one depth; the phases differ, the envelope doesn't
    phase = np.linspace(-0.1, 0.1, 9)[:, np.newaxis]
    spectra = 3 + 0.4 * X + (1 + 0.2 * X) * np.cos(2 * 2.0 * (K - middle(K)) + phase)
    depth = np.full(9, 2.0)
    found = estimate(spectra, K, depth, sinusoid(envelope="common"))
    assert off(found.phase, phase[:, 0]) < 1e-9
    with pytest.raises(OctsimError, match=r"processing\.sinusoid\.envelope: common given"):
        estimate(fringes(), K, DEPTH, sinusoid(envelope="common"))


def test_esprit_finds_an_oscillation_on_an_offset_to_rounding() -> None:
    found = estimate(fringes(), K, DEPTH, processing(estimator="esprit"))
    # means of neighbouring samples shift no phase
    assert off(found.phase) < 1e-8
    assert np.abs(found.depth - DEPTH).max() < 1e-8


def test_esprit_finds_an_amplitude_that_falls_as_an_exponential() -> None:
    found = estimate(fringes(2.0, np.exp(-0.3 * X)), K, DEPTH, processing(estimator="esprit"))
    assert off(found.phase) < 1e-4
    assert np.abs(found.depth - DEPTH).max() < 1e-4


def test_the_zero_padded_phase_is_that_of_the_chirp_transform() -> None:
    asked = processing(estimator="zero_padded", centre="weighted", window="hann")
    spectra = fringes()
    found = estimate(spectra, K, DEPTH, asked)
    step = K[1] - K[0]
    for i in (0, 13, 26):
        turn = np.exp(-2j * DEPTH[i] * step)
        value = czt(prepared(spectra[i], asked), 1, turn, np.exp(2j * DEPTH[i] * step))[0]
        phase = np.angle(value) + 2 * DEPTH[i] * (middle(K) - K[0])
        assert off(found.phase[i : i + 1], phase) < 1e-9


@pytest.mark.parametrize("estimator", ["fft", "zero_padded", "hilbert", "fringe"])
def test_many_oscillations_have_their_phase(estimator: str) -> None:
    depth = 30 + 3 * DEPTH
    spectra = 2 - np.cos(2 * depth[:, np.newaxis] * K)
    known = 2 * depth * middle(K) + np.pi
    asked = processing(estimator=estimator, centre="weighted", window="hann")
    found = estimate(spectra, K, depth, asked)
    # the strongest component's depth is off by up to half a component
    assert off(found.phase, known) < {"hilbert": 1e-3, "fringe": 2e-3}.get(estimator, 1e-4)
    assert np.abs(found.depth - depth).max() < (0.6 if estimator == "fft" else 2e-3)


def test_a_fringe_is_followed_by_its_order() -> None:
    spectra = 2 - np.cos(2 * DEPTH[:, np.newaxis] * K)
    # expected within a quarter of a wavelength
    found = estimate(spectra, K, DEPTH + 0.08, processing(estimator="fringe"))
    assert np.abs(found.depth - DEPTH).max() < 2e-4


def test_the_peak_is_at_the_depth() -> None:
    depth = np.linspace(20, 40, 11)
    spectra = 5 + np.cos(2 * depth[:, np.newaxis] * K)
    asked = processing(centre="weighted", window="hann")
    assert np.abs(peak_depths(spectra, K, asked) - depth).max() < 2e-3
    found = estimate(fringes(), K, np.full(27, np.nan), processing(
        estimator="sinusoid", depth="peak", sinusoid={"depth": "fitted"}
    ))  # fmt: skip
    assert off(found.phase) < 1e-6


def test_a_given_depth_is_used() -> None:
    given = processing(estimator="zero_padded", depth="2 um")
    assert np.array_equal(
        estimate(fringes(), K, DEPTH, given).phase,
        estimate(fringes(), K, np.full(27, 2.0), processing(estimator="zero_padded")).phase,
    )


def test_centres_take_away_what_they_say() -> None:
    spectra = fringes(3 + X - X**2, 0.0)
    assert np.abs(centred(spectra, "polynomial", "hann", 2)).max() < 1e-12
    left = centred(fringes(), "weighted", "hann") @ window_samples("hann", K.size)
    assert np.abs(left).max() < 1e-9
    constant = centred(fringes(), "polynomial", "hann", 0)
    assert np.allclose(constant, centred(fringes(), "weighted", "hann"), atol=1e-12)


@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_estimators_know_no_unit_and_no_neighbours(estimator: str) -> None:
    asked = processing(estimator=estimator)
    found = estimate(fringes(2 + 0.1 * X), K, DEPTH, asked)
    dim = estimate(1e-7 * fringes(2 + 0.1 * X), K, DEPTH, asked)
    alone = estimate(fringes(2 + 0.1 * X)[5:6], K, DEPTH[5:6], asked)
    assert off(dim.phase, found.phase) < 1e-6
    assert off(alone.phase, found.phase[5:6]) < 1e-6


def test_likelihood_finds_diameters_between_those_of_its_model() -> None:
    at = np.linspace(1, 1.4, 121)  # every second as far apart as in the thesis's sweep
    spectra = 2 - 0.99 * np.cos(2 * 1.39 * at[:, np.newaxis] * K) * (1 - 0.1 * X)
    model = Model(at[::2], spectra[::2])
    assert np.abs(maximum_likelihood(7 * spectra[1:-1], model) - at[1:-1]).max() < 1e-6
    with pytest.raises(OctsimError, match="a model of 3 diameters and 1000 wavenumbers"):
        maximum_likelihood(spectra, Model(at[:3], spectra[:3]))


def test_the_sinusoid_reaches_the_bound_of_what_it_does_not_know() -> None:
    offset, amplitude, angle = 50 + 3 * X, 45 + 2 * X, 2 * 2.1 * (K - middle(K)) + 0.4
    counts = np.random.default_rng(7).poisson(
        np.broadcast_to(offset + amplitude * np.cos(angle), (1500, K.size))
    ).astype(float)  # fmt: skip
    phase = phases(counts, K, np.full(1500, 2.1), sinusoid(weights="shot")).phase
    some = estimate(counts[:20], K, np.full(20, 2.1), sinusoid(weights="shot")).phase
    assert off(some, phase[:20]) < 1e-12
    cos, sin = np.cos(angle), np.sin(angle)
    nuisances = np.stack([np.ones_like(X), X, cos, X * cos, X * sin])
    bound = phase_bound(offset, amplitude, angle, nuisances)
    # 1500 runs: the deviation itself is known to 1.8 %
    assert phase.std() == pytest.approx(bound, rel=0.08)
    assert abs(phase.mean() - 0.4) < 4 * bound / np.sqrt(1500)
    equal = phases(counts, K, np.full(1500, 2.1), sinusoid(weights="equal")).phase
    # least squares of counts: inverse · counts · inverse, about the phase's own direction
    columns = np.stack([np.ones_like(X), X, np.cos(angle - 0.4), X * np.cos(angle - 0.4),
                        np.sin(angle - 0.4), X * np.sin(angle - 0.4)])  # fmt: skip
    gain = np.linalg.pinv(columns.T)
    along = (-np.sin(0.4) * gain[2] - np.cos(0.4) * gain[4]) / 45
    expected = np.sqrt((along**2 * (offset + amplitude * cos)).sum())
    assert equal.std() == pytest.approx(expected, rel=0.08)
    assert expected > 1.1 * bound


@pytest.mark.parametrize("estimator", sorted({*ESTIMATORS, "maximum_likelihood"} - {"fft"}))
def test_a_run_s_slope_is_by_the_estimator_that_it_names(
    estimator: str, spectra: xr.Dataset
) -> None:
    config = octsim.load_config(
        SWEEP.to_dict(), {"processing": {"estimator": estimator, "centre": "midpoint"}}
    )
    transformed = octsim.fourier(config, spectra)
    found = octsim.phase_slope(config, transformed)
    thesis = octsim.phase_slope(SWEEP, octsim.fourier(SWEEP, spectra))
    assert found["phase_slope"].values == pytest.approx(
        slope_of(spectra["diameter"].values, transformed["estimated_phase"].values)
    )
    assert not np.allclose(found["phase_slope"], thesis["phase_slope"])
    # those of the components stay
    assert found["component_phase_slope"].equals(thesis["component_phase_slope"])
    assert float(found["mean_phase_slope"]) == pytest.approx(23.2, abs=0.3)
    if estimator in {"sinusoid", "esprit", "maximum_likelihood"}:
        assert np.allclose(found["ideal_phase_slope"], found["predicted_phase_slope"], atol=1e-6)


def test_a_series_by_fft_is_of_one_component() -> None:
    depth = 0.5 * (np.pi / (K[-1] - K[0])) * 3.0  # between two components
    phase = np.linspace(0, 0.3, 40)[:, np.newaxis]
    spectra = np.cos(2 * depth * (K - middle(K)) + phase)
    found = series_phases(spectra, K, 1.5 * 1.39, Processing())
    assert np.abs(np.diff(np.unwrap(found))).max() < 0.05


@pytest.mark.parametrize("centre", ["weighted", "polynomial"])
@pytest.mark.parametrize("name", ESTIMATORS)
def test_a_spectrum_s_phase_does_not_depend_on_its_neighbours(name: str, centre: str) -> None:
    diameter = np.linspace(0.6, 6.0, 9)
    noise = np.random.default_rng(7).normal(0, 0.01, (9, K.size))
    spectra = 2 + 0.1 * K + np.cos(2 * 1.39 * np.outer(diameter, K)) + noise
    for depth in ("nominal", "peak"):
        asked = {"estimator": name, "centre": centre, "depth": depth}
        processing = Processing.model_validate(asked)
        whole = estimate(spectra, K, 1.39 * diameter, processing)
        for rows in (slice(0, 1), slice(2, 5), slice(5, 9)):
            some = estimate(spectra[rows], K, 1.39 * diameter[rows], processing)
            assert np.array_equal(some.phase, whole.phase[rows], equal_nan=True)
            assert np.array_equal(some.depth, whole.depth[rows], equal_nan=True)


def test_likelihood_of_a_spectrum_does_not_depend_on_its_neighbours() -> None:
    known = np.linspace(0.9, 1.6, 80)
    model = Model(known, 2 + np.cos(2 * 1.39 * np.outer(known, K)))
    counts = np.random.default_rng(3).poisson(50 * model.intensity[10:70:7]).astype(float)
    counts *= np.linspace(1, 9, len(counts))[:, np.newaxis]
    for read_noise in (0.0, 4.0):
        whole = maximum_likelihood(counts, model, read_noise)
        one = [maximum_likelihood(row[np.newaxis], model, read_noise)[0] for row in counts]
        assert one == whole.tolist()


def test_a_sweep_has_no_common_envelope() -> None:
    common = {"estimator": "sinusoid", "sinusoid": {"envelope": "common"}}
    with pytest.raises(octsim.ConfigError, match="a sweep needs 'each'"):
        octsim.load_config({"processing": common})


@pytest.mark.parametrize("name", ["fft", "sinusoid", "esprit", "maximum_likelihood"])
def test_where_there_is_no_focus_there_is_no_phase(name: str) -> None:
    config = octsim.load_config({"processing": {"estimator": name}})
    found = estimator_of(config, np.full(151, np.nan))(np.full((3, 1000), np.nan), np.ones(3))
    assert np.isnan(found).all()


@pytest.mark.parametrize("estimator", [*ESTIMATORS, "maximum_likelihood"])
def test_the_ideal_slope_is_near_the_prediction(estimator: str) -> None:
    config = octsim.load_config({"processing": {"estimator": estimator}})
    k, n_neuron = config.spectrum.wavenumbers(), config.scene.refractive_index.neuron
    diameter = config.sweep.diameters.values()
    phase = ideal_phases(config, ideal_spectra(n_neuron, diameter, k), diameter, k)
    off_it = slope_of(diameter, phase) - predicted_phase_slope(n_neuron, k[0], k[-1])
    assert np.abs(off_it).max() < 2  # the image's oscillation, where it is not kept apart


def test_the_held_component_is_the_strongest_of_all_spectra_together() -> None:
    spectra = ideal_spectra(1.39, np.array([1.1, 1.9, 1.9]), K)
    components = fourier_components(spectra, Config().processing)
    strongest = np.abs(components[:, 1:]).argmax(axis=1) + 1
    assert strongest[0] != strongest[1] == strongest[2]
    found = series_phases(spectra, K, 1.9 * 1.39, Config().processing)
    assert found == pytest.approx(np.angle(components[:, strongest[1]]))
