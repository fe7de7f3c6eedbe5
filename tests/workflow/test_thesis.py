"""The thesis's numbers, from its own config."""

import numpy as np
import pytest
import reference
import xarray as xr
from literal import literal

import octsim

CONFIG = octsim.load_config()


@pytest.fixture(scope="module")
def law() -> xr.Dataset:
    return octsim.focus_law(CONFIG, octsim.gaussian_fits(CONFIG, octsim.focus_sweep(CONFIG, 2)))


@pytest.fixture(scope="module")
def slopes(law: xr.Dataset) -> xr.Dataset:
    spectra = octsim.spectra(CONFIG, octsim.detections(CONFIG, law, 2))
    return octsim.phase_slope(CONFIG, octsim.fourier(CONFIG, spectra))


def test_the_focus_law_is_the_thesis_s(law: xr.Dataset) -> None:
    assert float(law["slope"]) == pytest.approx(0.581, abs=0.004)
    assert float(law["intercept"]) == pytest.approx(0.069, abs=0.008)


def test_the_focus_scan_has_the_thesis_s_three_peaks() -> None:
    scan = octsim.focus_scan(CONFIG, 2)
    focus, level = scan["focus"].values, np.log(scan["intensity"].values)
    peaks = focus[1:-1][(level[1:-1] > level[:-2]) & (level[1:-1] > level[2:])]
    assert np.any(np.abs(peaks) < 0.02)
    assert np.any((peaks >= 1.0) & (peaks <= 1.5))
    assert np.any((peaks >= 2.0) & (peaks <= 3.3))
    # and it is dark between them: each is a peak of the whole curve, not a ripple
    for low, high in ((0.3, 1.0), (1.5, 2.0)):
        dark = level[(focus > low) & (focus < high)].min()
        assert dark < level[(focus >= 1.0) & (focus <= 1.5)].max() - 2


def test_the_phase_slope_is_the_thesis_s(slopes: xr.Dataset) -> None:
    predicted = float(slopes["predicted_phase_slope"])
    assert predicted == pytest.approx(23.140, abs=5e-4)
    assert float(slopes["mean_phase_slope"]) == pytest.approx(predicted, rel=0.005)
    assert float(slopes["phase_slope_standard_deviation"]) == pytest.approx(0.25, abs=0.03)
    assert float(slopes["standard_deviation_from_ideal"]) == pytest.approx(0.22, abs=0.03)
    assert float(slopes["largest_deviation_diameter"]) == pytest.approx(1.15, abs=0.01)
    assert np.unique(slopes["strongest_component"]).tolist() == [1, 2]


def test_the_plain_reading_of_the_thesis_s_law_comes_out() -> None:
    config = octsim.load_config({"sweep": {"focus": {"slope": 0.581, "intercept": "69 nm"}}})
    spectra = octsim.spectra(config, octsim.detections(config, threads=2))
    slopes = octsim.phase_slope(config, octsim.fourier(config, spectra))
    expected = {
        "mean_phase_slope": 23.219,
        "phase_slope_standard_deviation": 0.241,
        "standard_deviation_from_ideal": 0.218,
        "largest_deviation_diameter": 1.153,
        "mean_ideal_phase_slope": 23.138,
        "ideal_phase_slope_standard_deviation": 0.168,
    }
    for name, value in expected.items():
        assert float(slopes[name]) == pytest.approx(value, abs=6e-4), name
    assert float(slopes["largest_deviation"]) == pytest.approx(1.57, abs=0.01)


OVERLAYS = {
    "thesis": {},
    "other optics": {
        "scene": {"refractive_index": {"glass": 1.6, "water": 1.35, "neuron": 1.5}, "gap": "80 nm"},
        "objective": {
            "numerical_aperture": 0.9, "focus_distance": "150 um", "magnification": 10,
        },
        "detector": {"core_diameter": "9 um"},
    },
    "few of everything": {
        "tracing": {"max_intersections": 4, "min_amplitude": 0.001},
        "spectrum": {"samples": 2, "wavelength": {"min": "400 nm", "max": "1 um"}},
    },
    "one ray": {"tracing": {"rays": 1}},
    "totally reflecting": {"objective": {"numerical_aperture": 1.51}},
}  # fmt: skip


@pytest.mark.parametrize("overlay", OVERLAYS.values(), ids=OVERLAYS)
def test_spectra_agree_with_a_literal_reading_in_absolute_scale(
    overlay: dict[str, object],
) -> None:
    config = octsim.load_config(
        {
            "tracing": {"rays": 500},
            "sweep": {
                "diameters": {"start": "1.1 um", "stop": "1.2 um", "num": 2},
                "focus": {"slope": 0.58, "intercept": "60 nm"},
            },
        },
        overlay,
    )
    spectra = octsim.spectra(config, octsim.detections(config))
    k = reference.wavenumbers(
        config.spectrum.wavelength.min, config.spectrum.wavelength.max, config.spectrum.samples
    )
    assert np.allclose(spectra["wavenumber"], k, rtol=1e-15)
    for diameter, spectrum in zip((1.1, 1.2), spectra["intensity"].values, strict=True):
        traced = literal(config, diameter, 0.58 * diameter + 0.06)
        expected = reference.spectrum(traced.detections, k)
        assert np.abs(spectrum - expected).max() <= 1e-9 * expected.max()
