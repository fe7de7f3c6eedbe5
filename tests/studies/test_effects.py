"""What each effect changes: known changes, what the config has, the noise, pairs, the sentence."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from missing import unexplained

from octsim.config.derive import changed
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.datasets.files import read, write
from octsim.figures.effects import effects_figure
from octsim.figures.style import look, save
from octsim.instrument.instrument import Instrument
from octsim.phase.derivatives import wrapped
from octsim.studies.effects import study
from octsim.studies.effects.changes import Seen, change, mean_slope, measures, noise, unwrapped
from octsim.studies.effects.kinds import EFFECTS
from octsim.studies.effects.missing import ChangeStatus, change_status
from octsim.studies.effects.needed import doubts, ranks, summary, verdict
from octsim.studies.effects.study import effects
from octsim.studies.effects.sweeps import rougher
from octsim.studies.effects.switches import is_on
from octsim.studies.effects.variants import EffectStatus, Variant, combined, variants

LINE = {"slope": 0.581, "intercept": "69 nm"}
FEW = {
    "focus +50 nm", "Zernike defocus (4) 10 nm rms", "dispersion of neuron alone",
    "falloff cosine", "unpolarised", "attenuation of neuron 100 /cm", "linear x",
}  # fmt: skip


def run(scheme: str = "paths", **overlay: Any) -> Config:
    accuracy = {} if scheme == "vogel" else {"accuracy": 1e-4}
    base = {
        "tracing": {"scheme": scheme, **accuracy},
        "spectrum": {"samples": 200},
        "sweep": {"focus": LINE},
    }
    return load_config(base, overlay)


def by_name(config: Config) -> dict[str, Variant]:
    return {one.effect.name: one for one in variants(config)}


def of_few(config: Config, number: int = 13) -> xr.Dataset:
    """Return the study with a few of the effects measured."""
    listed = [
        one if one.effect.name in FEW or one.configured or not one.measured
        else one._replace(status=EffectStatus.NOT_IN_THIS_SCENE)
        for one in variants(config)
    ]  # fmt: skip
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "variants", lambda _: listed)
        return effects(config, threads=2, number=number)


@pytest.fixture(scope="module")
def few() -> xr.Dataset:
    return of_few(run())


def test_a_change_is_that_of_known_spectra() -> None:
    diameter = np.linspace(1, 2, 51)
    k = np.linspace(7, 9.7, 60)
    fringe = 2 + np.cos(np.outer(diameter, 2 * k))
    one = Seen(3 * fringe, 23.5 * diameter + 1, np.full(51, 23.5))
    other = Seen(fringe, 23.2 * diameter - 2, np.full(51, 23.2))
    found = measures(change(one, other), diameter)
    assert found.spectrum_change == pytest.approx(2)
    assert found.shape_change == pytest.approx(0, abs=1e-14)
    assert found.signal_ratio == pytest.approx(3)
    assert found.mean_slope_change == pytest.approx(0.3)
    assert found.slope_change_scatter == pytest.approx(0, abs=1e-12)
    assert found.worst_slope_change == pytest.approx(0.3)
    assert found.configured_slope_change == pytest.approx(0.3)


def test_turns_between_diameters_are_none_and_what_is_not_known_is_left_out() -> None:
    diameter = np.linspace(1, 2, 21)
    phase = np.asarray(25 * diameter, np.float64)
    phase[4] = np.nan
    turned = np.asarray(wrapped(phase), np.float64)
    slope, error = mean_slope(unwrapped(turned), diameter)
    assert slope == pytest.approx(25)
    assert error == pytest.approx(0, abs=1e-10)
    assert np.isnan(mean_slope(np.array([1.0, np.nan, np.nan]), diameter[:3])[0])


def test_the_noise_is_what_two_ways_differ_by_and_never_by_chance_none() -> None:
    diameter = np.linspace(1, 2, 20)
    dark, flat = np.ones((20, 5)), np.zeros(20)
    alternating = np.where(np.arange(20) % 2, -0.01, 0.01)
    base = Seen(dark, flat, flat)
    fine = change(Seen(dark, 0.2 * diameter, flat), base)
    rough = change(Seen(dark, 0.2 * diameter + alternating, flat), base)
    slope, error = mean_slope(alternating, diameter)
    off = noise(fine, rough, diameter)
    assert off.mean_slope_change == pytest.approx(np.hypot(slope, error))
    assert error > 0.005
    assert off.spectrum_change == 0


def test_an_effect_is_one_overlay_and_leaves_the_index_of_mid_band() -> None:
    config = run()
    found = by_name(config)
    assert len(found) == len(EFFECTS)
    k = config.spectrum.middle
    dispersed = found["dispersion of glass, water and neuron"].with_effect
    for medium, index in (("glass", 1.52), ("water", 1.33), ("neuron", 1.39)):
        material = dispersed.scene.refractive_index.of[medium]
        assert material.dispersive
        assert material.index(k).real == pytest.approx(index, abs=1e-12)
    shift = found["chromatic focal shift 100 nm"].with_effect.objective.focal_shift
    assert shift is not None
    assert shift.formula.at_wavelength(0.9) - shift.formula.at_wavelength(0.65) == pytest.approx(
        0.1
    )
    assert found["focus +50 nm"].focus == 0.05
    assert found["focus +50 nm"].with_effect == config


def test_what_a_scheme_does_not_honour_has_a_status_and_the_scheme_that_does() -> None:
    of_paths, of_waves = by_name(run()), by_name(run("fullwave"))
    rulings, moved = "rulings of each wavelength", "neuron 50 nm off the axis"
    assert of_paths[rulings].status == EffectStatus.NOT_BY_THIS_SCHEME
    assert of_paths[rulings].able == ("vogel",)
    assert by_name(run("vogel"))[rulings].status == EffectStatus.MEASURED
    assert of_paths[moved].able == ("vogel", "paths", "fullwave")
    assert of_waves[moved].status == EffectStatus.MEASURED
    # a key that a scheme does not read is none that it honours
    for name in ("R_det +10 %", "falloff cosine", "Zernike defocus (4) 10 nm rms, phase only"):
        assert of_waves[name].status == EffectStatus.NOT_BY_THIS_SCHEME
        assert of_waves[name].able == ("vogel", "paths")
    assert of_waves["aplanatic apodisation"].status == EffectStatus.AS_CONFIGURED
    # the pupil of fullwave is a fibre's, unless one is given
    assert of_waves["uniform pupil"].measured
    assert of_paths["uniform pupil"].status == EffectStatus.AS_CONFIGURED


def test_what_the_config_has_is_switched_off() -> None:
    objective = {"pupil": {"gaussian": 1.0}, "zernike": {"spherical": "2 nm"}}
    scene = {"attenuation": {"neuron": "10 /cm"}}
    config = run(objective=objective, scene=scene)
    found = by_name(config)
    off = found["pupil as configured"]
    assert off.configured
    assert off.with_effect == config
    assert off.without_effect.pupil == "uniform"
    assert found["Gaussian pupil, fill 0.5"].status == EffectStatus.AS_CONFIGURED
    assert not found["zernike as configured"].without_effect.objective.zernike.of
    # aberrations and attenuations add up
    more = found["Zernike spherical (11) 10 nm rms"].with_effect.objective.zernike.of
    assert more[11] == pytest.approx(0.012)
    taken = found["attenuation of neuron 100 /cm"].with_effect.scene.attenuation.of
    assert taken["neuron"] == pytest.approx(110e-4)
    assert {one.effect.kind for one in found.values() if one.configured} == {
        "pupil", "zernike", "attenuation",
    }  # fmt: skip


@cache
def plainly(scheme: str) -> dict[str, Variant]:
    """Return the variants of the thesis's config by a scheme."""
    return by_name(run(scheme))


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)
def test_every_kind_that_is_on_is_switched_off(effect: Any) -> None:
    scheme = next(
        (name for name in ("vogel", "fullwave") if plainly(name)[effect.name].measured), None
    )
    if scheme is None or effect.kind in ("focus", "detector radius"):
        return
    on = plainly(scheme)[effect.name].with_effect
    if effect.name != "uniform pupil":
        assert is_on(on, effect.kind)
        off = by_name(on)[f"{effect.kind} as configured"].without_effect
        assert not is_on(off, effect.kind)


def test_effects_are_combined_in_one_config() -> None:
    config = run()
    found = by_name(config)
    parts = [found["Zernike defocus (4) 10 nm rms"], found["focus +50 nm"]]
    both = combined(config, [*parts, found["falloff cosine"]])
    assert both is not None
    assert both.focus == 0.05
    assert both.with_effect.objective.zernike.of == {4: 0.01}
    assert both.with_effect.detector.falloff == "cosine"


def test_rougher_light_has_half_the_rays_or_a_tenth_of_the_accuracy() -> None:
    assert rougher(run("vogel")).tracing.rays == 1500
    assert rougher(run()).tracing.accuracy == pytest.approx(1e-3)
    assert rougher(changed(run(), {"tracing": {"accuracy": 0.05}})).tracing.accuracy == 0.1


def test_verdicts_and_ranks_are_by_tolerance_and_noise() -> None:
    mean = np.array([0.1, 0.1, 0.01, 0.05, np.nan])
    measured = {
        "mean_slope_change": mean, "mean_slope_change_noise": np.array([0.01, 0.2, 0.001, 0.02, 0]),
        "worst_slope_change": np.array([0.1, 0.1, 0.5, 0.1, np.nan]),
        "worst_slope_change_noise": np.array([0.01, 0.01, 0.1, 0.01, 0]),
    }  # fmt: skip
    found = verdict(measured, 20.0)  # tolerances: 0.05 and 0.2
    assert found["needed"].tolist() == [1, 0, 1, 0, 0]
    assert found["resolved"].tolist() == [1, 0, 1, 1, 0]
    assert found["undecided"].tolist() == [0, 1, 0, 1, 0]
    assert ranks(np.array([0.1, -0.2, np.nan, 0.01])).tolist() == [2, 1, 0, 3]


def test_the_study_measures_what_spectra_show(few: xr.Dataset) -> None:
    config = run()
    diameter = few["diameter"].values
    foci = 0.581 * diameter + 0.069
    plain = Instrument(config).spectra(diameter, foci)
    raised = Instrument(config).spectra(diameter, foci + 0.05)
    off = np.abs(raised - plain).max(axis=1) / plain.max(axis=1)
    one = few.sel(effect="focus +50 nm")
    assert float(one["spectrum_change"]) == pytest.approx(np.median(off), rel=1e-6)
    signal = np.median(raised.mean(axis=1) / plain.mean(axis=1))
    assert float(one["signal_ratio"]) == pytest.approx(signal, rel=1e-6)
    xr.testing.assert_allclose(
        few["calibration_change"], few["mean_slope_change"] / few["baseline_slope"]
    )
    assert few["cost_ratio"].sel(effect="focus +50 nm") < 3
    assert few["cost_ratio"].sel(effect="dispersion of neuron alone") > 2


@pytest.mark.parametrize(
    ("effect", "slope", "shape", "signal"),
    [
        # as a literal reference has them with 3000 rays
        ("focus +50 nm", 0.2143, 0.19, 0.61),
        ("Zernike defocus (4) 10 nm rms", 0.2405, 0.31, 0.45),
        ("falloff cosine", -0.0021, 2.3e-3, 0.88),
        ("attenuation of neuron 100 /cm", 0.0, 2.9e-3, 0.98),
        ("linear x", -0.0003, 2.2e-4, 1.01),
        ("dispersion of neuron alone", 0.0022, 0.15, 1.0),
    ],
)
def test_the_thesis_scene_is_as_it_was_measured_beforehand(
    few: xr.Dataset, effect: str, slope: float, shape: float, signal: float
) -> None:
    one = few.sel(effect=effect)
    # of 13 diameters by light paths, not of 51 by rays
    assert float(one["mean_slope_change"]) == pytest.approx(slope, abs=0.008)
    assert float(one["shape_change"]) == pytest.approx(shape, rel=0.2)
    assert float(one["signal_ratio"]) == pytest.approx(signal, abs=0.03)


def test_a_pair_is_told_from_the_sum_of_its_parts(few: xr.Dataset) -> None:
    excess = few["pair_mean_slope_change"] - few["pair_sum"]
    assert few["pair_excess"].values == pytest.approx(excess.values, abs=1e-9)
    names = list(zip(few["pair_first"].values, few["pair_second"].values, strict=True))
    # 10 nm of defocus and 50 nm of focus are ways to the same, the other way round
    both = {"Zernike defocus (4) 10 nm rms", "focus +50 nm"}
    (place,) = (number for number, pair in enumerate(names) if set(pair) == both)
    assert few["pair_adds_up"][place] == 0
    assert abs(few["pair_excess"][place]) > 0.1
    # no two of a pair are of one kind
    kind = dict(zip(few["effect"].values, few["effect_kind"].values, strict=True))
    assert all(kind[first] != kind[second] for first, second in names)


def test_counted_rays_are_the_same_with_an_effect_and_without() -> None:
    config = run("vogel", tracing={"rays": 400})
    table = of_few(config, number=5)
    # a weight moves no ray, so that few rays tell it well
    one = table.sel(effect="attenuation of neuron 100 /cm")
    assert float(one["spectrum_change"]) == pytest.approx(1.6e-2, rel=0.15)
    assert one["spectrum_change_noise"] < 0.5 * one["spectrum_change"]
    assert table["accuracy_status"].attrs["flag_meanings"].split()[3] == "not_controlled"


def test_the_study_is_kept_told_and_drawn(few: xr.Dataset, tmp_path: Path) -> None:
    config = run()
    write(few, tmp_path / "effects.nc")
    kept = read(tmp_path / "effects.nc", "effects", config)
    xr.testing.assert_equal(kept, few)
    said = summary(kept)
    assert said.startswith("this scene needs ")
    assert "focus +50 nm (+0.8" in said
    assert "falloff cosine" not in said
    assert said.endswith(
        "at your accuracy (0.25% of the mean slope, 1% at any diameter) the rest may stay off"
    )
    assert any("give tracing.scheme: vogel" in line for line in doubts(kept))
    for name in kept.variables:
        assert {"units", "long_name"} <= kept[name].attrs.keys()
    with look():
        save(effects_figure(kept), tmp_path / "effects.png")
    assert (tmp_path / "effects.png").stat().st_size > 10_000


def test_a_status_says_why_a_number_is_missing(few: xr.Dataset) -> None:
    assert list(unexplained(few)) == []


def test_a_change_s_status_names_what_it_lacks() -> None:
    values, measured = [1.0, np.nan, np.nan], [True, True, False]
    known, dark, none = ChangeStatus.MEASURED, ChangeStatus.NO_FRINGE, ChangeStatus.NOT_MEASURED
    assert change_status(values, measured).tolist() == [known, dark, none]
    far = change_status(values, measured, apart=True)
    assert far.tolist() == [known, ChangeStatus.TOO_FAR_APART, none]
