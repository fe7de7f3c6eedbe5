"""Effects that the thesis left out, as a config asks for them and as the literal reference does."""

import math
from typing import Any, NamedTuple

import numpy as np


class Case(NamedTuple):
    """An effect: what it lays over a config, and what of the literal reference it sets."""

    overlay: dict[str, Any]
    literal: dict[str, Any]


def glass(wavelength: float) -> complex:
    return 1.508 + 0.0065 / wavelength**2


def water(wavelength: float) -> complex:
    square, b, c = wavelength**2, (0.5684, 0.1726, 0.02086), (0.005102, 0.01821, 0.02621)
    terms = (one * square / (square - other) for one, other in zip(b, c, strict=True))
    return complex(np.sqrt(1 + sum(terms)))


def neuron(wavelength: float) -> complex:
    return 1.3815 + 0.004 / wavelength**2 + 0.00012 / wavelength**4


INDICES = {
    "glass": {"cauchy": [1.508, 0.0065]},
    "water": {"sellmeier": {"B": [0.5684, 0.1726, 0.02086], "C": [0.005102, 0.01821, 0.02621]}},
    "neuron": {"cauchy": [1.3815, 0.004, 0.00012]},
}
HALF = math.sqrt(0.5)
SLOTS: dict[str, Case] = {
    "pupil": Case({"objective": {"pupil": {"gaussian": 0.5}}}, {"pupil": ("gaussian", 0.5)}),
    "aplanatic": Case({"objective": {"apodisation": "aplanatic"}}, {"apodisation": "aplanatic"}),
    "aberration": Case(
        {"objective": {"zernike": {"4": "4 nm", "coma x": "-5 nm", "spherical": "6 nm"}}},
        {"zernike": {4: 0.004, 8: -0.005, 11: 0.006}},
    ),
    "focal shift": Case(
        {
            "objective": {
                "focal_shift": {
                    "reference": "755 nm", "linear": "0.2 um/um", "quadratic": "0.3 um/um^2"
                }
            }
        },
        {"focal_shift": (0.755, 0.2, 0.3)},
    ),
    "falloff": Case(
        {"detector": {"falloff": "gaussian", "mode_field_diameter": "5 um"}},
        {"falloff": ("gaussian", 5.0)},
    ),
    "rulings": Case({"beam": {"waist": "diffraction"}}, {"waist": "diffraction"}),
    "dispersion": Case(
        {"scene": {"refractive_index": INDICES}},
        {"glass": glass, "water": water, "neuron": neuron},
    ),
    "attenuation": Case(
        {"scene": {"attenuation": {"neuron": "100 /cm"}}}, {"attenuation": {"neuron": 0.01}}
    ),
    "polarisation": Case(
        {"polarisation": {"input": "left", "analyser": "20 deg"}},
        {"polarisation": ((HALF, 1j * HALF), 20.0)},
    ),
    "reference": Case(
        {"interferometer": {"reference": {"amplitude": 0.004, "length": "9 um"}}},
        {"reference": (0.004, 9.0)},
    ),
}  # fmt: skip
"""One of each kind, that go together in pairs."""
MORE: dict[str, Case] = {
    "nothing": Case({}, {}),
    "fibre pupil": Case({"objective": {"pupil": {"fibre": "5 um"}}}, {"pupil": ("fibre", 5.0)}),
    "phase alone": Case(
        {"objective": {"zernike": {11: "10 nm", 8: "5 nm"}, "zernike_rays": "phase"}},
        {"zernike": {11: 0.01, 8: 0.005}, "zernike_rays": "phase"},
    ),
    "odd along": Case({"objective": {"zernike": {7: "8 nm"}}}, {"zernike": {7: 0.008}}),
    "top hat": Case({"detector": {"falloff": "top_hat"}}, {"falloff": "top_hat"}),
    "cosine": Case({"detector": {"falloff": "cosine"}}, {"falloff": "cosine"}),
    "gaussian": Case({"detector": {"falloff": "gaussian"}}, {"falloff": ("gaussian", None)}),
    "fibre": Case({"detector": {"falloff": "fibre"}}, {"falloff": ("fibre", 0.13)}),
    "a waist": Case(
        {"beam": {"waist": "0.1 um", "wavelength": "755 nm"}},
        {"waist": 0.1, "waist_wavelength": 0.755},
    ),
    "all media attenuate": Case(
        {"scene": {"attenuation": {"glass": "10 /cm", "water": "5 /cm", "neuron": "100 /cm"}}},
        {"attenuation": {"glass": 1e-3, "water": 5e-4, "neuron": 0.01}},
    ),
    "unpolarised": Case({"polarisation": {"input": "unpolarised"}}, {"polarisation": (None, None)}),
    "crossed": Case(
        {"polarisation": {"input": "45 deg", "analyser": "-45 deg"}},
        {"polarisation": ((HALF, HALF), -45.0)},
    ),
}
