"""What was likely meant by a key or a word that is not known."""

from pathlib import Path

import pytest

from octsim.base.errors import ConfigError
from octsim.config.known_keys import known_keys, of_any_entry
from octsim.config.load import load_config
from octsim.config.nearest import nearest_key, nearest_value


@pytest.mark.parametrize(
    ("tried", "meant"),
    [
        ("detector.core", "detector.core_diameter"),
        ("detector.fiber", "detector.core_diameter"),
        ("detector.diameter", "detector.core_diameter"),
        ("detector.na", "detector.fibre_na"),
        ("detector.mfd", "detector.mode_field_diameter"),
        ("sweep.diameters.end", "sweep.diameters.stop"),
        ("sweep.diameters.max", "sweep.diameters.stop"),
        ("sweep.diameters.n", "sweep.diameters.num"),
        ("sweep.diameters.points", "sweep.diameters.num"),
        ("sweep.diameter", "sweep.diameters"),
        ("spectrum.wavelength.stop", "spectrum.wavelength.max"),
        ("spectrum.wavelength.start", "spectrum.wavelength.min"),
        ("spectrum.band", "spectrum.wavelength"),
        ("spectrum.wavelengths", "spectrum.wavelength"),
        ("processing.FFT", "processing.estimator"),
        ("processing.method", "processing.estimator"),
        ("tracing.method", "tracing.scheme"),
        ("tracing.n_rays", "tracing.rays"),
        ("objective.mag", "objective.magnification"),
        ("objective.NA", "objective.numerical_aperture"),
        ("objective.aperture", "objective.numerical_aperture"),
        ("objective.numerical_apperture", "objective.numerical_aperture"),
        ("objective.working_distance", "objective.focus_distance"),
        ("scene.index", "scene.refractive_index"),
        ("scene.neurons", "scene.cylinders"),
        ("focus_scan.foci", "focus_scan.focus"),
        ("calibration.estimater", "calibration.estimator"),
        # of another section
        ("scene.core_diameter", "detector.core_diameter"),
        ("tracing.samples", "spectrum.samples"),
        ("objective.core", "detector.core_diameter"),
        # of none, or of a section that there is not
        ("na", "objective.numerical_aperture"),
        ("mag", "objective.magnification"),
        ("gap", "scene.gap"),
        ("name", "run"),
        ("objectve", "objective"),
        ("optics.na", "objective.numerical_aperture"),
        ("detektor.falloff", "detector.falloff"),
    ],
)
def test_a_key_is_looked_for_in_its_own_section_first(tried: str, meant: str) -> None:
    assert nearest_key(tried) == meant


def test_every_key_is_the_nearest_to_itself() -> None:
    keys = {of_any_entry(key) for key in known_keys()}
    assert {key: nearest_key(key) for key in keys} == {key: key for key in keys}


@pytest.mark.parametrize(
    ("given", "known", "meant"),
    [
        ("FFT", ("zero_padded", "fft"), "fft"),
        ("Hann", ("hamming", "hann"), "hann"),
        ("Maximum Likelihood", ("fft", "maximum_likelihood"), "maximum_likelihood"),
        ("maxwell", ("vogel", "paths", "fullwave"), "fullwave"),
        ("top-hat", ("parabolic", "top_hat"), "top_hat"),
        ("maxwell", ("draft", "exact"), "exact"),
    ],
)
def test_a_word_is_known_in_capitals_and_by_other_names(
    given: str, known: tuple[str, ...], meant: str
) -> None:
    assert nearest_value(given, known) == meant


def test_a_key_that_stands_twice_is_told_at_both_lines(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(
        "scene:\n  gap: 1 nm\n  layers: [glass, water]\n  # again\n  gap: 2 nm\n"
    )
    with pytest.raises(ConfigError) as told:
        load_config(tmp_path / "mine.yaml")
    assert str(told.value) == (
        f"{tmp_path}/mine.yaml, line 5, column 3: the key 'gap' stands twice, on line 2 too"
    )
