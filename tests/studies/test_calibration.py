"""The calibration: its slopes and their errors, against closed forms and other ways."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from made_runs import CALIBRATED, REACHED
from missing import unexplained
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from octsim.base.errors import ConfigError, DatasetError, OctsimError
from octsim.config.derive import by_rays, calibrating, changed
from octsim.config.load import load_config
from octsim.config.maxwell import by_maxwell
from octsim.config.models import Config
from octsim.datasets.files import read, write
from octsim.figures.calibration import calibration_figure
from octsim.figures.style import look, save
from octsim.instrument.instrument import Instrument, PointSpectrum
from octsim.optics.two_beams import ideal_spectra, predicted_phase_slope
from octsim.phase.derivatives import wrapped
from octsim.phase.estimators.series import series_phases
from octsim.schemes.light import AccuracyStatus
from octsim.studies.calibration import slopes
from octsim.studies.calibration.expansion import expansion
from octsim.studies.calibration.parameters import PARAMETERS, parameters_of
from octsim.studies.calibration.scheme import (
    ModelStatus,
    OtherSchemeStatus,
    SlopeErrorStatus,
    converged,
)
from octsim.studies.calibration.study import calibration, interpolation_error
from octsim.studies.calibration.told import doubts, summary
from octsim.studies.calibration.tolerances import moved

Array = NDArray[np.float64]
SAMPLED = {"spectrum": CALIBRATED["spectrum"]}
K = load_config(SAMPLED).spectrum.wavenumbers()
N = Config().scene.refractive_index.neuron
FITTED = calibrating(load_config(SAMPLED))


def test_the_fitted_sinusoid_of_plates_moves_as_predicted() -> None:
    diameters = 1.4 + 1e-3 * np.array([-1.0, 0.0, 1.0])
    phases = series_phases(1 + ideal_spectra(N, diameters, K), K, 1.4 * N, FITTED)
    # at its own frequency the fit is exact
    middle = (K[0] + K[-1]) / 2
    assert phases[1] == pytest.approx(np.angle(np.exp(2j * N * 1.4 * middle)), abs=1e-9)
    slope = wrapped(phases[2] - phases[0]) / 2e-3
    assert slope == pytest.approx(predicted_phase_slope(N, K[0], K[-1]), rel=1e-5)


def test_offsets_and_amplitudes_that_are_linear_in_k_move_no_fitted_phase() -> None:
    uneven = K + 0.05 * np.sin(np.linspace(0, np.pi, K.size))
    u, middle = uneven - uneven.mean(), (K[0] + K[-1]) / 2
    turn = 2 * N * 1.3 * (uneven - middle) + 0.7
    spectrum = 3 + 0.2 * u + (1 + 0.1 * u) * np.cos(turn)
    found = series_phases(spectrum[np.newaxis], uneven, 1.3 * N, FITTED)
    assert found == pytest.approx([0.7], abs=1e-9)


BEND, LEAN, LAW = 3.0, -2.0, 0.58
TABLE = np.linspace(1, 2, 8)


class Plates(Instrument):
    """An instrument of spectra whose phase is a formula.

    A cosine over the wavenumbers as they are believed to be, of the frequency that the estimator
    holds, with the phase 2nd k_m + BEND d² + LEAN z at the middle k_m of the band as it is.
    """

    def spectrum(self, diameter: float, focus: float) -> PointSpectrum:
        k, n = self.wavenumber, self.config.scene.refractive_index.neuron
        held = TABLE[np.abs(TABLE - diameter).argmin()]
        phase = n * diameter * (k[0] + k[-1]) + BEND * diameter**2 + LEAN * focus
        intensity = 2 + np.cos(2 * N * held * (K - (K[0] + K[-1]) / 2) + phase)
        return PointSpectrum(intensity, 1e-12, AccuracyStatus.REACHED)


def asked(**overlay: object) -> Config:
    law = {"sweep": {"focus": {"slope": LAW, "intercept": "66 nm"}}}
    return load_config(SAMPLED, law, {"calibration": overlay})


@pytest.mark.trial
@pytest.mark.parametrize("scheme", ["fullwave", "paths"])
def test_plates_have_the_slopes_and_sensitivities_of_their_formula(
    monkeypatch: pytest.MonkeyPatch, scheme: str
) -> None:
    monkeypatch.setattr(slopes, "Instrument", Plates)
    config = asked(diameters={"num": 8}, scheme=scheme)
    table = calibration(config)
    d, middle = table["diameter"].values, (K[0] + K[-1]) / 2
    held = 2 * N * middle + 2 * BEND * d
    assert table["fixed_focus_phase_slope"].values == pytest.approx(held, rel=1e-6)
    assert table["diameter_per_phase"].values == pytest.approx(1 / held, rel=1e-6)
    assert table["focus_phase_slope"].values == pytest.approx(LEAN, rel=1e-6)
    assert table["following_phase_slope"].values == pytest.approx(held + LAW * LEAN, rel=1e-6)
    assert table["phase_curvature"].values == pytest.approx(2 * BEND / 1e3, rel=1e-6)
    band = config.spectrum.wavelength
    expected = {
        "diameter": 2 * BEND / 1e3,
        "neuron": 2 * middle,
        "wavelength_min": -N * 2 * np.pi / band.min**2 / 1e3,
        "wavelength_max": -N * 2 * np.pi / band.max**2 / 1e3,
    }
    seen = parameters_of(converged(config))
    assert ("fill" in seen, "detector_radius" in seen) == (scheme == "fullwave", scheme == "paths")
    for name in seen:
        found = table[f"{name}_sensitivity"].values
        assert found == pytest.approx(expected.get(name, 0.0), rel=1e-6, abs=1e-7), name
    assert (table["budget_error"] < 1e-6).all()


def test_the_standard_error_is_the_budgets_quadrature(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(slopes, "Instrument", Plates)
    none = dict.fromkeys(("diameter", "gap", "focus", "detector_radius", "offset"), "0 nm")
    none |= {"wavelength_min": "0 nm", "wavelength_max": "0 nm", "polarisation": "0 deg"}
    zero = {"glass": 0.0, "water": 0.0, "numerical_aperture": 0.0, "fill": 0.0}
    only = asked(diameters={"num": 8}, tolerances={**none, **zero, "neuron": 2e-4})
    table = calibration(only)
    error = table["fixed_focus_phase_slope_standard_error"].values
    assert error == pytest.approx(2e-4 * (K[0] + K[-1]), rel=1e-6)
    both = calibration(
        asked(
            diameters={"num": 8}, tolerances={**none, **zero, "neuron": 2e-4, "diameter": "20 nm"}
        )
    )
    whole = both["fixed_focus_phase_slope_standard_error"].values
    assert whole == pytest.approx(np.hypot(error, 0.02 * 2 * BEND), rel=1e-6)


def test_a_number_of_the_scene_is_part_of_the_budget_by_its_dotted_key(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    class Turned(Plates):
        """Plates whose phase moves with the square of the diameter times the azimuth."""

        def spectrum(self, diameter: float, focus: float) -> PointSpectrum:
            azimuth = self.config.scene.cylinders[0].azimuth
            by = 5.0 * azimuth * diameter / N / (K[0] + K[-1])
            return super().spectrum(diameter + by, focus)

    monkeypatch.setattr(slopes, "Instrument", Turned)
    key, unseen = "scene.cylinders.0.azimuth", "scene.cylinders.0.elevation"
    table = calibration(asked(diameters={"num": 8}, tolerances={key: "2 deg", unseen: "1 deg"}))
    write(table, tmp_path / "calibration.nc")
    table = read(tmp_path / "calibration.nc", "calibration")
    assert key in table["parameter"].values
    sensitivity = table["scene_cylinders_0_azimuth_sensitivity"]
    assert sensitivity.attrs["units"] == "mrad/nm"
    # of φ = n (k + k') d' + BEND d'², d' = d (1 + s a): ∂²φ/∂d∂a = s (n (k + k') + 4 BEND d)
    share = 5.0 / N / (K[0] + K[-1])
    expected = share * (N * (K[0] + K[-1]) + 4 * BEND * table["diameter"].values)
    assert sensitivity.values == pytest.approx(expected, rel=1e-3)
    budget = table["budget"].sel(parameter=key)
    assert budget.values == pytest.approx(np.radians(2) * expected, rel=0.02)
    (doubt,) = (line for line in doubts(table) if "tolerances" in line)
    assert doubt.startswith(f"calibration.tolerances.{unseen} given, which the scheme")


def test_the_slopes_of_the_neuron_obey_the_chain_rule(calibrated: xr.Dataset) -> None:
    chained = (
        calibrated["fixed_focus_phase_slope"]
        + calibrated["focus_phase_slope"] * calibrated["slope"]
    )
    assert chained.values == pytest.approx(calibrated["following_phase_slope"].values, abs=1e-4)
    # not the same calibration
    ratio = calibrated["fixed_focus_phase_slope"] / calibrated["following_phase_slope"]
    assert float(np.abs(ratio - 1).max()) > 0.01
    assert (calibrated["difference_error"] < 1e-4).all()


@pytest.mark.parametrize(
    ("pupil", "mean", "scatter"),
    [({"gaussian": 0.5}, 22.17, 0.12), ({"gaussian": 1.0}, 21.68, 0.32),
     ({"fibre": "5 um"}, 21.84, 0.75)],
)  # fmt: skip
def test_slopes_at_a_held_focus_are_those_that_another_code_found(
    pupil: object, mean: float, scatter: float
) -> None:
    config = load_config(
        SAMPLED, {"objective": {"pupil": pupil}, "tracing": {"scheme": "fullwave"}}
    )
    # a hundred times as coarse as a calibration's, whose error both sides of such a step share
    own, step, found = Instrument(by_maxwell(config, 1e-4)), 1e-4, []
    for diameter in np.linspace(1, 2, 51).tolist():
        focus = 0.581 * diameter + 0.069
        pair = own.spectra((diameter - step, diameter + step), (focus, focus))
        before, after = series_phases(pair, K, N * diameter, FITTED)
        found.append(float(wrapped(after - before)) / (2 * step))
    # its digits, and what its interpolation over diameters, to 2e-3, leaves of them
    assert np.mean(found) == pytest.approx(mean, abs=0.02)
    assert np.std(found) == pytest.approx(scatter, abs=0.006)


def test_the_slope_is_what_the_two_sides_do_by_themselves(calibrated_by_rays: xr.Dataset) -> None:
    table = calibrated_by_rays
    apart = table["far_side_phase_slope"] - table["near_side_phase_slope"]
    assert apart.values == pytest.approx(table["fixed_focus_phase_slope"].values, rel=0.01)
    # the side that stays where it is moves its phase too, unlike that of a plate
    assert (table["near_side_phase_slope"] < -0.3).all()


def test_many_counted_rays_and_a_larger_step_give_the_same_slope(
    calibrated_by_rays: xr.Dataset,
) -> None:
    one = calibrated_by_rays.isel(diameter=3)
    diameter, focus, step = float(one["diameter"]), float(one["focus"]), 3e-3
    rays = Instrument(by_rays(load_config(SAMPLED), 200_000))
    spectra = rays.spectra((diameter - step, diameter + step), (focus, focus))
    u = K - K.mean()
    cos, sin = np.cos(2 * N * diameter * u), np.sin(2 * N * diameter * u)
    terms = np.stack((cos, sin, u * cos, u * sin, np.ones_like(u), u), axis=1)
    fitted = np.linalg.lstsq(terms, spectra.T, rcond=None)[0]
    before, after = np.arctan2(-fitted[1], fitted[0])
    slope = np.angle(np.exp(1j * (after - before))) / (2 * step)
    assert slope == pytest.approx(float(one["fixed_focus_phase_slope"]), abs=0.02)


@pytest.mark.parametrize(
    ("scheme", "name", "change"),
    [("fullwave", "gap", 1e-3), ("fullwave", "neuron", 1e-3), ("fullwave", "fill", 0.02),
     ("fullwave", "polarisation", 0.05), ("paths", "gap", 2e-3), ("paths", "neuron", 2e-3),
     ("paths", "detector_radius", 2e-3)],
)  # fmt: skip
def test_a_sensitivity_is_what_another_calibration_finds(
    request: pytest.FixtureRequest, scheme: str, name: str, change: float
) -> None:
    table = request.getfixturevalue({"fullwave": "calibrated"}.get(scheme, "calibrated_by_rays"))
    one = table.isel(diameter=2)
    diameter, focus = float(one["diameter"]), float(one["focus"])
    found = [slope_of(scheme, {name: by}, diameter, focus) for by in (-change, change)]
    stated = float(one[f"{name}_sensitivity"])
    stated *= 1e3 if PARAMETERS[name].unit == "um" else 1.0
    assert (found[1] - found[0]) / (2 * change) == pytest.approx(stated, rel=0.02)


def slope_of(scheme: str, changes: dict[str, float], diameter: float, focus: float) -> float:
    """Return the slope at a held focus with something of the instrument off."""
    other, step = moved(converged(asked(scheme=scheme)), changes, 0.0).config, 1e-3
    spectra = Instrument(other).spectra((diameter - step, diameter + step), (focus, focus))
    before, after = series_phases(spectra, K, N * diameter, FITTED)
    return float(wrapped(after - before)) / (2 * step)


def test_a_neuron_off_the_axis_counts_though_nothing_changes_at_first(
    calibrated: xr.Dataset,
) -> None:
    one = calibrated.isel(diameter=2)
    diameter, focus = float(one["diameter"]), float(one["focus"])
    assert abs(float(one["offset_sensitivity"])) < 1e-6
    nodes = np.linspace(-4, 4, 33)
    weight = np.exp(-(nodes**2) / 2)
    slopes_off = np.array([
        slope_of("fullwave", {"offset": 0.05 * node}, diameter, focus)
        for node in np.abs(nodes[:17]).tolist()
    ])  # fmt: skip
    change = np.concatenate([slopes_off, slopes_off[-2::-1]]) - slopes_off[-1]
    drawn = np.sqrt((weight * change**2).sum() / weight.sum())
    assert float(one["budget"].sel(parameter="offset")) == pytest.approx(drawn, rel=0.1)


def test_the_budget_is_sure_enough_to_matter(
    calibrated: xr.Dataset, calibrated_by_rays: xr.Dataset
) -> None:
    # off the axis the slope rises steeply in the tails, of which five nodes know more than three
    most = {"offset": 0.3}
    for table, scheme in ((calibrated, "fullwave"), (calibrated_by_rays, "paths")):
        error = table["fixed_focus_phase_slope_standard_error"]
        for name in table["parameter"].values.tolist():
            unsure = table["budget_error"].sel(parameter=name)
            assert (unsure < most.get(name, 0.03) * error).all(), name
        assert (table["accuracy_status"] == 0).all()
        assert (table["intensity_error"] <= REACHED[scheme]).all()


def test_small_steps_need_more_than_the_thesiss_rays(calibrated_by_rays: xr.Dataset) -> None:
    table = calibrated_by_rays
    off = table["rays_phase_slope"] - table["fixed_focus_phase_slope"]
    assert float(np.abs(off).max()) > 0.05
    assert float(np.sqrt((off**2).mean())) < 0.5


def test_rays_have_their_distance_from_maxwell_in_their_error(
    calibrated: xr.Dataset, calibrated_by_rays: xr.Dataset
) -> None:
    assert (calibrated["model_status"] == ModelStatus.BY_MAXWELL).all()
    assert "model" not in calibrated["parameter"].values
    assert not doubts(calibrated)
    table = calibrated_by_rays
    assert (table["model_status"] == ModelStatus.COMPARED).all()
    away = table["fixed_focus_phase_slope"] - table["maxwell_phase_slope"]
    model = table["budget"].sel(parameter="model")
    assert np.allclose(model, np.abs(away))
    assert (table["fixed_focus_phase_slope_standard_error"] >= model).all()
    (doubt,) = doubts(table)
    assert "from Maxwell's equations" in doubt
    # both tables have both
    both = calibrated.sel(diameter=1.4, method="nearest"), table.sel(diameter=1.4, method="nearest")
    for name in ("maxwell_phase_slope", "light_paths_phase_slope"):
        assert float(both[0][name]) == pytest.approx(float(both[1][name]), abs=1e-4)


def test_a_status_says_why_a_number_is_missing(
    calibrated: xr.Dataset, calibrated_by_rays: xr.Dataset
) -> None:
    for table in (calibrated, calibrated_by_rays):
        assert list(unexplained(table)) == []


def test_rays_that_nothing_is_known_of_have_no_error_and_say_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(slopes, "Instrument", Plates)
    monkeypatch.setattr(slopes, "side_slopes", lambda *_: {"near": 0.0, "far": 0.0})
    config = asked(diameters={"num": 8})
    table = calibration(changed(config, {"objective": {"numerical_aperture": 1.34}}))
    assert (table["model_status"] == ModelStatus.NOT_COMPARED).all()
    assert np.isnan(table["fixed_focus_phase_slope_standard_error"]).all()
    assert "not known" in summary(table)
    assert any("numerical_aperture: 1.34 given" in doubt for doubt in doubts(table))
    assert (table["standard_error_status"] == SlopeErrorStatus.NOT_COMPARED).all()
    assert (table["maxwell_slope_status"] == OtherSchemeStatus.BEYOND_SCHEME).all()
    assert list(unexplained(table)) == []
    moved_by = expansion(0.011, 1.4, table)
    assert np.isfinite(moved_by.expansion)
    assert np.isnan(moved_by.systematic_error)


@pytest.mark.parametrize(
    ("overlay", "said"),
    [
        ({"calibration": {"scheme": "fullwave"}, "objective": {"numerical_aperture": 1.4}},
         r"calibration\.scheme: fullwave given, but .*numerical_aperture: 1\.4 given"),
        ({"calibration": {"scheme": "paths"}, "tracing": {"scheme": "vogel"},
          "beam": {"waist": "diffraction"}},
         r"calibration\.scheme: paths given, which has rays that meet in the focus, and "
         r"beam\.waist"),
        ({"budget": {"cpu_hours": 0.001}}, r"budget\.cpu_hours: 0\.001 given, but a calibration"),
    ],
)  # fmt: skip
def test_what_can_not_be_calibrated_so_is_refused_in_a_line(
    overlay: dict[str, object], said: str
) -> None:
    with pytest.raises(ConfigError, match=said) as refused:
        calibration(
            load_config({"sweep": {"focus": {"slope": LAW, "intercept": "66 nm"}}}, overlay)
        )
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("number", [21, 22])
def test_an_interpolation_is_better_than_its_error_says(number: int) -> None:
    diameter = np.linspace(1, 2, number)

    def slope(at: Array) -> Array:
        curve: Array = 24 - at + 0.05 * np.sin(15 * at)
        return curve

    stated = interpolation_error(diameter, slope(diameter))
    between = (diameter[1:] + diameter[:-1]) / 2
    off = np.abs(CubicSpline(diameter, slope(diameter))(between) - slope(between))
    assert (off <= np.maximum(stated[1:], stated[:-1])).all()
    assert stated.max() < 0.01
    assert stated.min() > 0


def test_the_table_explains_itself_is_read_back_and_drawn(
    calibrated: xr.Dataset, tmp_path: Path
) -> None:
    for name, variable in calibrated.variables.items():
        assert variable.attrs["units"], name
        assert variable.attrs["long_name"], name
    write(calibrated, tmp_path / "calibration.nc")
    config = load_config(CALIBRATED)
    stored = read(tmp_path / "calibration.nc", "calibration", config)
    told = summary(stored)
    # a number is nothing without its pupil, focus and estimator
    for part in ("fibre pupil", "held at 0.58 d +66 nm", "estimator sinusoid", "tolerances."):
        assert part in told
    with pytest.raises(DatasetError, match=r"scene differ"):
        read(
            tmp_path / "calibration.nc",
            "calibration",
            changed(config, {"scene": {"gap": "6 nm"}}),
        )
    with look():
        save(calibration_figure(stored), tmp_path / "calibration.png")


def test_a_law_that_is_needed_is_asked_for() -> None:
    with pytest.raises(OctsimError, match=r"sweep.focus: 'law' given"):
        calibration(load_config())


def test_a_diameter_without_a_fringe_is_refused() -> None:
    config = load_config(
        {
            "scene": {"refractive_index": {"neuron": 1.33}},
            "sweep": {"focus": {"slope": 0.58, "intercept": "69 nm"}},
        }
    )
    with pytest.raises(
        OctsimError, match=r"calibration: no phase .* 1\.33 um \(no_fringe\), and at 0"
    ):
        calibration(config)


def test_a_slope_that_changes_its_sign_is_doubted(calibrated: xr.Dataset) -> None:
    turned = calibrated.copy(deep=True)
    turned["fixed_focus_phase_slope"][2] *= -1
    (doubt,) = doubts(turned)
    assert "the slope changes its sign" in doubt
    assert float(summary(turned).partition("standard error ")[2].partition("%")[0]) > 0
