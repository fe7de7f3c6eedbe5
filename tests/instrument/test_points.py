"""Points come from the store where they are kept, to the bit, and else are traced."""

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from trials import trials

import octsim
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.instrument.instrument import Instrument
from octsim.instrument.point_store import PointStore
from octsim.instrument.points import Points

SMALL: dict[str, Any] = {
    "tracing": {"rays": 60},
    "spectrum": {"samples": 20},
    "sweep": {
        "diameters": {"start": "1 um", "stop": "2 um", "num": 151},
        "focus": {"slope": 0.58, "intercept": "69 nm"},
    },
}
PATHS: dict[str, Any] = {"tracing": {"scheme": "paths", "accuracy": 1e-2}}


@pytest.fixture
def count(tmp_path: Path) -> Callable[..., tuple[int, int]]:
    """Trace a sweep by the one store of a test; return how many were traced, how many found."""

    def traced(*overlays: dict[str, Any]) -> tuple[int, int]:
        points = Points(PointStore(tmp_path / "points", 1))
        octsim.detections(load_config(SMALL, *overlays), None, 2, points)
        return points.traced, points.from_cache

    return traced


def sweep(num: int) -> dict[str, Any]:
    return {"sweep": {"diameters": {"num": num}}}


@pytest.mark.parametrize("scheme", [{}, PATHS])
def test_only_new_diameters_are_traced(
    scheme: dict[str, Any], count: Callable[..., tuple[int, int]]
) -> None:
    assert count(scheme) == (151, 0)
    assert count(scheme, sweep(301)) == (150, 151)
    assert count(scheme, sweep(51)) == (0, 51)
    assert count(scheme, sweep(301)) == (0, 301)


@pytest.mark.parametrize("scheme", [{}, *trials(PATHS)])
def test_another_attenuation_traces_nothing(
    scheme: dict[str, Any], count: Callable[..., tuple[int, int]]
) -> None:
    def taken(of_neuron: str) -> dict[str, Any]:
        return {"scene": {"attenuation": {"neuron": of_neuron}}}

    assert count(scheme, sweep(11)) == (11, 0)
    # the lengths of ways are found with the first
    assert count(scheme, sweep(11), taken("100 /cm")) == (11, 0)
    assert count(scheme, sweep(11), taken("20 /mm")) == (0, 11)
    assert count(scheme, sweep(11), {"scene": {"attenuation": {"water": "7 /cm"}}}) == (0, 11)
    assert count(scheme, sweep(11)) == (0, 11)


def test_what_a_point_does_not_depend_on_traces_nothing(
    count: Callable[..., tuple[int, int]],
) -> None:
    assert count(sweep(11)) == (11, 0)
    for edit in (
        {"run": "other"},
        {"spectrum": {"wavelength": {"min": "600 nm"}}},
        {"processing": {"window": "hann"}},
        {"tracing": {"accuracy": 1e-3}},
        {"focus_law": {"fraction": {"num": 9}}},
    ):
        assert count(sweep(11), edit) == (0, 11)


@pytest.mark.parametrize(
    "edit",
    [
        {"scene": {"gap": "6 nm"}},
        {"scene": {"refractive_index": {"neuron": 1.4}}},
        {"objective": {"numerical_aperture": 1.19}},
        {"objective": {"focus_distance": "301 um"}},
        {"detector": {"core_diameter": "4.5 um"}},
        {"tracing": {"rays": 61}},
        {"tracing": {"max_intersections": 9}},
        {"tracing": {"min_amplitude": 1e-9}},
        {"sweep": {"focus": {"intercept": "70 nm"}}},
        PATHS,
    ],
)
def test_what_a_point_depends_on_traces_it_and_going_back_does_not(
    edit: dict[str, Any], count: Callable[..., tuple[int, int]]
) -> None:
    assert count(sweep(5)) == (5, 0)
    assert count(sweep(5), edit) == (5, 0)
    assert count(sweep(5)) == (0, 5)


def test_under_the_scheme_paths_a_point_depends_on_the_band_and_the_accuracy(
    count: Callable[..., tuple[int, int]],
) -> None:
    assert count(PATHS, sweep(3)) == (3, 0)
    assert count(PATHS, sweep(3), {"spectrum": {"wavelength": {"min": "640 nm"}}}) == (3, 0)
    assert count(PATHS, sweep(3), {"tracing": {"accuracy": 2e-2}}) == (3, 0)
    assert count(PATHS, sweep(3), {"tracing": {"rays": 7}}) == (0, 3)


def test_a_code_that_changes_traces_anew(
    count: Callable[..., tuple[int, int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert count(sweep(3)) == (3, 0)
    monkeypatch.setattr("octsim.instrument.instrument.source_digest", lambda *_: "edited")
    assert count(sweep(3)) == (3, 0)


@pytest.mark.parametrize(
    "edited",
    ["octsim.schemes.vogel", "octsim.instrument.build", "octsim.instrument.point_entries"],
)
def test_an_edit_of_what_traces_or_builds_or_writes_a_point_traces_anew(
    edited: str, count: Callable[..., tuple[int, int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    def code_with(edited: str) -> None:
        monkeypatch.setattr(
            "octsim.instrument.instrument.source_digest",
            lambda *modules: " ".join(f"{name} edited" * (name == edited) for name in modules),
        )

    code_with("")
    assert count(sweep(2)) == (2, 0)
    code_with(edited)
    assert count(sweep(2)) == (2, 0)
    code_with("")
    assert count(sweep(2)) == (0, 2)


def same(one: Any, other: Any) -> bool:
    return all(
        np.array_equal(x, y) if isinstance(x, np.ndarray) else x == y
        for x, y in zip(one, other, strict=True)
    )


@pytest.mark.parametrize("scheme", [{}, PATHS])
def test_a_point_depends_on_nothing_but_itself(scheme: dict[str, Any], tmp_path: Path) -> None:
    config = load_config(SMALL, scheme)
    draw = random.Random(1)
    sweep = [(draw.uniform(0.8, 2.4), draw.uniform(0.5, 1.5)) for _ in range(12)]
    alone = {point: Instrument(config).light(*point) for point in sweep}
    for part in (sweep[:5], sweep[3:9], sweep):
        shuffled = draw.sample(part, len(part))
        points = Points(PointStore(tmp_path / "points", 1))
        trace_at = Instrument(config, points).light
        assert all(same(trace_at(*point), alone[point]) for point in shuffled)
    assert points.from_cache == 9
    assert points.traced == 3


def test_a_damaged_point_is_traced_again_and_kept(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    config = load_config(SMALL)

    def light() -> tuple[Any, int]:
        points = Points(PointStore(tmp_path / "points", 1))
        return Instrument(config, points).light(1.4, 0.9), points.traced

    first, _ = light()
    (file,) = (tmp_path / "points").glob("??/*")
    spoilt = bytearray(file.read_bytes())
    spoilt[len(spoilt) // 2] ^= 1
    file.write_bytes(spoilt)
    again, traced = light()
    assert traced == 1
    assert same(first, again)
    assert "damaged" in caplog.text
    assert light()[1] == 0


def test_what_points_took_is_recorded_but_for_the_first(tmp_path: Path) -> None:
    config, store = load_config(SMALL, sweep(60)), PointStore(tmp_path / "points", 1)
    for _ in range(2):
        points = Points(store)
        octsim.detections(config, None, 2, points)
        assert points.traced + points.from_cache == 60
        points.keep()
        points.keep()
        rate = store.rates("vogel 60")
        assert rate is not None
        assert rate.points == 52
        assert 0 < rate.cpu_seconds < 10
        assert 52 * 32 < rate.bytes < 52 * 60 * 40


def test_equal_diameters_of_two_ranges_have_the_same_bits() -> None:
    def diameters(config: Config) -> list[float]:
        return list(map(float, config.sweep.diameters.values()))

    for num in (11, 76, 151, 601):
        coarse = load_config(SMALL, sweep(num))
        fine = load_config(SMALL, sweep(3 * (num - 1) + 1))
        assert diameters(coarse) == diameters(fine)[::3]
        exact = np.linspace(1, 2, num)
        assert np.abs(np.array(diameters(coarse)) - exact).max() < 1e-9  # a femtometre
