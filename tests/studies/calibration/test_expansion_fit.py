"""Changes of several quantities from phases in bands: closed forms, coverage, what is refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from missing import unexplained
from numpy.typing import NDArray

from octsim.base.errors import ConfigError, DatasetError, OctsimWarning
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.datasets.files import read, write
from octsim.figures.expansion import expansion_figure
from octsim.figures.style import look, save
from octsim.phase.measured_series import Series
from octsim.studies.calibration.expansion import doubts, expansion_of_series, summary
from octsim.studies.calibration.expansion_fit import (
    LARGEST,
    Matrix,
    fitted_changes,
    matrix_at,
    series_fit,
)
from octsim.studies.calibration.expansion_record import series_in
from octsim.studies.calibration.missing import SampleStatus
from octsim.studies.responses.separability import Separability

Array = NDArray[np.float64]
BANDS = [["650 nm", "760 nm"], ["760 nm", "900 nm"]]
RESPONSE = np.array([[23.0, 8.0], [20.0, 21.0]])
"""Of each band (rows) to diameter and gap, mrad/nm."""
SHIFT = np.array([[[0.4, 0.0], [0.3, 0.1]], [[0.0, 0.5], [-0.2, 0.0]]])


def asked(**overlay: Any) -> Config:
    return load_config({"expansion": {"fit": ["diameter", "gap"], "bands": BANDS} | overlay})


def responses_of(response: Array = RESPONSE) -> xr.Dataset:
    """Give responses that are the same at all diameters, of a matrix (B, Q)."""
    diameter, count = np.array([1.3, 1.4, 1.5]), response.shape[1]
    place = ("variant", "diameter", "observable", "quantity")
    every = np.broadcast_to(response, (1, 3, *response.shape))
    shift = np.zeros((3, 1, 2, *response.shape))
    shift[:] = SHIFT[:, :, :count] if count < 3 else 0.0
    return xr.Dataset(
        {
            "phase_response": (place, every),
            "phase_response_standard_error": (place, 0.01 * every),
            "phase_response_difference_error": (place, 0.0 * every),
            "phase_response_shift": (
                ("diameter", "parameter", "side", "observable", "quantity"), shift
            ),
            "quantity_unit": ("quantity", ["nm", "nm", "1e-3"][:count]),
            "band_min": ("band", [0.65, 0.76]),
            "band_max": ("band", [0.76, 0.9]),
        },
        {
            "variant": ["configured"], "diameter": diameter, "parameter": ["gap"],
            "observable": ["band_1", "band_2"], "quantity": ["diameter", "gap", "index"][:count],
        },
    )  # fmt: skip


TIME = 1e-3 * np.arange(40, dtype=np.float64)
CHANGE = np.stack([0.5 * (np.arange(40) >= 20), -0.3 * (np.arange(40) >= 20)], axis=1)


def series_with(noise: float, seed: int = 1, response: Array = RESPONSE) -> tuple[Series, ...]:
    """Give phases of `CHANGE` with noise of some size, rad."""
    generator = np.random.default_rng(seed)
    phase = 1e-3 * CHANGE @ response.T
    phase += generator.normal(0, noise, phase.shape)
    error = np.full(TIME.size, noise)
    return tuple(Series(TIME, column, error) for column in phase.T)


def test_phases_without_noise_give_the_changes_that_they_are_of() -> None:
    found = series_fit(asked(), series_with(1e-12), responses_of())
    assert found["change"].values == pytest.approx(CHANGE, abs=1e-6)
    assert found["expansion"].values == pytest.approx(CHANGE[:, 0], abs=1e-6)
    assert (found["separability"] == Separability.SEPARABLE).all()
    # of the rest the changes are none, and so is what the responses make of them
    assert found["change_systematic_error"].values[:20] == pytest.approx(0.0, abs=1e-6)


def test_one_phase_and_the_diameter_alone_is_the_phase_over_its_response() -> None:
    config = asked(fit=["diameter"], bands=BANDS[:1])
    table = responses_of().isel(observable=[0], band=[0])
    found = series_fit(config, series_with(1e-12)[:1], table)
    alone = CHANGE @ RESPONSE[0] / RESPONSE[0, 0]
    assert found["expansion"].values == pytest.approx(alone, abs=1e-6)
    # the gap's shift is of no response that is fitted
    expected = np.hypot(*SHIFT[:, 0, 0]) / RESPONSE[0, 0] * np.abs(alone)
    assert found["systematic_error"].values == pytest.approx(expected, abs=1e-6)


def test_stated_errors_of_noise_are_covered_as_one_sigma_should() -> None:
    noise, off, stated = 2e-3, [], []
    for seed in range(40):
        found = series_fit(asked(), series_with(noise, seed), responses_of())
        off.append(found["change"].values[20:] - CHANGE[20:])
        stated.append(found["change_statistical_error"].values[20:])
    scatter = np.array(off).std(axis=(0, 1))
    assert np.sqrt((np.array(stated) ** 2).mean(axis=(0, 1))) == pytest.approx(scatter, rel=0.1)
    covariance = found["statistical_covariance"].values[-1]
    both = np.array(off).reshape(-1, 2).T
    correlation = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    assert correlation == pytest.approx(np.corrcoef(both)[0, 1], abs=0.05)
    assert np.mean(np.abs(off) <= np.array(stated)) == pytest.approx(0.683, abs=0.04)


def test_the_systematic_covariance_is_that_of_drawn_responses() -> None:
    truth, generator, found = np.array([0.5, -0.3]), np.random.default_rng(1), []
    matrix = Matrix(RESPONSE, SHIFT)
    for _ in range(4000):
        drawn = RESPONSE + np.tensordot(generator.normal(size=2), SHIFT, 1)
        phase = 1e-3 * (drawn @ truth)[np.newaxis]
        found.append(fitted_changes(matrix, phase, np.full((1, 2), 1e-3)).change[0])
    stated = fitted_changes(matrix, 1e-3 * (RESPONSE @ truth)[np.newaxis], np.full((1, 2), 1e-3))
    assert stated.systematic[0] == pytest.approx(np.cov(np.array(found).T), rel=0.1, abs=1e-6)
    assert np.mean(found, axis=0) == pytest.approx(truth, abs=1e-3)


def test_more_phases_than_quantities_say_if_something_else_moved() -> None:
    matrix = Matrix(RESPONSE[:, :1], np.zeros((1, 2, 1)))
    error = np.full((200, 2), 1e-3)
    phase = 1e-3 * np.random.default_rng(2).normal(size=(200, 2))
    assert fitted_changes(matrix, phase, error).chi_square.mean() == pytest.approx(1, abs=0.3)
    config = asked(fit=["diameter"])
    with pytest.warns(OctsimWarning, match="something else has changed too"):
        series_fit(config, series_with(1e-3), responses_of())


def test_responses_that_are_too_alike_are_named_with_their_remedy() -> None:
    alike = np.array([[23.0, 20.0], [20.0, 17.5]])
    with pytest.warns(OctsimWarning) as said:
        found = series_fit(asked(), series_with(1e-5, 1, alike), responses_of(alike))
    assert (found["separability"] == Separability.NOT_SEPARABLE).all()
    (line,) = (str(one.message) for one in said if "alike" in str(one.message))
    assert line.startswith("diameter, gap not_separable: responses are too alike in these bands")
    assert "fit fewer quantities" in line
    assert "\n" not in line
    with pytest.raises(DatasetError, match=r"of gap \(not_separable\) at .*; fit fewer quantities"):
        series_fit(asked(), series_with(1e-5), responses_of(alike))


@pytest.mark.parametrize(
    ("overlay", "said"),
    [
        ({"fit": ["diameter", "gap"], "bands": BANDS[:1]},
         "expansion.fit: 2 quantities given, but phases in 1 bands can't tell them apart; give 2"),
        ({"fit": ["diameter", "gap"]}, "expansion.fit: 2 quantities given, but phases in 0 bands"),
        ({"fit": ["gap"]}, "expansion.fit: [gap] given; it should have diameter"),
        ({"fit": ["diameter", "gapp"]}, "expansion.fit.1: 'gapp' given; it should be diameter,"),
        ({"fit": ["diameter", "thickness"], "bands": BANDS},
         "expansion.fit: thickness given, but the neuron has 0 shells"),
        ({"bands": [["600 nm", "760 nm"]]}, "expansion.bands.0: 0.6 um to 0.76 um given, which is"),
        ({"bands": [["760 nm", "650 nm"]]}, "the first wavelength should be below the second"),
        ({"bands": [["700 nm", "800 nm"], ["650 nm", "710 nm"]]},
         "expansion.bands.0: 0.7 um to 0.8 um given, which overlaps expansion.bands.1"),
    ],
)  # fmt: skip
def test_what_can_not_be_fitted_is_refused_in_a_line(overlay: dict[str, Any], said: str) -> None:
    with pytest.raises(ConfigError) as refused:
        load_config({"expansion": overlay})
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_responses_of_other_bands_or_diameters_are_refused() -> None:
    for config in (
        asked(diameter="1.45 um"),
        asked(bands=[["650 nm", "750 nm"], ["760 nm", "900 nm"]]),
    ):
        with pytest.raises(DatasetError, match="run the stage responses again"):
            matrix_at(config, responses_of())
    large = tuple(one._replace(phase=100 * one.phase) for one in series_with(1e-6))
    with pytest.raises(DatasetError, match=f"more than the {LARGEST:g} nm, or 1e-3"):
        series_fit(asked(), large, responses_of())


def test_a_missing_or_outlying_phase_of_a_band_is_a_missing_change() -> None:
    first, second = series_with(1e-4)
    phase = first.phase.copy()
    phase[30], phase[35] = np.nan, 0.5
    config = asked(outliers="drop")
    found = series_fit(config, (first._replace(phase=phase), second), responses_of())
    assert np.isnan(found["change"].values[:, 0]).nonzero()[0].tolist() == [30, 35]
    assert found["outlier"].values.nonzero()[0].tolist() == [35]
    assert any(line.startswith("phase_1: outliers") for line in doubts(found))
    codes = found["sample_status"].values
    assert codes[30].tolist() == [SampleStatus.MISSING, SampleStatus.USED]
    assert codes[35].tolist() == [SampleStatus.LEFT_OUT, SampleStatus.USED]
    assert found["reduced_chi_square"].isnull().all()
    assert list(unexplained(found)) == []


def test_a_series_of_bands_is_a_dataset_that_can_be_made_again(tmp_path: Path) -> None:
    columns = series_with(1e-3)
    table = np.column_stack([TIME * 1e3, *(1e3 * one.phase for one in columns)])
    heading = "time (ms),phase_1 (mrad),phase_2 (mrad)"
    file = tmp_path / "s.csv"
    np.savetxt(file, table, delimiter=",", header=heading, comments="", fmt="%.17g")
    config = asked(series=str(file))
    found = expansion_of_series(config, None, responses_of())
    write(found, tmp_path / "expansion.nc")
    stored = read(tmp_path / "expansion.nc", "expansion", config)
    write(series_in(stored), tmp_path / "s.nc")
    again = expansion_of_series(asked(series=str(tmp_path / "s.nc")), None, responses_of())
    assert again["change"].equals(found["change"])
    assert "gap -0.3" in summary(stored)
    with look():
        save(expansion_figure(stored), tmp_path / "expansion.png")
    assert (tmp_path / "expansion.png").stat().st_size > 10_000
