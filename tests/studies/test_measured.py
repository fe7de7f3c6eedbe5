"""From a lab's files to phases: what is read, what it comes to, and what is refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from lab import DARK, NM, READ, SOURCE, K, Lab, recorded, written
from missing import unexplained

from octsim.base.errors import OctsimError
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.datasets.writer import write_stream
from octsim.measured.phases import series_of
from octsim.phase.derivatives import wrapped
from octsim.phase.fringe_status import FringeStatus
from octsim.phase.measured_series import Series
from octsim.studies.measured.study import doubts, measured, own_band, summary

SHOT = {"depth": "4 um", "sinusoid": {"weights": "shot", "envelope": "common"}}


def config_of(section: dict[str, Any], **further: Any) -> Config:
    return load_config({"measured": section, "processing": SHOT, **further})


@pytest.fixture
def lab() -> Lab:
    return recorded()


def test_phases_come_back_with_the_errors_that_are_stated(tmp_path: Path, lab: Lab) -> None:
    found = measured(config_of(written(tmp_path, lab)))
    off = wrapped(found["fringe_phase"].values - lab.phase)
    error = found["fringe_phase_error"].values
    assert (found["spectrum_status"] == FringeStatus.VISIBLE).all()
    # what all share is of the envelope
    assert np.abs(off.mean()) < 0.02
    assert np.std(off - off.mean()) / error.mean() == pytest.approx(1, abs=0.25)
    assert float(found["variance_per_count"]) == pytest.approx(1, rel=0.1)
    assert float(found["dark_noise"]) == pytest.approx(READ, rel=0.5)


def test_it_holds_all_counts_as_they_were_by_rising_wavenumber(tmp_path: Path, lab: Lab) -> None:
    section = written(tmp_path, lab)
    found = measured(
        config_of(section, spectrum={"wavelength": {"min": "700 nm", "max": "850 nm"}})
    )
    np.testing.assert_array_equal(found["counts"].values, lab.spectra)  # falling wavelengths
    np.testing.assert_allclose(found["wavenumber"], K)
    np.testing.assert_allclose(found["wavelength"], NM / 1e3)
    assert found["counts"].dtype == np.uint16
    np.testing.assert_allclose(found["time"], np.arange(60) / 1e3)
    inside = np.isfinite(found["source_power"].values)
    np.testing.assert_array_equal(inside, (NM >= 700) & (NM <= 850))
    np.testing.assert_allclose(found["dark_level"].values[inside], DARK, atol=1.5)


def test_what_was_understood_is_stored(tmp_path: Path, lab: Lab) -> None:
    found = measured(config_of(written(tmp_path, lab)))
    told = found.attrs["understood"]
    for part in (
        "60 spectra of 300 samples",
        "dark: 80 spectra",
        "measured.reference",
        "visibility",
    ):
        assert part in told
    assert "60 with a phase" in summary(found)


def test_blocks_are_written_as_all_at_once(
    tmp_path: Path, lab: Lab, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = config_of(written(tmp_path, lab))
    whole = measured(config)
    monkeypatch.setattr("octsim.studies.measured.study._BLOCK_BYTES", 8 * 300 * 7)
    write_stream(measured.stream(config), tmp_path / "measured.nc")
    with xr.open_dataset(tmp_path / "measured.nc") as stored:
        assert stored.attrs["understood"] == whole.attrs["understood"]
        for name in whole.variables:
            np.testing.assert_allclose(
                stored[name].values, whole[name].values, rtol=1e-12, err_msg=str(name)
            )


def test_without_a_source_it_always_says_so(tmp_path: Path, lab: Lab) -> None:
    section = written(tmp_path, lab)
    del section["reference"]
    said = doubts(measured(config_of(section)))
    assert any(line.startswith("measured.reference: not given") for line in said)
    lit = {"wavelength": {"min": "651 nm", "max": "899 nm"},
           "source": {"gaussian": {"centre": "775 nm", "fwhm": "120 nm"}}}  # fmt: skip
    known = doubts(measured(config_of(section, spectrum=lit)))
    assert not any(line.startswith("measured.reference: not given") for line in known)


def test_a_spectrum_that_is_full_is_a_missing_sample(tmp_path: Path, lab: Lab) -> None:
    lab.spectra[7] = np.minimum(4 * lab.spectra[7], 4095)
    found = measured(config_of(written(tmp_path, lab)))
    assert found["spectrum_status"].values[7] == FringeStatus.SATURATED
    series = series_of(found)
    assert np.flatnonzero(np.isnan(series.phase)).tolist() == [7]
    assert any(line.startswith("saturated at 1 of 60") for line in doubts(found))


def test_averages_are_of_phasors_and_their_errors_fall(tmp_path: Path, lab: Lab) -> None:
    found = measured(config_of(written(tmp_path, lab)))
    alone, mean = series_of(found), series_of(found, 7)
    assert mean.phase.size == 8
    assert mean.phase[0] == pytest.approx(np.angle(np.exp(1j * alone.phase[:7]).mean()))
    assert isinstance(alone, Series)
    assert alone.phase_error is not None
    assert mean.phase_error is not None
    assert mean.phase_error[0] == pytest.approx(alone.phase_error[:7].mean() / np.sqrt(7), rel=0.01)


def test_a_reflector_that_moves_along_is_taken_off(tmp_path: Path) -> None:
    lab = recorded(photons=1e4)
    bulk = np.linspace(0, 1.5, 60)[:, np.newaxis]
    middle = (K[0] + K[-1]) / 2
    still = 2500 * SOURCE * np.cos(2 * 12.0 * (K - middle) + 0.4 + bulk)
    moved = recorded(photons=1e4, phase=lab.phase + bulk[:, 0])
    lab = lab._replace(spectra=np.maximum(np.round(moved.spectra + still), 0))
    section = written(tmp_path, lab, reference_depth="12 um")
    found = measured(config_of(section))
    change = np.diff(np.unwrap(found["fringe_phase"].values)[[0, -1]])[0]
    assert change == pytest.approx(0.3, abs=0.05)


def test_all_that_a_spectrometer_sees_is_its_own_band(tmp_path: Path, lab: Lab) -> None:
    config = load_config({"measured": written(tmp_path, lab)})
    assert own_band(config) == {"wavelength": {"min": "0.65 um", "max": "0.9 um"}}


def wrong(tmp_path: Path, section: dict[str, Any]) -> dict[str, dict[str, Any]]:
    np.save(tmp_path / "other.npy", np.ones((5, 200), np.uint16))
    dark = np.load(section["reference"])
    dark[:, 100:140] = DARK
    np.save(tmp_path / "hole.npy", dark)
    np.save(tmp_path / "nan.npy", np.full((5, 300), np.nan))
    np.savetxt(tmp_path / "turned.csv", np.append(NM[:-1], 700.0), header="wavelength (nm)")
    other = str(tmp_path / "other.npy")
    return {
        "no spectra": {"spectra": None},
        "a file that is not there": {"spectra": str(tmp_path / "none.npy")},
        "pixels that do not match": {"dark": other},
        "an axis of another spectrometer": {"spectra": other, "dark": None, "reference": None},
        "a reference that is dark where spectra are not": {"reference": str(tmp_path / "hole.npy")},
        "no numbers": {"spectra": str(tmp_path / "nan.npy"), "dark": None, "reference": None},
        "an axis that turns": {"axis": {"wavelength": str(tmp_path / "turned.csv")}},
        "no rate": {"rate": None},
        "too few fringes for dispersion": {"dispersion": "fit"},
        "a reference that is the dark": {"reference": section["dark"]},
    }  # fmt: skip


@pytest.mark.parametrize("name", [
    "no spectra", "a file that is not there", "pixels that do not match",
    "an axis of another spectrometer", "a reference that is dark where spectra are not",
    "no numbers", "an axis that turns", "no rate", "too few fringes for dispersion",
    "a reference that is the dark",
])  # fmt: skip
def test_what_does_not_fit_is_refused_in_a_line(tmp_path: Path, lab: Lab, name: str) -> None:
    section = written(tmp_path, lab)
    section |= wrong(tmp_path, section)[name]
    with pytest.raises(OctsimError) as refused:
        measured(config_of(section))
    assert "\n" not in str(refused.value)
    assert len(str(refused.value)) < 400


def test_a_band_that_the_spectrometer_does_not_see_is_refused(tmp_path: Path, lab: Lab) -> None:
    wide = {"wavelength": {"min": "600 nm", "max": "900 nm"}}
    with pytest.raises(OctsimError, match=r"spectrum\.wavelength: 0\.6 um to 0\.9 um given, but"):
        measured(config_of(written(tmp_path, lab), spectrum=wide))


@pytest.mark.parametrize("a2", [0.0, 3.0, -8.0])
def test_dispersion_that_is_given_leaves_the_fringe_visible(tmp_path: Path, a2: float) -> None:
    x = (K - (K[0] + K[-1]) / 2) / ((K[-1] - K[0]) / 2)
    angle = 2 * 4.0 * (K - (K[0] + K[-1]) / 2) + 0.3 + a2 * x**2
    light = 3000 * SOURCE * (1 + 0.5 * np.cos(angle))
    lab = recorded()
    noisy = np.random.default_rng(2).poisson(light, (60, K.size)).astype(float) + DARK
    found = measured(
        config_of(written(tmp_path, lab._replace(spectra=noisy), dispersion={"a2": a2}))
    )
    assert (found["spectrum_status"] == FringeStatus.VISIBLE).all()
    assert float(found["fringe_phase"].mean()) == pytest.approx(0.3, abs=0.01)


def test_frames_without_light_have_no_phase(tmp_path: Path, lab: Lab) -> None:
    lab.spectra[20:24] = lab.dark[:4]
    found = measured(config_of(written(tmp_path, lab)))
    assert (found["spectrum_status"].values[20:24] == FringeStatus.NO_FRINGE).all()
    assert np.isnan(found["fringe_phase"].values[20:24]).all()
    assert np.isfinite(found["fringe_phase"]).sum() == 56


def test_a_status_says_why_a_number_is_missing(tmp_path: Path, lab: Lab) -> None:
    lab.spectra[20:24] = lab.dark[:4]
    narrower = {"wavelength": {"min": "690 nm", "max": "860 nm"}}
    found = measured(config_of(written(tmp_path, lab), spectrum=narrower))
    assert found["source_power"].isnull().any()
    assert list(unexplained(found)) == []


@pytest.mark.parametrize("phase", [0.0, np.pi - 0.005])
def test_the_source_s_noise_is_in_the_error_wherever_the_phase_is(
    tmp_path: Path, phase: float
) -> None:
    lab = recorded(phase=np.full(60, phase))
    error = float(measured(config_of(written(tmp_path, lab)))["chain_error"])
    assert 1e-6 < error < 1e-2


def test_a_depth_that_is_fitted_is_refused(tmp_path: Path, lab: Lab) -> None:
    config = load_config({
        "measured": written(tmp_path, lab), "processing": {"sinusoid": {"depth": "fitted"}},
    })  # fmt: skip
    with pytest.raises(OctsimError, match=r"processing\.sinusoid\.depth: fitted given"):
        measured(config)


def warned(config: Config) -> str:
    return "\n".join(doubts(measured(config)))


def test_levels_and_wavelengths_that_are_others_are_warned_of(tmp_path: Path, lab: Lab) -> None:
    section = written(tmp_path, lab)
    right = warned(config_of(section))
    assert "of the mean fringe" not in right
    assert "measured.dark: above" not in right
    assert "visibility" not in right
    np.savetxt(tmp_path / "axis.csv", NM[::-1], header="wavelength (nm)", comments="")
    assert "of the mean fringe" in warned(config_of(section))
    section = written(tmp_path, lab)
    np.save(tmp_path / "dark.npy", (6 * lab.dark).astype(np.uint16))
    assert "measured.dark: above the mean spectrum at" in warned(config_of(section))


def test_a_camera_that_is_full_below_its_converter_s_largest_value_is_seen(
    tmp_path: Path, lab: Lab
) -> None:
    full = int(1.2 * lab.spectra.max())
    lit = lab.spectra.copy()
    lit[3] *= 2
    cut = lab._replace(spectra=np.minimum(lit, full))
    found = measured(config_of(written(tmp_path, cut)))
    assert float(found["full_scale"]) == full
    assert np.flatnonzero(found["spectrum_status"] == FringeStatus.SATURATED).tolist() == [3]
    assert not np.isfinite(float(measured(config_of(written(tmp_path, lab)))["full_scale"]))


def test_a_dark_that_is_the_file_of_spectra_is_refused(tmp_path: Path, lab: Lab) -> None:
    section = written(tmp_path, lab)
    with pytest.raises(OctsimError, match=r"measured\.dark: .* which is measured\.spectra too"):
        measured(config_of({**section, "dark": section["spectra"]}))


def test_the_depth_of_the_mean_spectrum_is_where_its_fringe_is(tmp_path: Path, lab: Lab) -> None:
    config = load_config({
        "measured": written(tmp_path, lab),
        "processing": {"depth": "4.1 um", "sinusoid": {"weights": "shot", "envelope": "common"}},
    })  # fmt: skip
    assert float(measured(config)["measured_depth"]) == pytest.approx(4, abs=0.02)
