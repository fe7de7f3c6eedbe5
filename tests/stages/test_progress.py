"""How far a stage is stands in its log, and changes nothing of it."""

import logging
from collections.abc import Iterator
from pathlib import Path

import pytest

import octsim
from octsim.base import compile_time, say
from octsim.config.load import load_config
from octsim.datasets.streams import Part, Stream, in_memory
from octsim.stages import progress


def test_a_log_tells_how_far_a_stage_is_and_how_long_it_takes(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(progress, "_BETWEEN_LINES", 0.0)
    config = load_config(
        {
            "tracing": {"rays": 50},
            "sweep": {"diameters": {"num": 5}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
            "grid": {"scene.gap": ["1 nm", "2 nm", "3 nm"]},
        }
    )
    with caplog.at_level(logging.INFO):
        watched = in_memory(progress.watched(octsim.detections.stream(config)))
    assert watched.identical(octsim.detections(config))
    said = [record.getMessage() for record in caplog.records]
    assert any("detections:" in line and "10/15" in line and "point/s" in line for line in said)


def test_a_bar_begins_when_tracing_does(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(progress, "_BETWEEN_LINES", 0.0)
    compile_time.compiled_for()
    config = load_config({"tracing": {"rays": 50}, "focus_scan": {"focus": {"num": 5}}})
    stream = octsim.focus_scan.stream(config)

    def compiling() -> Iterator[Part]:
        for part in stream.parts:
            compile_time._Spent.seconds += 1000.0
            yield part

    with caplog.at_level(logging.INFO):
        list(progress.watched(Stream(stream.layout, compiling())).parts)
    # it began, as far as the bar knows, in the future
    assert any("5/5 [-1" in record.getMessage() for record in caplog.records)


def test_how_far_a_job_is_stands_where_the_screen_looks(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(say._Job, "name", "focus_scan")
    config = load_config({"tracing": {"rays": 50}, "focus_scan": {"focus": {"num": 5}}})
    list(progress.watched(octsim.focus_scan.stream(config)).parts)
    assert not list(tmp_path.iterdir())  # nobody looks
    monkeypatch.setenv(say.PROGRESS, str(tmp_path))
    list(progress.watched(octsim.focus_scan.stream(config)).parts)
    assert (tmp_path / "focus_scan").read_text() == "5 of 5 points"
    assert progress.words(25, 100, 50.0) == "25 of 100 points, 02:30 left"


def test_what_is_short_is_not_told_of(caplog: pytest.LogCaptureFixture) -> None:
    config = load_config({"tracing": {"rays": 50}, "focus_scan": {"focus": {"num": 5}}})
    with caplog.at_level(logging.INFO):
        in_memory(progress.watched(octsim.focus_scan.stream(config)))
    assert not caplog.records
