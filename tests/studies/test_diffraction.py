"""The diffraction limit by defocus: peaks of figure 6 and slopes, beside Maxwell's equations."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from missing import unexplained

from octsim.base.errors import ConfigError
from octsim.config.load import load_config
from octsim.datasets.files import read, write
from octsim.figures.diffraction import diffraction_figure
from octsim.figures.style import look, save
from octsim.studies.diffraction import study
from octsim.studies.diffraction.peaks import PeakStatus, peak_within
from octsim.studies.diffraction.study import (
    EACH,
    FIBRE,
    ONE,
    RAYS,
    UNIFORM,
    diffraction,
    instruments,
    summary,
)

RUN = load_config({
    "tracing": {"rays": 500}, "spectrum": {"samples": 60}, "sweep": {"diameters": {"num": 51}},
})  # fmt: skip


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    every = instruments(RUN)
    # rays of each wavelength take long, and are tested where they are traced
    few = {name: every[name] for name in (RAYS, ONE, UNIFORM, FIBRE)}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "instruments", lambda _: {**few, EACH: every[ONE]})
        return diffraction(RUN, foci=51, diameters=21)


def test_a_peak_is_found_with_its_width() -> None:
    x = np.linspace(-1, 1, 201)
    bell = 3 * np.exp(-(((x - 0.2) / 0.1) ** 2))
    peak = peak_within(x, bell, 0, 0.5)
    assert peak.focus == pytest.approx(0.2)
    assert peak.height == pytest.approx(3)
    assert peak.width == pytest.approx(0.2 * np.sqrt(np.log(2)), rel=1e-2)
    assert peak.status == PeakStatus.KNOWN
    none = peak_within(x, bell, 0.4, 0.9)  # there it only falls
    assert np.isnan(none).all()
    assert none.status == PeakStatus.NO_PEAK


def test_a_shoulder_of_a_higher_peak_has_no_width() -> None:
    x = np.linspace(-1, 1, 201)
    shoulder = np.exp(-((x / 0.1) ** 2)) + 5 * np.exp(-(((x - 0.3) / 0.12) ** 2))
    peak = peak_within(x, shoulder, -0.2, 0.1)
    assert np.isnan(peak.width) or peak.height < 1.2
    assert peak.status == (PeakStatus.NO_WIDTH if np.isnan(peak.width) else PeakStatus.KNOWN)


def test_instruments_differ_in_what_is_compared_alone() -> None:
    every = instruments(RUN)
    assert [one.tracing.scheme for one in every.values()] == 3 * ["vogel"] + 2 * ["fullwave"]
    assert [one.beam.waist for one in every.values()][:3] == [None, "diffraction", "diffraction"]
    assert every[ONE].beam.wavelength == pytest.approx(0.7548, abs=1e-4)
    assert every[UNIFORM].objective.pupil == "uniform"
    assert every[FIBRE].objective.pupil is None


def test_what_waves_can_t_do_is_refused() -> None:
    with pytest.raises(ConfigError, match="for diffraction"):
        diffraction(load_config({"objective": {"numerical_aperture": 1.4}}))


def test_rulings_dim_the_glass_and_widen_its_peak(found: xr.Dataset) -> None:
    glass = found.sel(peak="glass")
    rays, rulings, waves = (glass.sel(case=name) for name in (RAYS, ONE, UNIFORM))
    assert float(rulings["peak_height"] / rays["peak_height"]) < 0.01
    assert float(rays["peak_width"]) < float(rulings["peak_width"]) < float(waves["peak_width"])
    assert float(abs(waves["peak_focus"])) < 0.11


def test_the_slope_by_rulings_goes_up_and_that_by_waves_down(found: xr.Dataset) -> None:
    change = found["slope_change"]
    assert float(change.sel(case=RAYS)) == 0
    assert float(change.sel(case=ONE)) == pytest.approx(0.094, abs=0.05)
    assert float(change.sel(case=UNIFORM)) < -0.3
    assert float(change.sel(case=FIBRE)) < -0.3


def test_it_is_written_read_told_and_drawn(found: xr.Dataset, tmp_path: Path) -> None:
    write(found, tmp_path / "diffraction.nc")
    kept = read(tmp_path / "diffraction.nc", "diffraction", RUN)
    assert "by rulings +" in summary(kept)
    with look():
        save(diffraction_figure(kept), tmp_path / "diffraction.png")
    assert (tmp_path / "diffraction.png").stat().st_size > 10_000


def test_a_status_says_why_a_number_is_missing(found: xr.Dataset) -> None:
    assert list(unexplained(found)) == []
