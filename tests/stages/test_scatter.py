"""Shares of a stage: each block is in one of them, and gathered they are the stage to the bit."""

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import octsim
from octsim.config.grid import Combination
from octsim.datasets.layout import Layout
from octsim.datasets.streams import Stream
from octsim.datasets.writer import write_stream
from octsim.stages.scatter import WHOLE, Share, gathered, notes_of, write_share
from octsim.stages.workload import shares_of

TINY: dict[str, Any] = {
    "tracing": {"rays": 200},
    "focus_scan": {"focus": {"num": 5}},
    "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 5}},
    "spectrum": {"samples": 64},
    "sweep": {"diameters": {"num": 9}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
}
GRIDS: dict[str, Any] = {
    "plain": {},
    "product": {"scene.gap": ["5 nm", "20 nm", "50 nm"], "tracing.rays": [50, 200]},
    "padded": {"sweep.diameters.num": [3, 9], "focus_law.fraction.num": [4, 6]},
    "schemes": {"tracing": [{"rays": 100}, {"preset": "draft"}]},
    "waves": {"tracing": [{"rays": 100}, {"preset": "exact"}]},
}
STAGES: dict[str, Callable[[octsim.Config, Share], Stream]] = {
    "focus_scan": lambda config, share: octsim.focus_scan.stream(config, share=share),
    "focus_sweep": lambda config, share: octsim.focus_sweep.stream(config, share=share),
    "detections": lambda config, share: octsim.detections.stream(config, share=share),
    "fields": lambda config, share: octsim.fields.stream(config, share=share),
    "ray_focus_sweep": lambda config, share: octsim.ray_focus_sweep.stream(config, share=share),
}

SCATTERED = [
    (stage, grid)
    for stage in STAGES
    for grid in GRIDS
    if grid == "waves" or stage not in ("fields", "ray_focus_sweep")
]
"""Stages, and the grids in which there are any."""


def scattered(stage: str, config: octsim.Config, count: int, folder: Path) -> list[Path]:
    files = []
    for number in range(1, count + 1):
        share, path = Share(number, count), folder / f"{stage}-{number}.npz"
        write_share(STAGES[stage](config, share), share, path, lambda: {"points_traced": 2})
        files.append(path)
    return files


@pytest.mark.parametrize(("stage", "grid"), SCATTERED)
def test_gathered_shares_are_the_whole_stage_to_the_bit(
    stage: str, grid: str, tmp_path: Path
) -> None:
    config = octsim.load_config(TINY, {"grid": GRIDS[grid]})
    write_stream(STAGES[stage](config, WHOLE), tmp_path / "whole.nc")
    whole = (tmp_path / "whole.nc").read_bytes()
    for count in (1, 2, 3, 40):  # more of them than blocks, too
        files = scattered(stage, config, count, tmp_path)
        write_stream(gathered(STAGES[stage](config, WHOLE), files), tmp_path / "gathered.nc")
        assert (tmp_path / "gathered.nc").read_bytes() == whole
        assert notes_of(files) == {"points_traced": 2 * count}


@given(
    sizes=st.lists(st.integers(1, 500), max_size=30),
    rays=st.lists(st.sampled_from([1, 3000, 10**6]), min_size=30, max_size=30),
    count=st.integers(1, 40),
)
def test_every_block_is_in_one_share_in_order(
    sizes: list[int], rays: list[int], count: int
) -> None:
    configs = {n: octsim.Config(tracing={"rays": n}) for n in set(rays)}  # type: ignore[arg-type]
    blocks = [
        (Combination((row,), {}, configs[n]), slice(0, size))
        for row, (size, n) in enumerate(zip(sizes, rays, strict=False))
    ]
    shares = [
        Share(number, count).among(blocks, lambda config: 1e-6 * config.tracing.rays)
        for number in range(1, count + 1)
    ]
    assert [block for share in shares for block in share] == blocks


def test_shares_take_about_as_long_as_each_other_and_as_was_asked_for() -> None:
    config = octsim.load_config(
        {"sweep": {"diameters": {"num": 9}}},
        {"grid": {"scene.gap": {"start": "0 nm", "stop": "50 nm", "num": 501}}},
        {"grid": {"tracing.rays": [1000, 30000]}, "budget": {"cpu_hours": 10}},
        {"scatter": {"minutes": 0.2}},
    )
    total = sum(9 * (1.3e-4 + 8.8e-7 * rays) * 501 for rays in (1000, 30000))
    count = shares_of(config)["detections"]
    assert count == pytest.approx(total / 12, abs=0.51)
    layout: Layout = octsim.detections.stream(config).layout
    blocks = list(layout.blocks(lambda _: 3))

    def seconds(config: octsim.Config) -> float:
        return 1.3e-4 + 8.8e-7 * config.tracing.rays

    taken = [
        sum(3 * seconds(at.config) for at, _ in Share(number, count).among(blocks, seconds))
        for number in range(1, count + 1)
    ]
    assert sum(taken) == pytest.approx(total)
    assert np.ptp(taken) < 0.2  # s, of 12


def test_what_takes_less_than_asked_for_is_one_job() -> None:
    assert set(shares_of(octsim.load_config({})).values()) == {1}


@pytest.mark.parametrize(("stage", "grid"), SCATTERED)
def test_there_are_no_more_shares_than_blocks(stage: str, grid: str) -> None:
    config = octsim.load_config(TINY, {"grid": GRIDS[grid]}, {"scatter": {"minutes": 1e-6}})
    layout = STAGES[stage](config, WHOLE).layout
    count = shares_of(config)[stage]
    assert count == len(WHOLE.blocks(layout))
    rows = {"focus_law": {"fraction": {"num": 3000}}, "tracing": {"rays": 10**7}}
    of = shares_of(octsim.load_config(rows))["focus_sweep"]
    assert of == 9  # a diameter's foci stay together, however long they take


def test_jobs_do_not_depend_on_what_was_measured_before(tmp_path: Path) -> None:
    config = octsim.load_config(
        TINY, {"scatter": {"minutes": 1e-5}, "grid": {"scene.gap": ["5 nm", "9 nm"]}}
    )
    other = octsim.load_config(config.to_dict(), {"cache": {"file": str(tmp_path / "points")}})
    assert shares_of(config) == shares_of(other)
    assert min(shares_of(config).values()) > 1


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        ("missing", "can't be read"),
        ("truncated", "can't be read"),
        ("text", "can't be read"),
        ("flipped", "can't be read"),
        ("order", "not share 1 of 2 of detections"),
        ("count", "not share 1 of 1 of detections"),
        ("stage", "not share 1 of 2 of detections"),
        ("config", r"made from another config \(objective differ\)"),
    ],
)
def test_shares_that_are_not_the_stage_s_are_refused_in_a_line(
    damage: str, message: str, tmp_path: Path
) -> None:
    config = octsim.load_config(TINY, {"grid": GRIDS["product"]})
    files = scattered("detections", config, 2, tmp_path)
    body = bytearray(files[0].read_bytes())
    if damage == "missing":
        files[0].unlink()
    elif damage == "truncated":
        files[0].write_bytes(body[: len(body) // 2])
    elif damage == "text":
        files[0].write_bytes(b"somebody's notes")
    elif damage == "flipped":
        body[body.index(b"amplitude.npy") + 300] ^= 1
        files[0].write_bytes(body)
    elif damage == "order":
        files.reverse()
    elif damage == "count":
        files.pop()
    elif damage == "stage":
        files = scattered("focus_scan", config, 2, tmp_path)
    else:
        config = octsim.load_config(config.to_dict(), {"objective": {"magnification": 21}})
    with pytest.raises(octsim.DatasetError, match=message) as caught:
        write_stream(gathered(STAGES["detections"](config, WHOLE), files), tmp_path / "whole.nc")
    assert "remove it and run again" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "whole.nc").exists()


def test_nothing_is_unpickled_from_a_share(tmp_path: Path) -> None:
    config = octsim.load_config(TINY)
    (file,) = scattered("detections", config, 1, tmp_path)
    with zipfile.ZipFile(file) as share:
        index = json.loads(share.read("index.json"))
    with zipfile.ZipFile(file, "w") as share, share.open("0/focus.npy", "w") as member:
        np.save(member, np.array([print], object), allow_pickle=True)
        member.close()
        index["parts"] = [[[], 0, 1, {"focus": [["diameter"], {}]}]]
        share.writestr("index.json", json.dumps(index))
    with pytest.raises(octsim.DatasetError, match="allow_pickle"):
        list(gathered(STAGES["detections"](config, WHOLE), [file]).parts)
