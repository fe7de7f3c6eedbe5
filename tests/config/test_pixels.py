"""A spectrometer's pixels in a config: how they are named, what they make of the samples."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from octsim.base.errors import ConfigError
from octsim.config.load import load_config
from octsim.config.models import Config

NM = np.linspace(640, 910, 1081)


def with_pixels(pixels: Any, **sections: Any) -> Config:
    return load_config({"spectrum": {"pixels": pixels}, **sections})


def written(path: Path, nm: Any) -> str:
    np.savetxt(path, nm, fmt="%.9f", header="wavelength (nm)", comments="")
    return str(path)


def test_lab_is_the_axis_of_measured_spectra_and_is_held_by_the_config(tmp_path: Path) -> None:
    file = tmp_path / "calib.csv"
    config = with_pixels("lab", measured={"axis": {"wavelength": written(file, NM[::-1])}})
    file.unlink()
    assert load_config(config.to_dict()).spectrum == config.spectrum
    k, inside = config.spectrum.wavenumbers(), NM[(NM >= 650) & (NM <= 900)]
    assert config.spectrum.samples == k.size == inside.size
    assert np.allclose(k[[0, -1]], 2e3 * np.pi / inside[[-1, 0]], rtol=1e-9)
    assert np.allclose(np.diff(k), np.diff(k).mean(), rtol=1e-9)


def test_a_polynomial_is_as_good_as_a_file(tmp_path: Path) -> None:
    by_file = with_pixels({"wavelength": written(tmp_path / "calib.csv", NM)})
    by_polynomial = with_pixels({"polynomial": [640, 0.25]})
    assert np.allclose(
        by_file.spectrum.wavenumbers(), by_polynomial.spectrum.wavenumbers(), rtol=1e-9
    )


def test_a_narrower_band_takes_fewer_of_the_pixels() -> None:
    config = with_pixels({"polynomial": [640, 0.25]})
    plain = config.to_dict()
    plain["spectrum"]["wavelength"] = {"min": "700 nm", "max": "800 nm"}
    assert load_config(plain).spectrum.samples == 401


@pytest.mark.parametrize(
    ("pixels", "message"),
    [
        ("lab", "measured.axis is not"),
        ("camera", "it should be lab"),
        ({"polynomial": [700, 0.25]}, "the spectrometer sees 0.7 um to"),
        ({"polynomial": [640, 60]}, "4 pixels are within"),
        ({"polynomial": [640, 0.5, -0.001]}, "the spectrometer sees 0.64 um to"),
        ({"wavelength": "none.csv"}, "none.csv can't be read"),
        ({"wavelength": ["700 nm", "650 nm"]}, "wavelength"),
        ({"wavelength": "a.csv", "polynomial": [1, 2]}, "it should be lab"),
    ],
    ids=["no axis", "a word", "beyond", "few", "turns", "no file", "falling", "both"],
)
def test_pixels_that_are_none_are_refused_in_a_line(pixels: Any, message: str) -> None:
    with pytest.raises(ConfigError, match=message) as caught:
        with_pixels(pixels)
    assert str(caught.value).startswith("spectrum.pixels")
    assert "\n" not in str(caught.value)
