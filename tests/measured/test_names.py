"""Names and units of labs are known, and what is no name of theirs is not."""

import numpy as np
import pytest

from octsim.base.errors import DatasetError
from octsim.measured.readers.names import (
    counts_samples,
    known,
    plausible,
    times_of,
    unit_of,
    with_unit,
)
from octsim.phase.measured_headings import Heading


@pytest.mark.parametrize(
    ("text", "name", "unit"),
    [("wavelength (nm)", "wavelength", "nm"), ("Wavelengths [µm]", "wavelength", "µm"),
     ("Lambda/nm", "wavelength", "nm"), ("lambda_nm", "wavelength", "nm"),
     ("λ", "wavelength", None), ("wl", "wavelength", None), ("nm", "wavelength", "nm"),
     ("wave length, nm", "wavelength", "nm"),
     ("wavelength_axis (nm)", "wavelength", "nm"), ("(um)", "wavelength", "um"),
     ("wavenumber (1/um)", "wavenumber", "1/um"), ("k [rad/m]", "wavenumber", "rad/m"),
     ("k", "wavenumber", None), ("cm^-1", "wavenumber", "cm^-1"), ("t_ms", "time", "ms"),
     ("t", "time", None), ("Timestamp (us)", "time", "us"), ("time_stamps", "time", None),
     ("Elapsed time [s]", "time", "s"), ("ms", "time", "ms")],
)  # fmt: skip
def test_a_name_is_known_with_its_unit(text: str, name: str, unit: str | None) -> None:
    assert known(text) == Heading(name, unit)


@pytest.mark.parametrize(
    "text",
    ["dark", "T", "K", "m", "h", "k0", "t1", "wlan", "spectrum 1", "1", "counts", "temp", ""],
)
def test_other_names_are_not_known(text: str) -> None:
    assert known(text) is None


@pytest.mark.parametrize(
    ("text", "unit"),
    [("sec", "s"), ("[nm]", "nm"), ("nm_air", "nm"), ("nm_vac", "nm"), ("Nanometers", "nanometers"),
     ("NM", "nm"), ("milliseconds since 2024-05-01 00:00", "milliseconds"), ("1/cm", "1/cm"),
     ("furlong", "furlong"), ("", "")],
)  # fmt: skip
def test_a_unit_is_one_that_is_known(text: str, unit: str) -> None:
    assert unit_of(text) == unit


@pytest.mark.parametrize("text", ["pixel", "Pixel No.", "#", "index", "No.", "Samples"])
def test_a_heading_of_numbers_that_count_is_known(text: str) -> None:
    assert counts_samples(text)
    assert not counts_samples(f"{text} of light")


@pytest.mark.parametrize(
    ("first", "step", "unit"),
    [(800, 1, "nm"), (899, -1, "nm"), (0.8, 0.01, "um"), (0, 1, None), (19_990, 1, None),
     (30, 0.1, None), (800, 0, None), (np.nan, 1, None), (200, 1, "nm"), (199.9, 1, None),
     (20_000, -1, "nm"), (20_001, -1, None), (0.2, 0.001, "um"), (0.19, 0.001, None),
     (20, -0.1, "um"), (20.01, -0.1, None)],
)  # fmt: skip
def test_wavelengths_are_plausible(first: float, step: float, unit: str | None) -> None:
    assert plausible(first + step * np.arange(20.0)) == unit
    assert plausible(first + step * np.arange(7.0)) is None  # too few


@pytest.mark.parametrize(
    ("name", "first", "unit"),
    [("wavelength", 800.0, "nm"), ("wavelength", 0.8, "um"), ("wavelength", 0.8e-6, "m"),
     ("wavelength", 0.2e-6, "m"), ("wavelength", 18e-6, "m"), ("wavenumber", 7.5, "1/um"),
     ("time", 1e9, "s")],
)  # fmt: skip
def test_a_unit_that_is_not_written_is_the_likely_one(name: str, first: float, unit: str) -> None:
    values, said = with_unit(first * np.linspace(1, 1.1, 9), Heading(name, None), "it")
    assert (values.name, values.unit) == (name, unit)
    assert f"taken to be in {unit}" in said


@pytest.mark.parametrize(
    ("heading", "first", "said"),
    [(Heading("wavelength", None), 50.0, "it: wavelength has no unit, and 50 to 55 is none of"),
     (Heading("wavelength", None), 199e-9, "wavelength has no unit, and 1.99e-07 to 2.189e-07"),
     (Heading("wavelength", None), 19e-6, "wavelength has no unit"),
     (Heading("wavenumber", None), 7500.0, "wavenumber has no unit"),
     (Heading("wavelength", "1/um"), 0.8, "the unit of wavelength is '1/um'"),
     (Heading("time", "nm"), 0.8, "the unit of time is 'nm'")],
)  # fmt: skip
def test_a_unit_that_is_not_likely_is_refused(heading: Heading, first: float, said: str) -> None:
    with pytest.raises(DatasetError, match=said):
        with_unit(first * np.linspace(1, 1.1, 9), heading, "it")


@pytest.mark.parametrize(
    ("headings", "times", "unit"),
    [(["0.5 ms", "1 ms"], [0.5, 1], "ms"), (["t=0.5s", "t = 1 s"], [0.5, 1], "s"),
     (["0,5", "1"], [0.5, 1], "s"), (["1 ms", "0.5 ms"], [1, 0.5], "ms"), (["1e-3", "2e-3"],
     [1e-3, 2e-3], "s"), (["time 3", "time 5"], [3, 5], "s")],
)  # fmt: skip
def test_headings_may_be_times(headings: list[str], times: list[float], unit: str) -> None:
    found = times_of(headings)[0]
    assert found is not None
    assert (found.values.tolist(), found.unit) == (times, unit)


@pytest.mark.parametrize(
    "headings",
    [["1", "2", "3"], ["0", "1"], ["3", "1"], ["1", "1"], ["7"], ["1 ms", "2 s"], ["1 mm", "2 mm"],
     ["a", "b"], ["", ""], [], ["0.5 ms", "1 ms", "dark"], ["dark", "0.5", "2"]],
)  # fmt: skip
def test_other_headings_are_no_times(headings: list[str]) -> None:
    assert times_of(headings)[0] is None
