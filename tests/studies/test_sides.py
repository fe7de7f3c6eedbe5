"""The neuron's two sides: the phase of each by its own path."""

import numpy as np
import pytest

from octsim.config.models import Config
from octsim.optics.scene import NEURON_ON_GLASS
from octsim.schemes.fullwave.series import nodes
from octsim.schemes.light import AccuracyStatus, Light, Waves
from octsim.studies.sides import SIDES, path_field, side_slopes
from octsim.tracing.light_paths import path_name

N = Config().scene.refractive_index.neuron


def test_the_light_of_a_plates_side_has_the_phase_of_its_path() -> None:
    def trace_at(diameter: float, focus: float) -> Light:  # noqa: ARG001
        # PT CR PT twice, and PT CT CR CT PT
        lengths = np.array([1.0, 1.0, 1.0 + 2 * N * diameter])
        codes = np.array([89, 89, 1517])
        ones = np.ones(3)
        return Light(codes, ones, ones, lengths, 0.0, 3, AccuracyStatus.REACHED)

    assert [path_name(code, NEURON_ON_GLASS) for code in (89, 1517)] == list(SIDES.values())
    found = side_slopes(trace_at, 1.4, 0.8, 8.0, 1e-4)
    assert found == pytest.approx({"near": 0.0, "far": 16 * N})
    assert path_field(trace_at(1.4, 0.8), "PR", 8.0) == 0


def test_the_waves_of_a_side_have_the_phase_of_their_path() -> None:
    k = nodes((7.0, 9.6), 12)

    def light_at(diameter: float, focus: float) -> Waves:  # noqa: ARG001
        taken_out = 1.0 + N * diameter
        paths = np.array([1.0, 1.0 - 0.3 * diameter, 1.0 + 2 * N * diameter])
        # both polarisations, of unlike strength and phase
        strength = np.array([1.0, 0.3j])[:, np.newaxis]
        terms = np.stack([strength * np.exp(1j * k * (path - taken_out)) for path in paths])
        return Waves(
            k, terms.sum(axis=0), terms, taken_out, 0.0, 0.0, 20, AccuracyStatus.REACHED
        )  # fmt: skip

    found = side_slopes(light_at, 1.4, 0.8, 8.0, 1e-4)
    assert found == pytest.approx({"near": -8 * 0.3, "far": 16 * N}, rel=1e-4)
