"""Effects that are possible but likely not meant: what is said of them."""

from typing import Any

import pytest

from octsim.config.checks import plain_remarks
from octsim.config.derive import merge, validated
from octsim.config.models import Config


def said_of(*overlays: dict[str, Any]) -> list[str]:
    data = Config().to_dict()
    for overlay in overlays:
        data = merge(data, overlay)
    return plain_remarks(validated(data))


def arm(amplitude: float, length: str) -> dict[str, Any]:
    return {"interferometer": {"reference": {"amplitude": amplitude, "length": length}}}


def shift(**given: str) -> dict[str, Any]:
    return {"objective": {"focal_shift": {"reference": "755 nm", **given}}}


FIBRE = {"falloff": "fibre", "core_diameter": "1 um"}
GLASS = {"medium": "glass", "thickness": "swept"}
LIKELY: list[tuple[dict[str, Any], str]] = [
    ({"objective": {"zernike": {"spherical": "5 um"}}}, "objective.zernike.11: 5 um (spherical) is 7.69 waves rms at 0.65 um, far beyond what an objective has, and by which the focus is lost"),
    ({"objective": {"zernike": {"7": "-170 nm"}}}, "objective.zernike.7: -0.17 um (coma y) is 0.262 waves rms"),
    ({"objective": {"zernike": {"7": "100 nm"}}}, "so rays are not to be trusted with it, as the detector cuts by position"),
    # 2 · 1000 um (1/0.65 − 1/0.9)/um = 854.7 periods of the fringe in the band
    (arm(0.004, "1 mm"), "interferometer.reference.length: 1000 um has a fringe of period 0.00314 /um, which spectrum.samples: 1000 alias; give 1711 samples or more"),
    (arm(0.004, "-1 mm"), "interferometer.reference.length: -1000 um has a fringe of period 0.00314"),
    (arm(1.5, "9 um"), "interferometer.reference.amplitude: 1.5 is more light than goes in"),
    ({"scene": {"attenuation": {"neuron": "50000 /cm"}}}, "scene.attenuation.neuron: an attenuation of 50000 /cm leaves 0.0025 of the amplitude after the largest swept thickness, 2.4 um"),
    ({"scene": {"attenuation": {"glass": "1000 /cm"}}}, "scene.attenuation.glass: an attenuation of 1000 /cm leaves 3.1e-07 of the amplitude after objective.focus_distance, 300 um"),
    ({"scene": {"refractive_index": {"neuron": {"table": {"wavelength": [0.6, 1], "n": [1.4, 1.4], "kappa": [0.5, 0.5]}}}}}, "scene.refractive_index.neuron: an attenuation of 83238.8 /cm leaves 4.6e-05 of the amplitude"),
    ({"scene": {"cylinders": [{"medium": "water"}]}}, "scene.cylinders.0.medium: water, as what is around it, and the same material on both sides is no surface"),
    (shift(), "objective.focal_shift: moves nothing, as its linear and quadratic are 0"),
    (shift(reference="0.5 um", linear="1 um/um"), "objective.focal_shift.reference: 0.5 um is outside the band, 0.65 um to 0.9 um, so the focus is moved by 0.255 um in the middle of the band"),
    ({"beam": {"waist": "0.2 um", "wavelength": "1 um"}}, "beam.wavelength: 1 um is outside the band, 0.65 um to 0.9 um"),
    ({"detector": FIBRE}, "detector.fibre_na: 0.13 and detector.core_diameter: 1 um are of V = 0.45 at 0.9 um, at which a fibre hardly guides light"),
    ({"scene": {"refractive_index": {"glass": 1.33}}}, "scene.layers.1: water has the index of glass below it, so no light is reflected from the plane between them"),
    ({"expansion": {"series": "a.csv", "diameter": "4.5 um"}}, "expansion.diameter: 4.5 um given, and the calibration is of 1 to 2 um, so no change can be read"),
    ({"scene": {"refractive_index": {"neuron": 1.33}}}, "scene.cylinders.0.medium: neuron has the index of water around it"),
    ({"scene": {"layers": ["glass", GLASS, "glass"], "cylinders": []}}, "scene.layers: all are of glass, and the same material on both sides is no surface"),
]  # fmt: skip


@pytest.mark.parametrize(("overlay", "line"), LIKELY, ids=[line[:50] for _, line in LIKELY])
def test_an_effect_that_is_likely_not_meant_is_said(overlay: dict[str, Any], line: str) -> None:
    (said,) = [one for one in said_of(overlay) if line in one]
    assert "\n" not in said


@pytest.mark.parametrize(
    "overlay",
    [
        {"objective": {"zernike": {"piston": "5 um", "spherical": "4 nm"}}},
        arm(1, "500 um"),
        arm(0, "1 m"),
        {"scene": {"attenuation": {"neuron": "1000 /cm", "glass": "100 /cm"}}},
        shift(linear="1 um/um"),
        {"beam": {"waist": "0.2 um", "wavelength": "0.9 um"}},
        {"detector": {"falloff": "fibre"}},
        {"expansion": {"series": "a.csv", "diameter": "2 um"}},
        {
            "expansion": {
                "series": "a.csv",
                "diameter": "4.5 um",
                "fit": ["diameter", "gap"],
                "bands": [["650 nm", "750 nm"], ["750 nm", "900 nm"]],
            }
        },
        {"expansion": {"diameter": "4.5 um"}},
        {"scene": {"refractive_index": {"glass": "N-BK7", "water": "water"}}},
    ],
)
def test_an_effect_that_may_be_meant_is_not_said(overlay: dict[str, Any]) -> None:
    assert said_of(overlay) == said_of()


def test_a_large_aberration_is_said_of_waves_too() -> None:
    large = {"objective": {"zernike": {"spherical": "5 um"}}, "tracing": {"scheme": "fullwave"}}
    assert any("waves rms" in one for one in said_of(large))
