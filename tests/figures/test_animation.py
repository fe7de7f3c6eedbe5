"""The animation of a focus scan: the same bytes each time, small, a frame a focus."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from PIL import Image, ImageSequence

import octsim
from octsim.figures import animation
from octsim.figures.animation import animate

FEW = {
    "tracing": {"rays": 100},
    "spectrum": {"samples": 32},
    "focus_scan": {"focus": {"start": "-0.5 um", "stop": "3 um", "num": 5}},
}


@pytest.fixture(scope="module")
def scan() -> xr.Dataset:
    return octsim.focus_scan(octsim.load_config(FEW))


def frames_in(file: Path) -> list[NDArray[np.uint8]]:
    with Image.open(file) as moving:
        return [np.asarray(frame.convert("RGB")) for frame in ImageSequence.Iterator(moving)]


def test_it_has_a_frame_for_each_focus_and_is_small(scan: xr.Dataset, tmp_path: Path) -> None:
    for name in ("a.gif", "b.gif"):
        animate(scan, tmp_path / name)
    held = (tmp_path / "a.gif").read_bytes()
    assert held == (tmp_path / "b.gif").read_bytes()
    # 24 frames stay below a megabyte
    assert len(held) < 5 / 24 * 1e6
    assert [file.name for file in sorted(tmp_path.iterdir())] == ["a.gif", "b.gif"]
    frames = frames_in(tmp_path / "a.gif")
    assert len(frames) == 5
    # the right half has the dot, the left one the rays: both move
    for one, other in pairwise(frames):
        for half in (slice(None, 320), slice(320, None)):
            assert (one[:, half] != other[:, half]).any()


def test_a_long_scan_has_no_more_frames_than_are_looked_at(
    scan: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(animation, "_FRAMES", 2)
    animate(scan, tmp_path / "a.gif")
    assert len(frames_in(tmp_path / "a.gif")) == 2


def test_a_scan_over_a_grid_is_refused_in_a_line(tmp_path: Path) -> None:
    grid = {"scene.gap": ["5 nm", "20 nm"]}
    scan = octsim.focus_scan(octsim.load_config(FEW, {"grid": grid}))
    with pytest.raises(octsim.DatasetError, match="over a grid of gap; it is of one config"):
        animate(scan, tmp_path / "a.gif")
    assert not list(tmp_path.iterdir())
