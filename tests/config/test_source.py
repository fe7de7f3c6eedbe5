"""The source's spectrum in a config: forms that are read, and what is refused in a line."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from octsim.base.errors import ConfigError, OctsimWarning
from octsim.config.load import load_config
from octsim.config.models import Config


def with_source(source: Any, **spectrum: Any) -> Config:
    return load_config({"spectrum": {"source": source, **spectrum}})


ROWS = [
    (wavelength, 3000 * np.exp(-(((wavelength - 780) / 60) ** 2)))
    for wavelength in range(640, 931, 2)
]


def written(path: Path, text: str) -> str:
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_a_flat_source_has_no_power_of_its_own() -> None:
    assert load_config().spectrum.power() is None


def test_a_file_is_held_by_the_config_itself(tmp_path: Path) -> None:
    text = "wavelength (nm);counts\n" + "".join(f"{w};{c:.3f}\n".replace(".", ",") for w, c in ROWS)
    file = tmp_path / "source.csv"
    config = with_source(written(file, text))
    file.unlink()
    assert load_config(config.to_dict()) == config
    power, k = config.spectrum.power(), config.spectrum.wavenumbers()
    assert power is not None
    np.testing.assert_allclose(power, np.exp(-(((2e3 * np.pi / k - 780) / 60) ** 2)), atol=2e-4)


def test_falling_wavelengths_and_a_unit_beside_the_file(tmp_path: Path) -> None:
    text = "".join(f"{w / 1000} {c}\n" for w, c in ROWS[::-1])
    rising = "wavelength (um),power\n" + "".join(f"{w / 1000},{c}\n" for w, c in ROWS)
    one = with_source({"table": written(tmp_path / "a.txt", text), "unit": "um"})
    other = with_source(written(tmp_path / "b.csv", rising))
    assert one.spectrum == other.spectrum


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("wavelength,power\n650,1\n900,1\n", "does not say the unit"),
        ("wavelength (nm),power\n650,1\n900,x\n", "row 3"),
        ("wavelength (nm),power,dark\n650,1,0\n900,1,0\n", "has the headings"),
        ("wavelength (nm),power\n650,1\n900,-1\n", "subtract the dark"),
        ("wavelength (nm),power\n650,0\n900,0\n", "no power is above 0"),
        ("wavelength (nm),power\n700,1\n900,1\n", "known from 0.7 um to 0.9 um"),
        ("wavelength (nm),power\n700,1\n650,1\n900,1\n", "sort the rows"),
        ("", "holds 0 blocks"),
    ],
)
def test_a_file_that_is_no_source_is_refused_in_a_line(
    tmp_path: Path, text: str, what: str
) -> None:
    with pytest.raises(ConfigError, match=what) as refused:
        with_source(written(tmp_path / "source.csv", text))
    assert "\n" not in str(refused.value)
    assert str(refused.value).startswith("spectrum.source")


@pytest.mark.parametrize(
    ("source", "what"),
    [
        (5, "it should be flat"),
        (None, "it should be flat"),
        ({"gauss": 1}, "it should be flat"),
        ("none.csv", "can't be read"),
        ({"gaussian": {"centre": "840 nm"}}, r"source\.gaussian\.fwhm: missing"),
        ({"gaussian": {"centre": "1500 nm", "fwhm": "20 nm"}}, "give a band that it lights"),
    ],
)
def test_what_is_no_source_is_refused_in_a_line(source: Any, what: str) -> None:
    with pytest.raises(ConfigError, match=what):
        with_source(source)


def test_a_band_that_is_mostly_dark_is_said() -> None:
    with pytest.warns(OctsimWarning, match="narrow spectrum.wavelength"):
        with_source({"gaussian": {"centre": "840 nm", "fwhm": "20 nm"}})
