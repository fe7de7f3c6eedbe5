"""A spectrum of a known neuron: the model that fits it is that neuron, as far as noise tells."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

from octsim.base.errors import ConfigError
from octsim.config.derive import changed
from octsim.config.load import load_config
from octsim.config.maxwell import by_maxwell
from octsim.config.models import Config
from octsim.datasets.files import flags
from octsim.figures.match import match_figure
from octsim.figures.style import look
from octsim.instrument.instrument import Instrument
from octsim.studies.calibration.missing import SystematicStatus
from octsim.studies.match.fit import PARAMETERS, Match, Observed, match
from octsim.studies.match.study import _slope, doubts, match_of_spectra, summary
from octsim.studies.responses.separability import Separability

CONFIG = load_config({
    "tracing": {"scheme": "fullwave", "accuracy": 1e-3},
    "spectrum": {"samples": 100},
    "sweep": {"focus": {"slope": 0.581, "intercept": "69 nm"}},
})  # fmt: skip
DIAMETER, FOCUS = 1.4, 0.8824
PHOTONS = 1e9


def observed(config: Config, diameter: float, focus: float, seed: int = 1) -> Observed:
    instrument = Instrument(by_maxwell(config, 1e-5))
    k = instrument.wavenumber
    source = np.exp(-(((k - 8.3) / 1.2) ** 2))
    light = instrument.spectrum(diameter, focus).intensity * source
    light *= PHOTONS / light.sum()
    counts = np.random.default_rng(seed).poisson(light).astype(float)
    return Observed(k, counts, source, np.sqrt(light))


def other(**scene: Any) -> Config:
    return changed(CONFIG, {"scene": scene})


@pytest.fixture(scope="module")
def found() -> Any:
    truth = other(gap="9 nm", refractive_index={"neuron": 1.392})
    return match(by_maxwell(CONFIG, 1e-4), observed(truth, 1.43, 0.895), DIAMETER, FOCUS)


def test_what_fits_best_is_the_neuron_that_it_is(found: Any) -> None:
    true = dict(zip(PARAMETERS, (0.03, 0.004, 0.895 - FOCUS, 0.0, 0.002), strict=True))
    error = np.sqrt(np.diag(found.covariance))
    for place, (name, value) in enumerate(true.items()):
        assert abs(found.change[place] - value) < 4 * error[place] + 1e-5, name
    assert error[0] < 5e-3


def test_its_chi_square_is_that_of_noise_and_the_config_s_is_not(found: Any) -> None:
    freedom = 100 - len(PARAMETERS) - 1
    assert found.chi_square / freedom == pytest.approx(1, abs=0.5)
    assert found.configured_chi_square > 100 * found.chi_square


def test_noise_that_is_not_all_that_is_left_is_told() -> None:
    statistics: dict[str, Any] = {
        "configured_chi_square": 900.0, "degrees_of_freedom": 44,
        "matched_phase_slope": 22.0, "matched_phase_slope_standard_error": 0.1,
    }  # fmt: skip
    told = summary(dataset(misfit=0.01).assign(chi_square=440.0, **statistics))
    assert "freedom 10 (the fit leaves 0.01 of the spectrum; errors are widened)" in told
    assert "widened" not in summary(dataset().assign(chi_square=44.0, **statistics))


def dataset(**changes: float) -> xr.Dataset:
    names = list(PARAMETERS)
    believed = np.array([1.4, 0.005, 0.88, 1.0, 1.39])
    matched = believed + [changes.get(name, 0.0) for name in names]
    k = np.linspace(7, 9.6, 50)
    told = np.full(5, Separability.SEPARABLE)
    told[names.index("gap")] = Separability.NOT_SEPARABLE
    return xr.Dataset(
        {
            "match_status": ("parameter", *flags(Separability, told)),
            "believed": ("parameter", believed), "matched": ("parameter", matched),
            "matched_error": ("parameter", np.full(5, 1e-4)),
            "match_tolerance": ("parameter", np.array([0.02, 0.002, 0.01, 0.05, 0.002])),
            "misfit": changes.get("misfit", 0.0), "configured_misfit": 0.1,
            "source_difference": changes.get("source", 0.0),
            "measured_spectrum": ("wavenumber", 100 + k),
            "measured_spectrum_error": ("wavenumber", 0 * k + 1),
            "modelled_spectrum": ("wavenumber", 101 + k),
            "matched_spectrum": ("wavenumber", 100 + k),
        },
        {"parameter": names, "wavenumber": k, "wavelength": ("wavenumber", 2 * np.pi / k)},
        {"config": '{"run": "thesis"}'},
    )  # fmt: skip


def test_a_neuron_that_is_another_is_said() -> None:
    assert not list(doubts(dataset()))
    assert "neuron fits best at 1.4, +0.01" in next(doubts(dataset(neuron=0.01)))
    assert "no neuron of this scene" in next(doubts(dataset(misfit=0.2)))
    assert "the calibration is of another one" in next(doubts(dataset(source=0.2)))


def test_it_is_drawn_beside_what_is_believed() -> None:
    with look():
        figure = match_figure(dataset(neuron=0.001))
    labels = [one.get_text() for one in figure.axes[2].get_yticklabels()]
    assert labels == list(PARAMETERS)
    said = figure.axes[2].get_legend_handles_labels()[1]
    assert "doubtful: not separable" in said


def test_a_scene_that_maxwell_is_not_solved_for_is_refused() -> None:
    steep = load_config({"objective": {"numerical_aperture": 1.4}})
    with pytest.raises(ConfigError, match="match: spectra are compared with Maxwell"):
        match_of_spectra(steep, xr.Dataset(), xr.Dataset())


def calibrated(focus_rate: float = 0.0) -> xr.Dataset:
    """Return a calibration whose slope falls by 0.02 mrad/nm for each nm of diameter."""
    diameter = np.linspace(1.0, 2.0, 11)
    names = list(PARAMETERS)
    rates = {"diameter": -0.02, "gap": 0.0, "focus": focus_rate, "fill": 0.0, "neuron": 0.0}
    return xr.Dataset(
        {
            "fixed_focus_phase_slope": ("diameter", 22 - 20 * (diameter - 1.4)),
            "phase_curvature": ("diameter", 0 * diameter),
            "fixed_focus_phase_slope_standard_error": ("diameter", 0 * diameter + 0.5),
            "budget": (("diameter", "parameter"), np.full((11, 5), 0.1)),
            **{f"{name}_sensitivity": ("diameter", 0 * diameter + rates[name]) for name in names},
        },
        {"diameter": diameter, "parameter": names},
    )


@pytest.mark.parametrize("focus_rate", [0.0, 0.03])
def test_the_slope_of_another_diameter_is_the_calibration_s_there(focus_rate: float) -> None:
    tolerance = np.array([0.02, 0.002, 0.01, 0.05, 0.002])
    # 10 nm larger, with the focus where the law has it then
    change = np.array([0.01, 0, 0.581 * 0.01, 0, 0])
    sure = Match(change, np.diag((1e-3 * tolerance) ** 2), change, change, 0.0, 0.0)
    found = _slope(calibrated(focus_rate), 1.4, 0.581, sure, tolerance)
    assert found["matched_phase_slope"] == pytest.approx(22 - 20 * 0.01, abs=2e-3)
    assert found["matched_phase_slope_standard_error"] < 0.01
    unsure = sure._replace(covariance=np.diag((1e3 * tolerance) ** 2))
    left = _slope(calibrated(focus_rate), 1.4, 0.581, unsure, tolerance)
    # a fit that tells nothing leaves what was believed
    assert left["matched_phase_slope"] == pytest.approx(22, abs=1e-3)
    off = 1e3 * 0.01 * np.hypot((-0.02 - 0.581 * focus_rate) * 2, focus_rate)
    assert left["matched_phase_slope_standard_error"] == pytest.approx(off, rel=0.01)


def test_a_calibration_s_error_that_is_not_known_is_told_by_a_status() -> None:
    table, tolerance = calibrated(), np.full(5, 0.01)
    fit = Match(np.zeros(5), np.diag(tolerance**2), np.zeros(5), np.zeros(5), 0.0, 0.0)
    nothing = np.nan * table["diameter"]
    rays = table.assign(fixed_focus_phase_slope_standard_error=nothing)
    found = _slope(rays, 1.4, 0.581, fit, tolerance)
    assert np.isnan(found["fixed_focus_phase_slope_standard_error"])
    assert found["systematic_status"][1] == SystematicStatus.NOT_KNOWN
    assert found["matched_systematic_status"][1] == SystematicStatus.KNOWN
