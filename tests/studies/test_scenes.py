"""Scenes about the configured one: what is faint or far does little, what is unknown is said."""

import numpy as np
import pytest
import xarray as xr
from missing import unexplained

from octsim.base.errors import ConfigError
from octsim.config.load import load_config
from octsim.figures.scenes import scenes_figure
from octsim.figures.style import look
from octsim.studies.scenes import cases as listed
from octsim.studies.scenes.cases import AS_CONFIGURED, SCHEMES, Case, CaseStatus, cases
from octsim.studies.scenes.study import scenes, summary
from octsim.studies.scenes.tolerated import TOLERANCE, ToleratedStatus, tolerated, tolerated_status

RUN = load_config({
    "spectrum": {"samples": 100},
    "tracing": {"rays": 300},
    "sweep": {
        "diameters": {"start": "1.3 um", "stop": "1.5 um", "num": 3},
        "focus": {"slope": 0.581, "intercept": "69 nm"},
    },
})  # fmt: skip


@pytest.fixture(scope="module")
def few() -> xr.Dataset:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(listed, "_THICKNESSES", (1, 100))
        patch.setattr(listed, "_MEMBRANES", (5,))
        patch.setattr(listed, "_INDICES", (1.33, 1.44))
        patch.setattr(listed, "_NEIGHBOURS", (2000,))
        patch.setattr(listed, "_ELEVATIONS", (1.0,))
        patch.setattr(listed, "_COVERS", (20,))
        return scenes(RUN, number=2)


def test_every_case_differs_from_the_config_by_one_thing() -> None:
    every = cases(RUN)
    assert every[0].name == AS_CONFIGURED
    names = [case.name for case in every]
    assert len(set(names)) == len(names)
    for case in every[1:]:
        for config in case.by:
            assert config is None or config.objective == RUN.objective
            assert config is None or config.detector == RUN.detector
            assert config is None or config.sweep == RUN.sweep


def test_a_membrane_moves_the_phase_and_hardly_the_slope(few: xr.Dataset) -> None:
    one = few.sel(case="membrane of n 1.46, 5 nm", estimator="sinusoid", focus_mode="follows")
    for scheme in ("paths", "fullwave"):
        assert np.abs(one["scene_phase_change"].sel(scheme=scheme)).min() > 0.1
        assert np.abs(one["scene_slope_change"].sel(scheme=scheme)).max() < 0.3


def test_changes_are_from_the_same_scheme_s_configured_scene(few: xr.Dataset) -> None:
    slope, change = few["scene_phase_slope"], few["scene_slope_change"]
    np.testing.assert_allclose(change.values, (slope - slope.isel(case=0)).values)
    assert (few["scene_mean_change"].isel(case=0) == 0).all()


def test_a_far_neighbour_a_thin_sheath_and_a_far_cover_do_little(few: xr.Dataset) -> None:
    held = few.sel(estimator="sinusoid", focus_mode="held")["scene_worst_change"]
    assert float(held.sel(case="neighbour beside at 2000 nm", scheme="paths")) < 5e-3
    # waves are wider than rays
    assert 5e-3 < float(held.sel(case="neighbour beside at 2000 nm", scheme="fullwave")) < 3
    assert float(held.sel(case="myelin of n 1.44, 1 nm", scheme="fullwave")) < 0.1
    assert float(held.sel(case="cover glass at 20 µm", scheme="paths")) < 0.3


def test_what_no_scheme_of_the_dataset_does_is_said(few: xr.Dataset) -> None:
    status = few["case_status"]
    cover = status.sel(case="cover glass at 20 µm", scheme="fullwave")
    assert cover == CaseStatus.TOO_LONG
    tilted = status.sel(case="elevation 1 °")
    assert tilted.sel(scheme="fullwave") == CaseStatus.NOT_BY_THIS_SCHEME
    assert tilted.sel(scheme="vogel") == CaseStatus.MEASURED
    unknown = few["scene_phase_slope"].isnull().all(("focus_mode", "estimator", "diameter"))
    assert (unknown | (status == CaseStatus.MEASURED)).all()
    assert few["scheme"].values.tolist() == list(SCHEMES)


def test_tolerated_is_what_moves_the_held_slope_by_the_tolerance(few: xr.Dataset) -> None:
    held = few.sel(focus_mode="held", estimator="sinusoid", scheme="fullwave")
    thin, thick = (f"myelin of n 1.44, {t} nm" for t in (1, 100))
    slope = held["scene_phase_slope"]
    rate = (slope.sel(case=thick) - slope.sel(case=thin)) / 99
    expected = TOLERANCE * slope.sel(case=thin).mean() / np.sqrt((rate**2).mean())
    assert float(held["tolerated"].sel(case=thin)) == pytest.approx(float(expected))
    assert np.isnan(held["tolerated"].sel(case="cover glass at 20 µm"))


def test_a_scene_without_a_swept_cylinder_is_refused_in_a_line() -> None:
    plates = load_config({
        "scene": {
            "layers": ["glass", {"medium": "water", "thickness": "swept"}, "glass"],
            "cylinders": [],
        },
        "sweep": {"focus": {"slope": 0, "intercept": "0.5 um"}},
    })  # fmt: skip
    with pytest.raises(ConfigError, match=r"scene\.cylinders: nothing in it is swept"):
        cases(plates)


def test_the_figure_and_the_summary_are_made(few: xr.Dataset) -> None:
    assert summary(few).startswith("scenes: the slope at a held focus moves most by ")
    with look():
        figure = scenes_figure(few)
    assert len(figure.axes) == 2


def test_a_status_says_why_a_number_is_missing(few: xr.Dataset) -> None:
    assert list(unexplained(few)) == []


def test_what_is_tolerated_is_known_of_two_cases_whose_slopes_differ() -> None:
    alone, *two = (
        Case(quantity, float(value), "nm", (None,))
        for value, quantity in enumerate(("gap", "myelin", "myelin"))
    )
    every = [alone._replace(quantity=AS_CONFIGURED), alone, *two]
    slope = np.full((4, 1, 2, 2, 3), 24.0)
    known = {"other": 25.0, "same": 24.0, "none": np.nan}
    codes = {"other": ToleratedStatus.KNOWN, "same": ToleratedStatus.NO_CHANGE}
    for name, value in known.items():
        slope[3] = value
        found = tolerated_status(every, slope)[:, 0].tolist()
        one = ToleratedStatus.NO_OTHER_CASE
        code = codes.get(name, ToleratedStatus.NO_SLOPE)
        assert found == [one, one, code, code]
        assert np.isfinite(tolerated(every, slope)[:, 0]).tolist() == [
            status == ToleratedStatus.KNOWN for status in found
        ]
