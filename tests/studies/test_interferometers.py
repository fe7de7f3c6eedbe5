"""The thesis's section 2: a reference arm and plates, beside closed forms."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from missing import unexplained

from octsim.config.load import load_config
from octsim.datasets.files import read, write
from octsim.figures.interferometers import michelson_figure, plates_figure
from octsim.figures.style import look, save
from octsim.studies.interferometers import michelson
from octsim.studies.interferometers.plates import APERTURES, airy
from octsim.studies.interferometers.study import interferometers, summary

RUN = load_config({
    "tracing": {"rays": 1000}, "spectrum": {"samples": 100}, "sweep": {"diameters": {"num": 41}},
})  # fmt: skip


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(michelson, "STEPS", 61)
        return interferometers(RUN)


def test_a_reference_arm_is_eq_1_of_the_length_one_way(found: xr.Dataset) -> None:
    k, intensity = found["wavenumber"].values, found["michelson_intensity"].values
    bright = intensity.max()
    expected = bright / 2 * (1 + np.cos(2 * michelson.ARM * k))
    assert intensity == pytest.approx(expected, abs=2e-3 * bright)
    closed = found["michelson_closed_form"].values
    assert intensity == pytest.approx(closed, abs=1e-12 * bright)


@pytest.mark.filterwarnings("ignore::octsim.base.errors.OctsimWarning")
def test_an_immersion_s_aberration_is_not_of_the_arm(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(michelson, "STEPS", 3)
    slide = {"medium": "glass", "thickness": "170 um"}
    oil = load_config(RUN.to_dict(), {
        "objective": {"immersion": "water"}, "scene": {"layers": [slide, "water"]},
    })  # fmt: skip
    found, plain = (michelson.michelson(one).intensity for one in (oil, RUN))
    assert found.tobytes() == plain.tobytes()


def test_a_moved_mirror_shows_every_half_wavelength_and_the_band_its_coherence(
    found: xr.Dataset,
) -> None:
    arm, k = found["arm"].values, found["wavenumber"].values
    one = found["one_wavelength_intensity"].values
    assert one == pytest.approx(1 + np.cos(2 * k[k.size // 2] * arm), abs=1e-9)
    band = 1 + np.cos(2 * np.outer(arm, k)).mean(axis=1)
    assert found["band_intensity"].values == pytest.approx(band, abs=1e-9)


def test_plates_of_light_along_the_axis_are_airys_sum(found: xr.Dataset) -> None:
    errors = found["plates_error"].values
    assert (errors[1:3] < 3e-3).all()
    assert np.isnan(errors[[0, *range(3, 3 + len(APERTURES))]]).all()


def test_two_plates_have_the_slope_of_eq_2_and_a_cone_less(found: xr.Dataset) -> None:
    slope = found["mean_phase_slope"].values
    assert slope[1] == pytest.approx(float(found["predicted_phase_slope"]), abs=0.05)
    assert slope[1] == pytest.approx(slope[0], abs=0.05)
    # n d cos θ: of a narrow cone less by about 1 − NA²/(4 n²)
    assert slope[3] / slope[1] == pytest.approx(1 - 0.3**2 / (4 * 1.39**2), abs=4e-3)
    assert slope[4] < slope[3]


def test_airys_sum_of_one_plane_is_fresnels() -> None:
    assert airy([1.5, 1.0], [], np.array([8.0])) == pytest.approx([0.04])
    # half a wavelength thick, a film is not there
    film = airy([1.5, 1.3, 1.0], [0.5], np.array([np.pi / (1.3 * 0.5)]))
    assert film == pytest.approx([0.04])


def test_it_is_written_read_told_and_drawn(found: xr.Dataset, tmp_path: Path) -> None:
    write(found, tmp_path / "interferometers.nc")
    kept = read(tmp_path / "interferometers.nc", "interferometers", RUN)
    assert "phase slope of two planes" in summary(kept)
    with look():
        for name, draw in (("michelson", michelson_figure), ("plates", plates_figure)):
            save(draw(kept), tmp_path / f"{name}.png")
            assert (tmp_path / f"{name}.png").stat().st_size > 10_000


def test_a_status_says_why_a_number_is_missing(found: xr.Dataset) -> None:
    assert list(unexplained(found)) == []
