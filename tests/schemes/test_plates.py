"""Plates without a cylinder, by every scheme, beside the closed forms of thin films."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import integrate as quadrature

import octsim
from octsim.base.errors import ConfigError, OctsimWarning
from octsim.config.load import load_config
from octsim.datasets.catalog import CATALOG
from octsim.instrument.build import surface_names
from octsim.instrument.instrument import Instrument
from octsim.schemes.light import AccuracyStatus
from octsim.stages.job import Job, perform
from octsim.tracing.light_paths import path_name

Array = NDArray[np.float64]
ONE: dict[str, Any] = {"layers": ["glass", {"medium": "water", "thickness": "swept"}, "glass"]}
TWO: dict[str, Any] = {
    "layers": [
        "glass", {"medium": "water", "thickness": "0.7 um"},
        {"medium": "neuron", "thickness": "swept"}, "water",
    ]
}  # fmt: skip
GLASS, WATER, NEURON = 1.52, 1.33, 1.39
INDICES = {"one": (GLASS, WATER, GLASS), "two": (GLASS, WATER, NEURON, WATER)}
SCENES = {"one": ONE, "two": TWO}
THICK, FOCUS = 2.0, 0.4


def instrument(scene: str, aperture: float, distance: str = "300 um", **tracing: Any) -> Instrument:
    config = load_config({
        "scene": {**SCENES[scene], "cylinders": []}, "tracing": tracing,
        "objective": {
            "numerical_aperture": aperture, "focus_distance": distance, "pupil": "uniform"
        },
        "spectrum": {"samples": 50},
    })  # fmt: skip
    return Instrument(config)


def thicknesses(scene: str) -> tuple[float, ...]:
    return (THICK,) if scene == "one" else (0.7, THICK)


def stack(scene: str, k: float, sine: float) -> tuple[complex, complex]:
    """Return r_s and r_p (of H) by the matrices of the layers (Born & Wolf, ch. 1.6)."""
    n = np.array(INDICES[scene])
    cosines = np.sqrt(1 - (sine / n) ** 2 + 0j)
    found = []
    for admittance in (n * cosines, cosines / n):
        whole = np.eye(2, dtype=complex)
        for d, index, cos, q in zip(
            thicknesses(scene), n[1:], cosines[1:], admittance[1:], strict=False
        ):
            beta = k * index * d * cos
            layer = [[np.cos(beta), -1j * np.sin(beta) / q], [-1j * np.sin(beta) * q, np.cos(beta)]]
            whole = whole @ np.array(layer)
        first, last = admittance[0], admittance[-1]
        top, low = whole @ np.array([1, last])
        found.append((first * top - low) / (first * top + low))
    return found[0], found[1]


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("scheme", ["vogel", "paths"])
def test_rays_along_the_axis_are_airys_sum(scene: str, scheme: str) -> None:
    # from afar, or the objective's rim cuts what returns from beside the focus
    seen = instrument(scene, 1e-4, "300 mm", scheme=scheme, accuracy=1e-6)
    expected = [abs(stack(scene, k, 0.0)[0]) ** 2 for k in seen.wavenumber.tolist()]
    found = seen.spectrum(THICK, FOCUS).intensity
    # at the rim a ray or two of 3000 are lost
    assert np.abs(found - expected).max() < 1e-3 * max(expected)


def test_a_plate_s_two_surfaces_beat_by_its_optical_thickness() -> None:
    seen = instrument("one", 1e-4, "300 mm")
    k, intensity = seen.wavenumber, seen.spectrum(THICK, FOCUS).intensity
    r = (GLASS - WATER) / (GLASS + WATER)
    # thesis §2.2: a constant and a cosine of 2ndk, to the order of the light that goes to and fro
    assert intensity == pytest.approx(2 * r**2 * (1 - np.cos(2 * WATER * THICK * k)), abs=12 * r**4)


@pytest.mark.parametrize("scene", SCENES)
def test_both_schemes_of_rays_see_the_same_off_the_axis(scene: str) -> None:
    counted = instrument(scene, 0.4, scheme="vogel", rays=200_000).spectrum(THICK, FOCUS).intensity
    smooth = instrument(scene, 0.4, scheme="paths", accuracy=1e-6).spectrum(THICK, FOCUS)
    assert smooth.status == AccuracyStatus.REACHED
    assert np.abs(counted - smooth.intensity).max() < 2e-4 * smooth.intensity.max()


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("aperture", [0.3, 1.2])
def test_waves_are_airys_sum_over_the_pupil(scene: str, aperture: float) -> None:
    seen = instrument(scene, aperture, scheme="fullwave", accuracy=1e-11)
    found = seen.spectrum(THICK, FOCUS)
    assert found.status == AccuracyStatus.REACHED

    def at(k: float) -> float:
        def part(squared: float) -> complex:
            r_s, r_p = stack(scene, k, np.sqrt(squared))
            turned: complex = np.exp(-2j * FOCUS * k * np.sqrt(GLASS**2 - squared))
            return (r_s - r_p) / 2 * turned

        whole, _ = quadrature.quad(
            part, 0, aperture**2, complex_func=True, epsabs=1e-12, epsrel=1e-12, limit=400
        )
        return float(abs(whole / aperture**2) ** 2)

    expected = np.array([at(k) for k in seen.wavenumber[::7].tolist()])
    assert np.abs(found.intensity[::7] - expected).max() < 1e-9 * expected.max()


def test_the_paths_of_plates_are_named_by_their_planes() -> None:
    seen = instrument("two", 0.4, scheme="vogel", rays=200)
    names = surface_names(seen.config)
    light = seen.rays(THICK, FOCUS)
    called = {path_name(code, names) for code in set(light.path.tolist())}
    assert {"PR", "PT QR PT", "PT QT SR QT PT"} <= called


@pytest.mark.parametrize("scheme", ["paths", "fullwave"])
def test_layers_of_one_medium_are_no_plate(scheme: str) -> None:
    same = {"layers": ["glass", {"medium": "glass", "thickness": "swept"}, "glass"]}
    config = {"scene": {**same, "cylinders": []}, "tracing": {"scheme": scheme}}
    said = "is no surface"
    if scheme == "fullwave":
        with pytest.raises(ConfigError, match=said):
            load_config(config)
    else:
        with pytest.warns(OctsimWarning, match=said):
            dark = Instrument(load_config(config)).spectrum(1.0, 0.5)
        assert (dark.intensity == 0).all()


@pytest.mark.parametrize("tracing", [{"rays": 300}, {"preset": "standard"}, {"preset": "exact"}])
def test_a_run_of_plates_goes_from_light_to_the_slope(tracing: dict[str, Any]) -> None:
    config = load_config({
        "scene": {**ONE, "cylinders": []}, "tracing": tracing,
        "objective": {"numerical_aperture": 0.1},
        "spectrum": {"samples": 100},
        "sweep": {"focus": {"slope": 0.55, "intercept": "0 nm"}, "diameters": {"num": 21}},
    })  # fmt: skip
    waves = config.tracing.scheme == "fullwave"
    spectra = (
        octsim.spectra(config, fields=octsim.fields(config))
        if waves
        else octsim.spectra(config, octsim.detections(config))
    )
    slopes = octsim.phase_slope(config, octsim.fourier(config, spectra), spectra)
    predicted = float(slopes["predicted_phase_slope"])
    assert predicted == pytest.approx(WATER * 2 * np.pi * (1 / 0.65 + 1 / 0.9))
    assert float(slopes["mean_phase_slope"]) == pytest.approx(predicted, rel=0.01)
    # Maxwell's equations are solved for plates too
    assert (slopes["exact_phase_slope"].notnull().any()) != waves


@pytest.mark.parametrize("scheme", ["vogel", "paths"])
def test_rays_and_waves_see_the_same_plate_that_absorbs_and_disperses(scheme: str) -> None:
    # in one direction there is no spot that a detector could cut
    plate = {
        "refractive_index": {"neuron": {"cauchy": [1.37, 0.01]}},
        "attenuation": {"neuron": "200 /cm"},
        "layers": ["glass", {"medium": "neuron", "thickness": "swept"}, "glass"],
        "cylinders": [],
    }
    objective = {"numerical_aperture": 1e-4, "focus_distance": "300 mm", "pupil": "uniform"}
    seen = [
        Instrument(
            load_config({
                "scene": plate, "objective": objective, "tracing": {"scheme": one},
                "spectrum": {"samples": 50},
            })
        ).spectrum(THICK, FOCUS).intensity
        for one in (scheme, "fullwave")
    ]  # fmt: skip
    assert np.abs(seen[0] - seen[1]).max() < 2e-3 * seen[1].max()
    assert seen[1].min() > 1e-3 * seen[1].max()  # the far plane's light is fainter


def test_a_target_that_needs_a_cylinder_says_so(tmp_path: Path) -> None:
    config = instrument("one", 0.4).config
    job = Job((CATALOG["calibration"],), {}, {"calibration": tmp_path / "calibration.nc"})
    with pytest.raises(ConfigError, match="but calibration needs a cylinder"):
        perform(job, config)
