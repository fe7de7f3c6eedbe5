"""The beat of the neuron's two sides: its fields sum to the spectrum, its slope is the plates'."""

import numpy as np
import pytest
from numpy.typing import NDArray

import octsim
from octsim.base.errors import OctsimError
from octsim.config.derive import by_accuracy
from octsim.config.load import load_config
from octsim.config.models import FocusLine, Processing
from octsim.instrument.instrument import Instrument
from octsim.optics.two_beams import predicted_phase_slope
from octsim.phase.derivatives import phase_derivative
from octsim.studies.causes.beat import Fields, fields_at, parts
from octsim.studies.causes.beat_slope import beat_slopes
from octsim.studies.causes.switches import Reading

CONFIG = load_config({"sweep": {"focus": {"slope": 0.58, "intercept": "64 nm"}}})
K = CONFIG.spectrum.wavenumbers()
N = CONFIG.scene.refractive_index.neuron
PREDICTED = predicted_phase_slope(N, float(K[0]), float(K[-1]))
READING = Reading(Processing(), N, np.linspace(1, 2, 151), K)


@pytest.mark.parametrize("scheme", ["vogel", "paths"])
def test_fields_and_parts_sum_to_the_spectrum_of_the_run(scheme: str) -> None:
    config = load_config(
        CONFIG.to_dict(), {"tracing": {"scheme": scheme}, "sweep": {"diameters": {"num": 3}}}
    )
    spectra = octsim.spectra(config, octsim.detections(config))
    diameters, foci = spectra["diameter"].values, spectra["focus"].values
    found = fields_at(Instrument(config), diameters, foci)
    intensity, whole = spectra["intensity"].values, np.sum(found, axis=0)
    rounding = {"vogel": 1e-11, "paths": 1e-6}[scheme] * intensity.max()
    assert np.allclose(np.abs(whole) ** 2, intensity, rtol=0, atol=rounding)
    assert np.allclose(parts(found).intensity(), intensity, rtol=0, atol=rounding)
    # light that is reflected once is nearly all of it
    once = parts(found._replace(other=np.zeros_like(found.other))).intensity()
    assert 0 < np.abs(once - intensity).max() < 1e-3 * intensity.max()


def test_parts_of_random_fields_multiply_out() -> None:
    random = np.random.default_rng(5)
    fields = Fields(*(random.normal(size=(3, 2, 7)) + 1j * random.normal(size=(3, 2, 7))))
    assert np.allclose(parts(fields).intensity(), np.abs(sum(fields)) ** 2, atol=1e-13)


def test_along_the_axis_the_beat_has_the_plates_slope() -> None:
    # a narrow cone of rays: paths are those of the axis, whatever the focus does
    narrow = load_config(
        CONFIG.to_dict(), {"objective": {"numerical_aperture": 0.005}, "tracing": {"rays": 50}}
    )
    read = READING._replace(diameter=np.array([1.0, 1.5, 2.0]))
    line = narrow.sweep.focus
    assert isinstance(line, FocusLine)
    held = line.at(read.diameter)
    follows = beat_slopes(Instrument(narrow), read, line.at)
    stays = beat_slopes(Instrument(narrow), read, lambda _: held)
    middle = float(K[K.size // 2])
    glass = narrow.scene.refractive_index.glass
    assert follows.beat == pytest.approx(PREDICTED, rel=1e-4)
    assert stays.beat == pytest.approx(PREDICTED, rel=1e-4)
    assert stays.near == pytest.approx(0, abs=2e-3)
    assert stays.far == pytest.approx(2 * N * middle, rel=1e-4)
    # paths begin and end at the focus, as if all were glass
    assert follows.near == pytest.approx(-2 * glass * line.slope * middle, rel=1e-4)


def test_a_focus_that_follows_adds_what_the_focus_does() -> None:
    instrument = Instrument(by_accuracy(CONFIG, 1e-8))
    read = READING._replace(diameter=np.array([1.2, 1.7]))
    line = CONFIG.sweep.focus
    assert isinstance(line, FocusLine)
    held = line.at(read.diameter)
    follows = beat_slopes(instrument, read, line.at)
    stays = beat_slopes(instrument, read, lambda _: held)
    weight = np.hamming(K.size) * np.exp(-2j * N * np.outer(read.diameter, K))

    def by_focus(offset: float) -> NDArray[np.complex128]:
        moved = parts(fields_at(instrument, read.diameter, held + offset)).beat
        return np.asarray((moved * weight).sum(axis=1))

    change = phase_derivative(by_focus, 1e-3).value
    assert np.abs(follows.beat - stays.beat).min() > 0.3
    assert follows.beat == pytest.approx(stays.beat + line.slope * change, abs=1e-4)
    assert follows.far - follows.near == pytest.approx(follows.beat, rel=2e-3)
    assert (follows.beat_error < 1e-4).all()


def test_a_scene_in_which_nothing_beats_is_refused() -> None:
    few = load_config(CONFIG.to_dict(), {"tracing": {"max_intersections": 3}})
    with pytest.raises(OctsimError, match="far side") as said:
        fields_at(Instrument(few), np.array([1.2]), np.array([0.7]))
    assert "\n" not in str(said.value)
