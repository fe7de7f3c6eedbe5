"""Responses: against the calibration, other steps, the chain rule, bounds and noisy spectra."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from made_runs import CALIBRATED, as_calibrated
from missing import unexplained
from numpy.typing import NDArray

from octsim.config.derive import calibrating, changed
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.config.units import format_length
from octsim.datasets.files import read, write
from octsim.figures.responses import responses_figure
from octsim.figures.style import look, save
from octsim.instrument.instrument import Instrument
from octsim.phase.cramer_rao import diameter_bound
from octsim.phase.derivatives import wrapped
from octsim.phase.estimators.changes import likeliest_changes
from octsim.phase.estimators.series import series_phases
from octsim.phase.measured_series import Series
from octsim.studies.calibration.expansion_fit import series_fit
from octsim.studies.calibration.scheme import converged
from octsim.studies.responses.observables import bands_of, observer_of
from octsim.studies.responses.quantities import (
    CONFIGURED,
    WITH_MEMBRANE,
    quantities_of,
    variants_of,
)
from octsim.studies.responses.separability import (
    MOST_GROWTH,
    Separability,
    covariance_of,
    errors_of,
    told_apart,
    without_nuisance,
)
from octsim.studies.responses.study import diameters_of, responses
from octsim.studies.responses.told import doubts, summary

Array = NDArray[np.float64]
DIAMETER, FOCUS = 1.4, 0.58 * 1.4 + 0.066
FEW: dict[str, Any] = {
    **CALIBRATED,
    "responses": {"diameters": {"start": "1.4 um", "stop": "1.5 um", "num": 2}},
}


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    """Give the responses of the thesis's neuron at two diameters, as they are read from a file."""
    file = tmp_path_factory.mktemp("responses") / "responses.nc"
    config = load_config(FEW)
    with as_calibrated():
        write(responses(config, None, 2), file)
    return read(file, "responses", config)


@pytest.fixture(scope="module")
def thick(table: xr.Dataset) -> xr.Dataset:
    return table.sel(diameter=DIAMETER, method="nearest")


@pytest.fixture(scope="module")
def bare() -> Config:
    with as_calibrated():
        return converged(load_config(FEW))


def spectrum_of(config: Config, diameter: float = DIAMETER, **overlay: Any) -> Array:
    other = changed(config, overlay) if overlay else config
    return Instrument(other).spectrum(diameter, FOCUS).intensity


def phase_of(config: Config, diameter: float = DIAMETER, **overlay: Any) -> float:
    spectrum, k = spectrum_of(config, diameter, **overlay), config.spectrum.wavenumbers()
    depth = config.swept_group_index * DIAMETER
    return float(series_phases(spectrum[np.newaxis], k, depth, calibrating(config))[0])


def difference(phase: Callable[[float], float], step: float) -> float:
    """Return a derivative, rad per µm or index, by another step and rule than the study's."""
    return float(wrapped(np.array(phase(step) - phase(-step)))) / (2 * step)


def test_the_response_to_the_diameter_is_the_calibrations_slope(
    thick: xr.Dataset, calibrated: xr.Dataset
) -> None:
    own = calibrated.sel(diameter=DIAMETER, method="nearest")
    one = thick.sel(variant=CONFIGURED, quantity="diameter")
    whole = one.sel(observable="whole")
    slope = float(own["fixed_focus_phase_slope"])
    assert float(whole["phase_response"]) == pytest.approx(slope, rel=1e-6)
    for side in ("near_side", "far_side"):
        of_side = float(one["phase_response"].sel(observable=side))
        assert of_side == pytest.approx(float(own[f"{side}_phase_slope"]), rel=1e-4)
    # three nodes for five, without the interpolation between diameters
    stated = float(whole["phase_response_standard_error"])
    error = float(own["fixed_focus_phase_slope_standard_error"])
    assert stated == pytest.approx(error, rel=0.2)
    for name in ("gap", "neuron", "focus", "numerical_aperture"):
        shift = thick["phase_response_shift"].sel(
            parameter=name, observable="whole", quantity="diameter"
        )
        budget = float(own["budget"].sel(parameter=name))
        assert float(np.sqrt((shift**2).sum())) == pytest.approx(budget, rel=0.02), name


def test_responses_are_those_of_larger_steps(thick: xr.Dataset, bare: Config) -> None:
    found = thick["phase_response"].sel(variant=CONFIGURED, observable="whole")
    gap = difference(lambda by: phase_of(bare, scene={"gap": f"{0.005 + by!r} um"}), 1e-3)
    index = difference(
        lambda by: phase_of(bare, scene={"refractive_index": {"neuron": 1.39 + by}}), 1e-3
    )
    assert float(found.sel(quantity="gap")) == pytest.approx(gap, rel=5e-3)
    assert float(found.sel(quantity="index")) == pytest.approx(index, rel=5e-3)
    assert np.isnan(found.sel(quantity="thickness"))


def test_a_membrane_that_grows_outwards_is_thickness_and_twice_that_of_diameter(
    thick: xr.Dataset, bare: Config
) -> None:
    other = variants_of(bare)[WITH_MEMBRANE]
    found = thick["phase_response"].sel(variant=WITH_MEMBRANE, observable="whole")

    def phase(by: float) -> float:
        shells = {"0": {"thickness": f"{0.005 + by!r} um"}}
        return phase_of(other, DIAMETER + 2 * by, scene={"cylinders": {"0": {"shells": shells}}})

    chained = float(found.sel(quantity="thickness")) + 2 * float(found.sel(quantity="diameter"))
    assert chained == pytest.approx(difference(phase, 3e-4), rel=2e-3)


def test_apparent_expansions_are_what_another_quantity_looks_like(
    thick: xr.Dataset, bare: Config
) -> None:
    apparent = float(
        thick["apparent_expansion"].sel(variant=CONFIGURED, observable="whole", quantity="gap")
    )
    # a gap of 1 nm more less that expansion is no phase, but for the bend over them
    left = phase_of(bare, DIAMETER - 1e-3 * apparent, scene={"gap": "6 nm"}) - phase_of(bare)
    slope = float(
        thick["phase_response"].sel(variant=CONFIGURED, observable="whole", quantity="gap")
    )
    assert abs(1e3 * left) < 0.02 * slope
    # and of the spectrum's shape the likeliest diameter is such
    k = bare.spectrum.wavenumbers()
    one = thick.sel(variant=CONFIGURED)
    counts = spectrum_of(bare, scene={"gap": "5.1 nm"})[np.newaxis]
    counts = counts * 1e8 / counts.sum()
    fitted = likeliest_changes(
        counts, one["intensity"].values, one["intensity_response"].values[:1]
    )
    stated = float(one["apparent_expansion_of_shape"].sel(quantity="gap"))
    assert fitted.value[0, 0] / 0.1 == pytest.approx(stated, rel=0.03)
    assert k.size == counts.size


def test_errors_are_cramer_and_raos(thick: xr.Dataset) -> None:
    one = thick.sel(variant=CONFIGURED)
    rest, shape = one["intensity"].values, one["intensity_response"].values[:3]
    photons = float(one["photons"])
    alone = one["error_alone"].sel(source="spectrum").values
    bounds = [diameter_bound(rest, response, photons) for response in shape]
    assert alone[:3] == pytest.approx(bounds, rel=1e-9)
    scaled = np.concatenate([shape * photons / rest.sum(), [rest * photons / rest.sum()]])
    whole = np.linalg.inv((scaled / scaled[-1]) @ scaled.T)
    together = one["error_together"].sel(source="spectrum").values
    assert together[:3] == pytest.approx(np.sqrt(np.diag(whole)[:3]), rel=1e-6)
    correlation = one["error_correlation"].sel(source="spectrum").values
    assert correlation[0, 1] == pytest.approx(
        whole[0, 1] / np.sqrt(whole[0, 0] * whole[1, 1]), abs=1e-6
    )
    status = one["separability"].sel(source="spectrum").values
    expected = np.where(together > MOST_GROWTH * alone, 1, 0)
    assert status[:3].tolist() == expected[:3].tolist()
    assert status[3] == Separability.ABSENT
    assert (one["separability"].sel(source="bands").values[:3] == Separability.TOO_FEW).all()


def test_changes_that_are_fitted_to_noisy_spectra_are_unbiased_and_covered(
    thick: xr.Dataset, bare: Config
) -> None:
    """Maxwell's spectra of a neuron whose diameter and gap have changed, not straight ones."""
    one = thick.sel(variant=CONFIGURED)
    rest, shape = one["intensity"].values, one["intensity_response"].values[:2]
    scale, generator = 1e8 / rest.sum(), np.random.default_rng(5)
    expected = one["error_with_other"].sel(source="spectrum").values
    bent = []
    for size in (0.05, 0.1, 0.2):
        truth = size * np.array([1.0, 0.5])
        gap = {"gap": f"{0.005 + 5e-4 * size!r} um"}
        spectrum = scale * spectrum_of(bare, DIAMETER + 1e-3 * size, scene=gap)
        # without noise: as far as the spectrum bends over the change, which is squared
        bend = likeliest_changes(spectrum[np.newaxis], rest, shape).value[0] - truth
        bent.append(np.linalg.norm(bend))
        counts = generator.poisson(spectrum, (1000, rest.size)).astype(float)
        found = likeliest_changes(counts, rest, shape)
        stated = np.sqrt(np.diagonal(found.covariance, axis1=1, axis2=2))
        off = found.value - truth
        assert stated.mean(axis=0) == pytest.approx([expected[0, 1], expected[1, 0]], rel=0.02)
        assert off.std(axis=0) == pytest.approx(stated.mean(axis=0), rel=0.07)
        noise = stated.mean(axis=0) / np.sqrt(1000)
        assert (np.abs(off.mean(axis=0) - bend) < 4 * noise).all()
        if size < 0.1:
            assert (np.abs(off.mean(axis=0)) < 4 * noise).all()
        covered = (np.abs(off) <= stated).mean(axis=0)
        assert covered == pytest.approx([0.683, 0.683], abs=0.05)
    assert bent[1] / bent[0] == pytest.approx(4, rel=0.1)
    assert bent[2] / bent[1] == pytest.approx(4, rel=0.1)


def test_the_noise_of_phases_is_that_of_other_draws(thick: xr.Dataset, bare: Config) -> None:
    rest, k = thick["intensity"].sel(variant=CONFIGURED).values, bare.spectrum.wavenumbers()
    counts = np.random.default_rng(9).poisson(1e8 * rest / rest.sum(), (1500, rest.size))
    depth = bare.swept_group_index * DIAMETER
    phases = series_phases(counts.astype(float), k, depth, calibrating(bare))
    stated = thick["phase_noise_covariance"].sel(variant=CONFIGURED, observable="whole")
    assert 1e3 * phases.std() == pytest.approx(np.sqrt(float(stated[0])), rel=0.1)


def test_two_that_do_the_same_are_not_told_apart() -> None:
    moved = np.array([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0]])
    errors = errors_of(moved @ moved.T)
    assert np.isinf(errors.together).all()
    assert np.isinf(errors.pair[0, 1])
    assert (
        told_apart(errors.together, errors.alone, 3, 2).tolist() == [Separability.NOT_SEPARABLE] * 2
    )
    assert told_apart(errors.together, errors.alone, 1, 2).tolist() == [Separability.TOO_FEW] * 2
    apart = np.array([[1.0, 0.0, 1.0], [0.0, 1.0, -1.0]])
    errors = errors_of(apart @ apart.T)
    assert errors.together == pytest.approx(np.sqrt(np.diag(np.linalg.inv(apart @ apart.T))))
    assert told_apart(errors.together, errors.alone, 3, 2).tolist() == [Separability.SEPARABLE] * 2
    assert all(one.remedy for one in Separability if one != Separability.SEPARABLE)


def test_a_nuisance_leaves_what_its_inverse_has() -> None:
    root = np.random.default_rng(3).normal(size=(4, 9))
    whole = root @ root.T
    left = without_nuisance(whole)
    assert np.linalg.inv(left) == pytest.approx(np.linalg.inv(whole)[:3, :3])
    assert covariance_of(left) == pytest.approx(np.linalg.inv(left))


def test_quantities_are_of_the_shells_that_are_there(bare: Config) -> None:
    assert [one.name for one in quantities_of(bare)] == ["diameter", "gap", "index"]
    shells = [{"medium": "water", "thickness": "5 nm"}, {"medium": "glass", "thickness": "9 nm"}]
    own = changed(bare, {"scene": {"cylinders": [{"medium": "neuron", "shells": shells}]}})
    names = [one.name for one in quantities_of(own)]
    assert names == ["diameter", "gap", "index", "thickness", "thickness_2"]
    assert list(variants_of(own)) == [CONFIGURED]
    assert list(variants_of(bare)) == [CONFIGURED, WITH_MEMBRANE]


def test_responses_are_of_the_expansions_diameter_too() -> None:
    assert diameters_of(load_config()).size == 11
    other = diameters_of(load_config({"expansion": {"diameter": "1.456 um"}}))
    assert other.size == 12
    assert 1.456 in other
    assert (np.diff(other) > 0).all()


def test_what_responses_say_and_draw(table: xr.Dataset, tmp_path: Path) -> None:
    said = summary(table)
    assert said.startswith("at 1.4 um, with a membrane, focus held, the phase moves by diameter +2")
    assert "mrad/1e-3" in said
    assert not doubts(table)
    with look():
        save(responses_figure(table), tmp_path / "responses.png")
    assert (tmp_path / "responses.png").stat().st_size > 10_000


@pytest.mark.parametrize("size", [0.2, 0.05])
def test_phases_of_bands_come_back_to_what_changed(
    table: xr.Dataset, bare: Config, size: float
) -> None:
    """Maxwell's spectra of a neuron that swells and lifts off, without noise."""
    halves = bands_of(bare)
    bands = [[format_length(edge) for edge in band] for band in halves]
    config = load_config(FEW, {"expansion": {"fit": ["diameter", "gap"], "bands": bands}})
    gap = {"gap": f"{0.005 + 5e-4 * size!r} um"}
    rest, moved = spectrum_of(bare), spectrum_of(bare, DIAMETER + 1e-3 * size, scene=gap)
    observer = observer_of(bare, rest, bare.swept_group_index * DIAMETER)
    before, after = observer.phases(np.stack([rest, moved]))[:, 1:3]
    count = 20
    steps = np.concatenate([np.zeros((count, 2)), np.broadcast_to(after - before, (2, 2))])
    error = np.full(count + 2, 1e-6)
    series = [Series(np.arange(count + 2.0), steps[:, band], error) for band in range(2)]
    found = series_fit(config, series, table)
    # as far as responses are straight
    truth = size * np.array([1.0, 0.5])
    assert found["change"].values[-1] == pytest.approx(truth, abs=0.5 * size**2)
    assert (found["change"].values[:count] == 0).all()
    assert np.isfinite(found["change_systematic_error"]).all()


def test_a_status_says_why_a_number_is_missing(table: xr.Dataset) -> None:
    assert list(unexplained(table)) == []
