"""The search for the best instrument: its errors against closed forms and other ways."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from missing import unexplained
from numpy.typing import NDArray

from octsim.base.errors import ConfigError, OctsimError
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.figures.design import design_figure
from octsim.figures.style import look, save
from octsim.instrument.instrument import Instrument
from octsim.phase.estimators.series import series_phases
from octsim.schemes.light import AccuracyStatus
from octsim.studies.design import settings
from octsim.studies.design.cell import OFFSETS, SIDES, Seen
from octsim.studies.design.criteria import CriterionStatus, peak
from octsim.studies.design.settings import PARAMETERS
from octsim.studies.design.study import best, design, doubts, summary
from octsim.studies.design.uncertainty import ESTIMATORS, Known, Neuron, known

Array = NDArray[np.float64]
N, K = 1.39, Config().spectrum.wavenumbers()
SMALL: dict[str, Any] = {
    "sweep": {"focus": {"slope": 0.581, "intercept": "69 nm"}},
    "design": {
        "diameters": {"start": "1 um", "stop": "1.1 um", "num": 2},
        "fills": [0.5, 1.0],
        "focus_offsets": {"start": "-0.2 um", "stop": "0.2 um", "num": 3},
        "apertures": [],
        "bands": [{"min": "650 nm", "max": "800 nm"}],
    },
}
CONFIG = load_config(SMALL)
NAMES = list(ESTIMATORS)


def plates(diameter: Array, index: float = N, visibility: float = 0.6) -> Array:
    """Return spectra of two reflections, (D, K), whose phase is known: 2 n d k."""
    turn: Array = 2 * index * np.asarray(diameter)[:, np.newaxis] * K
    return 1 + visibility * np.cos(turn)


def of_plates(photons: float, index_off: float = 0.0) -> Known:
    """Return what is known of plates 1.4 um apart whose index may be off."""
    diameter = 1.4
    off = {name: plates(diameter + SIDES) for name in PARAMETERS if name != "diameter"}
    off["neuron"] = plates(diameter + SIDES, N + index_off)
    seen = Seen(plates(diameter + OFFSETS), off, 0.0, AccuracyStatus.REACHED)
    return known(seen, Neuron(diameter, N, K, seen.around), photons, 0.02, (1, 0))


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    return design(CONFIG, None, 2)


def test_slopes_of_plates_are_those_of_the_two_beams() -> None:
    slope = of_plates(1e8).slope
    # the middle of the band, 2 n k; what follows the diameter is that to rounding
    assert slope[NAMES.index("sinusoid_following")] == pytest.approx(N * (K[0] + K[-1]), rel=1e-6)
    assert slope[NAMES.index("sinusoid")] == pytest.approx(N * (K[0] + K[-1]), rel=1e-2)


def test_an_index_that_is_off_moves_the_slope_by_as_much() -> None:
    neuron = PARAMETERS.index("neuron")
    relative = of_plates(1e8, 0.002).relative
    assert relative[NAMES.index("sinusoid_following"), neuron] == pytest.approx(0.002 / N, rel=0.02)
    others = np.delete(relative, neuron, axis=1)[NAMES.index("sinusoid_following")]
    assert others.max() < 1e-5


def test_the_statistical_error_of_a_weak_fringe_is_the_closed_form_s() -> None:
    photons, visibility = 1e6, 0.6
    found = of_plates(photons)
    # least squares of many equal samples: sqrt(2 / N) / V on the phase, 2 n k_mid a diameter
    closed = 1e3 * np.sqrt(2 / photons) / visibility / (N * (K[0] + K[-1]))
    # within the draws' 9 %, three times
    assert found.statistical[NAMES.index("sinusoid")] == pytest.approx(closed, rel=0.3)


def test_no_estimator_is_better_than_the_bound_by_more_than_the_draws_scatter() -> None:
    known_by_all = of_plates(1e6)
    assert (known_by_all.statistical > 0.73 * known_by_all.bound).all()


def test_the_bound_falls_as_the_root_of_the_photons() -> None:
    assert of_plates(1e4).bound == pytest.approx(10 * of_plates(1e6).bound, rel=1e-9)


def test_without_a_fringe_nothing_is_known() -> None:
    flat = np.ones((5, K.size))
    off = {name: np.ones((2, K.size)) for name in PARAMETERS if name != "diameter"}
    seen = Seen(flat, off, 0.0, AccuracyStatus.REACHED)
    nothing = known(seen, Neuron(1.4, N, K, flat), 1e6, 0.02, (1, 0))
    assert np.isnan(nothing.slope).all()
    assert np.isnan(nothing.statistical).all()
    assert np.isnan(nothing.bound)


def test_slopes_are_those_of_instruments_that_share_nothing(found: xr.Dataset) -> None:
    at = found.sel(
        fill=1.0, aperture=1.2, band="650-900 nm", diameter=1.1, focus_offset=0.2,
        estimator="sinusoid",
    )  # fmt: skip
    overlay = {"tracing": {"preset": "exact"}, "objective": {"pupil": {"gaussian": 1.0}}}
    own = Instrument(load_config(SMALL, overlay))
    step, focus = 2e-3, 0.581 * 1.1 + 0.069 + 0.2
    spectra = own.spectra([1.1 - step, 1.1 + step], [focus, focus])
    sinusoid = settings.waves(CONFIG, 1.2).processing.model_copy(update={"estimator": "sinusoid"})
    before, after = series_phases(spectra, K, N * 1.1, sinusoid)
    assert float(at["phase_slope"]) == pytest.approx((after - before) / (2 * step), rel=5e-3)


def test_total_errors_are_of_both_kinds_together(found: xr.Dataset) -> None:
    both = np.hypot(found["statistical_error"], found["systematic_error"])
    assert np.allclose(both, found["total_error"], equal_nan=True)
    by_tolerances = np.sqrt((found["slope_error"] ** 2).sum("parameter")) * 1.0  # of 1 nm
    assert np.allclose(by_tolerances, found["systematic_error"])


def test_spectra_are_as_accurate_as_asked(found: xr.Dataset) -> None:
    assert (found["accuracy_status"] == AccuracyStatus.REACHED).all()
    assert float(found["intensity_error"].max()) <= settings.ACCURACY


def test_the_summary_names_the_best_setting(found: xr.Dataset) -> None:
    at = best(found)
    assert float(found["rms_error"].sel(at)) == float(found["rms_error"].min())
    assert f"fill of {at['fill']:g}" in summary(found)
    alone = found.sel(focus_offset=[at["focus_offset"]])
    (doubt,) = doubts(alone)
    assert "end of design.focus_offsets" in doubt


def test_a_peak_within_the_scan_is_found_and_one_at_its_end_is_none() -> None:
    foci = np.linspace(-1, 1, 9)
    inside = peak(foci, 3 - (foci - 0.3) ** 2)
    assert inside.at == pytest.approx(0.3)
    assert inside.prominence > 0
    end, none = CriterionStatus.AT_THE_END, CriterionStatus.NO_FRINGE
    for values, why in ((foci, end), (-foci, end), (np.full(9, np.nan), none)):
        at, prominence, status = peak(foci, values)
        assert np.isnan(at)
        assert prominence == 0
        assert status == why


def test_an_aperture_beyond_the_water_is_refused_by_its_key() -> None:
    config = load_config(SMALL, {"design": {"apertures": [1.33]}})
    with pytest.raises(OctsimError, match=r"design\.apertures 1\.33 .*below the index of water"):
        design(config)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"fills": [0]}, "design.fills.0: 0 given"),
        ({"fills": []}, "design.fills"),
        ({"fills": [1.0, 1.0]}, "stands twice"),
        ({"bands": [{"min": "900 nm", "max": "650 nm"}]}, "design.bands.0.min: 0.9 um given"),
        ({"focus_offsets": {"start": "1 um", "stop": "0 um"}}, "design.focus_offsets.start"),
        ({"photon": 1}, "design.photon: unknown key"),
    ],
)
def test_what_is_wrong_is_said_in_a_line(given: dict[str, Any], said: str) -> None:
    with pytest.raises(ConfigError) as error:
        load_config({"design": given})
    assert said in str(error.value)
    assert len(str(error.value).splitlines()) == 1


def test_the_figure_is_the_same_bytes_each_time(found: xr.Dataset, tmp_path: Path) -> None:
    for copy in ("a", "b"):
        with look():
            save(design_figure(found), tmp_path / f"{copy}.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_a_status_says_why_a_number_is_missing(found: xr.Dataset) -> None:
    assert list(unexplained(found)) == []
