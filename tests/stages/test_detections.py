"""The sweep over diameters: literal rays, one diameter after the other, where there is a focus."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from gridded import gridded
from literal import literal
from made_runs import WHOLE, every_stage

import octsim
from octsim.base.errors import OctsimError
from octsim.instrument.instrument import Instrument
from octsim.optics.scene import NEURON_ON_GLASS
from octsim.schemes.light import AccuracyStatus
from octsim.stages.detections import stored_rays
from octsim.stages.phase_slope import summary
from octsim.stages.spectra import doubts
from octsim.tracing.light_paths import path_name

CONFIG = octsim.load_config(WHOLE)


def test_rays_are_the_literal_ones_of_each_diameter(stages: dict[str, xr.Dataset]) -> None:
    detected, law = stages["detections"], stages["focus_law"]
    foci = float(law["slope"]) * detected["diameter"] + float(law["intercept"])
    assert np.allclose(detected["focus"], foci, rtol=1e-12)
    lights = stored_rays(detected)
    for row in (0, 4, 8):
        at, light = detected.isel(diameter=row), lights[row]
        traced = literal(CONFIG, float(at["diameter"]), float(at["focus"]))
        # the order of rays is the package's own
        expected = sorted((d.path, d.optical_path_length, d.amplitude) for d in traced.detections)
        paths = (path_name(code, NEURON_ON_GLASS) for code in light.path.tolist())
        rays = zip(paths, light.optical_path_length.tolist(), light.amplitude.tolist(), strict=True)
        found = sorted(rays)
        assert [ray[0] for ray in found] == [ray[0] for ray in expected]
        values, literal_values = (np.array([ray[1:] for ray in rays]) for rays in (found, expected))
        assert np.allclose(values, literal_values, rtol=1e-9, atol=1e-12)
        assert int(at["segments_traced"]) == traced.segments


def test_detections_are_contiguous_ragged(stages: dict[str, xr.Dataset]) -> None:
    detected = stages["detections"]
    assert detected["rays_detected"].attrs["sample_dimension"] == "ray"
    assert detected["rays_detected"].sum() == detected.sizes["ray"]
    by_outcome = detected["outcomes"].sel(outcome="detected")
    assert np.array_equal(by_outcome, detected["rays_detected"])


def test_rays_of_a_diameter_are_read_back_from_its_place(stages: dict[str, xr.Dataset]) -> None:
    detected, start = stages["detections"], 0
    for light, count in zip(
        stored_rays(detected), detected["rays_detected"].values.tolist(), strict=True
    ):
        own = detected.isel(ray=slice(start, start + count))
        assert np.array_equal(light.path, own["path_code"])
        assert np.array_equal(light.amplitude, own["amplitude"])
        assert np.array_equal(light.optical_path_length, own["optical_path_length"])
        start += count


def test_threads_change_no_bit(stages: dict[str, xr.Dataset]) -> None:
    for threads in (2, 5):
        detected = octsim.detections(CONFIG, stages["focus_law"], threads)
        xr.testing.assert_identical(detected, stages["detections"])
        xr.testing.assert_identical(octsim.focus_sweep(CONFIG, threads), stages["focus_sweep"])


def test_a_law_out_of_reach_stops_the_sweep_alone() -> None:
    config = octsim.load_config(WHOLE, {"focus_law": {"fraction": {"stop": 0.42}}})
    law = octsim.focus_law(config, octsim.gaussian_fits(config, octsim.focus_sweep(config)))
    assert np.isnan(law["slope"])
    with pytest.raises(octsim.OctsimError, match=r"sweep\.focus: 'law' given, but there is no law"):
        octsim.detections(config, law)
    given = octsim.load_config(WHOLE, {"sweep": {"focus": {"slope": 0.58, "intercept": "69 nm"}}})
    assert octsim.detections(given, law).sizes["diameter"] == 9


def test_a_law_beyond_the_objective_is_refused(stages: dict[str, xr.Dataset]) -> None:
    config = octsim.load_config(WHOLE)
    law = stages["focus_law"].assign(intercept=((), 400.0))
    with pytest.raises(octsim.OctsimError, match=r"objective\.focus_distance: 300\.0 um given"):
        octsim.detections(config, law)


def test_a_combination_without_a_focus_law_is_nan_and_the_others_are_there() -> None:
    # the narrow range of foci has no peak within it
    config = gridded({"focus_law.fraction.stop": [0.8, 0.42]})
    found = every_stage(config)
    status = found["spectra"]["accuracy_status"].values
    assert (status[1] == AccuracyStatus.NO_FOCUS).all()
    assert (status[0] == AccuracyStatus.NOT_CONTROLLED).all()
    slopes = found["phase_slope"]["mean_phase_slope"].values
    assert np.isnan(slopes).tolist() == [False, True]
    assert found["spectra"]["intensity"].isnull()[1].all()
    assert found["detections"]["rays_detected"].values[1].sum() == 0
    said = doubts(found["spectra"])
    assert any(line.startswith("there is no focus law at 1 of 2 combinations") for line in said)
    assert any("raise tracing.rays" in line for line in said)
    assert "over 2 combinations" in summary(found["phase_slope"])
    with pytest.raises(OctsimError, match="there is no law"):
        every_stage(gridded({"focus_law.fraction.stop": [0.41, 0.42]}))


EFFECTS: dict[str, dict[str, Any]] = {
    "dispersion": {"scene": {"refractive_index": {"neuron": {"cauchy": [1.3815, 0.004]}}}},
    "polarisation": {"polarisation": {"input": "30 deg", "analyser": "80 deg"}},
    "nothing": {},
}


def test_fields_of_rays_that_differ_by_wavenumber_are_kept_beside_them() -> None:
    few = {
        "tracing": {"rays": 200}, "spectrum": {"samples": 24},
        "sweep": {"diameters": {"num": 3}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
    }  # fmt: skip
    for name, overlay in EFFECTS.items():
        config = octsim.load_config(few, overlay)
        detected = octsim.detections(config)
        assert ("field_real" in detected) == (name != "nothing")
        spectra = octsim.spectra(config, detected)
        instrument = Instrument(config)
        for row, (diameter, focus) in enumerate(
            zip(spectra["diameter"].values.tolist(), spectra["focus"].values.tolist(), strict=True)
        ):
            expected = instrument.spectrum(diameter, focus)
            assert np.array_equal(spectra["intensity"][row], expected.intensity)
            assert float(spectra["intensity_error"][row]) == expected.error


def test_a_grid_can_have_an_effect_in_some_of_its_combinations() -> None:
    few = {
        "tracing": {"rays": 200}, "spectrum": {"samples": 24},
        "sweep": {"diameters": {"num": 3}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
    }  # fmt: skip
    config = octsim.load_config(few, {"grid": {"polarisation.input": ["none", "left"]}})
    whole = octsim.spectra(config, octsim.detections(config))
    for place, given in enumerate(("none", "left")):
        alone = octsim.load_config(few, {"polarisation": {"input": given}})
        expected = octsim.spectra(alone, octsim.detections(alone))["intensity"]
        assert np.array_equal(whole["intensity"].values[place], expected.values)
