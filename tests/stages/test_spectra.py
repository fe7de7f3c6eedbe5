"""Spectra: the literal sum of the detected rays, and how sure it is."""

import json

import numpy as np
import pytest
import reference
import xarray as xr
from literal import literal
from made_runs import WHOLE

import octsim
from octsim.schemes.light import AccuracyStatus

CONFIG = octsim.load_config(WHOLE)


def test_intensity_is_the_literal_sum_over_the_rays(stages: dict[str, xr.Dataset]) -> None:
    measured = stages["spectra"]
    k = measured["wavenumber"].values
    assert np.array_equal(k, CONFIG.spectrum.wavenumbers())
    for row in (0, 5):
        at = measured.isel(diameter=row)
        found = literal(CONFIG, float(at["diameter"]), float(at["focus"])).detections
        for sample in (0, 317, 999):
            expected = abs(reference.field_at(found, float(k[sample]))) ** 2
            intensity = float(at["intensity"][sample])
            assert intensity == pytest.approx(expected, abs=1e-9 * float(at["intensity"].max()))


def test_counted_rays_have_no_accuracy_to_reach(stages: dict[str, xr.Dataset]) -> None:
    measured = stages["spectra"]
    assert (measured["accuracy_status"] == AccuracyStatus.NOT_CONTROLLED).all()
    assert (measured["intensity_error"] > 0).all()
    assert np.array_equal(measured["focus"], stages["detections"]["focus"])


def test_the_accuracy_is_judged_at_the_samples() -> None:
    given = {
        "tracing": {"preset": "draft"},
        "sweep": {"diameters": {"num": 3}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
    }
    config = octsim.load_config(given, {"sweep": {"diameters": {"stop": "1.1 um"}}})
    detected = octsim.detections(config)
    assert (detected["accuracy_status"] == AccuracyStatus.REACHED).all()
    error = octsim.spectra(config, detected)["intensity_error"].values
    # the same light, by a config that asks for what not all of its samples have
    between = float(error.min() + error.max()) / 2
    finer = octsim.load_config(config.to_dict(), {"tracing": {"accuracy": between}})
    judged = octsim.spectra(finer, detected.assign_attrs(config=json.dumps(finer.to_dict())))
    late = judged["accuracy_status"] == AccuracyStatus.NOT_REACHED
    assert late.values.tolist() == (judged["intensity_error"] > between).values.tolist()
    assert 0 < late.values.sum() < late.size
    assert (judged["accuracy_status"][~late] == AccuracyStatus.REACHED).all()


def test_a_point_depends_on_itself_alone(stages: dict[str, xr.Dataset]) -> None:
    # the last four of the nine diameters on their own give the same spectra
    law = stages["focus_law"]
    part = octsim.load_config(WHOLE, {"sweep": {"diameters": {"start": "1.5 um", "num": 5}}})
    alone = octsim.spectra(part, octsim.detections(part, law))
    assert np.array_equal(alone["intensity"], stages["spectra"]["intensity"][4:])


def test_a_diameter_does_not_depend_on_its_sweep() -> None:
    base = {
        "tracing": {"preset": "standard"},
        "sweep": {"focus": {"slope": 0.58, "intercept": "69 nm"}},
    }
    many = octsim.load_config(
        base, {"sweep": {"diameters": {"start": "1 um", "stop": "1.5 um", "num": 6}}}
    )
    few = octsim.load_config(
        base, {"sweep": {"diameters": {"start": "1.3 um", "stop": "1.5 um", "num": 3}}}
    )
    all_of, some = (octsim.spectra(c, octsim.detections(c, threads=2)) for c in (many, few))
    for diameter in (1.4, 1.5):
        one, other = (s.sel(diameter=diameter, method="nearest") for s in (all_of, some))
        if float(one["diameter"]) == float(other["diameter"]):
            assert np.array_equal(one["intensity"], other["intensity"])
    assert float(all_of["diameter"][-1]) == float(some["diameter"][-1])


def test_the_scheme_paths_goes_through_all_stages() -> None:
    config = octsim.load_config(
        {
            "tracing": {"preset": "draft"},
            "focus_scan": {"focus": {"num": 4}},
            "sweep": {"diameters": {"num": 9}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
        }
    )
    detected = octsim.detections(config)
    spectra = octsim.spectra(config, detected)
    assert (spectra["accuracy_status"] == 0).all()
    assert (spectra["intensity_error"] < config.tracing.accuracy).all()
    assert (detected["segments_traced"] < 5000).all()
    rays = octsim.load_config(config.to_dict(), {"tracing": {"scheme": "vogel", "rays": 3000}})
    slope = octsim.phase_slope(
        rays, octsim.fourier(rays, octsim.spectra(rays, octsim.detections(rays)))
    )
    ours = octsim.phase_slope(config, octsim.fourier(config, spectra))
    assert np.allclose(ours["phase_slope"], slope["phase_slope"], atol=0.2)
    counted = octsim.focus_scan(config)["rays_detected"]
    assert np.array_equal(counted, octsim.focus_scan(rays)["rays_detected"])
