"""What a command has found of a grid is not looked for again by the processes of its run."""

import json
from pathlib import Path
from typing import Any

import pytest

from octsim.config import grid_values
from octsim.config.grid import combinations, remarks
from octsim.config.handed import FOLDER
from octsim.config.load import load_and_tell, load_checked, load_config
from octsim.config.units import parse_length

GRIDS: list[dict[str, Any]] = [
    {"scene.gap": {"start": "0 nm", "stop": "10 nm", "num": 4}, "processing.window": ["hann"]},
    {"combine": "zip", "scene.gap": ["1 nm", "0.002 um"], "tracing": [{"rays": 9}, {"rays": 100}]},
    {"objective.zernike.spherical": ["0 nm", "1 nm"], "sweep.diameters.num": [2, 51]},
]


def none_is_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    def looked_at(*_: object, **__: object) -> None:
        raise AssertionError("a combination is looked at again")

    for name in ("ConfigsAt", "impossible", "combinations"):
        monkeypatch.setattr(grid_values, name, looked_at)


@pytest.mark.parametrize("grid", GRIDS)
def test_a_run_takes_what_its_command_has_found_of_a_grid(
    grid: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = {"run": "mine", "grid": grid}
    alone = load_and_tell(given)
    monkeypatch.setenv(FOLDER, str(tmp_path))
    assert load_and_tell(given) == alone
    none_is_looked_at(monkeypatch)
    assert load_and_tell(given) == alone
    assert load_checked(given) == alone[0]


def test_of_another_config_nothing_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(FOLDER, str(tmp_path))
    for gap in ("1 nm", "2 nm"):
        config = load_config({"grid": {"scene.gap": [gap, "5 nm"]}})
        assert [at.config.scene.gap for at in combinations(config)] == [parse_length(gap), 0.005]
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize("damage", ["", "[]", "null", "[{"])
def test_what_can_not_be_read_is_looked_for(
    damage: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = {"grid": GRIDS[0]}
    monkeypatch.setenv(FOLDER, str(tmp_path))
    config = load_checked(given)
    load_and_tell(given)
    (file,) = tmp_path.iterdir()
    assert len(json.loads(file.read_bytes())) == 2
    file.write_text(damage)
    assert load_checked(given) == config


@pytest.mark.parametrize("grid", GRIDS)
def test_what_is_said_of_a_grid_while_it_is_checked_is_what_is_said_of_it_after(
    grid: dict[str, Any],
) -> None:
    coarse = {"start": "1 um", "stop": "9 um", "num": 20}
    config, said = load_and_tell({"grid": grid, "sweep": {"diameters": coarse}})
    expected = remarks(config)
    assert expected
    assert said[: len(expected)] == expected
