"""What a page is made of is in the package that users install."""

import zipfile
from pathlib import Path

from hatchling.builders.wheel import WheelBuilder

ROOT = Path(__file__).parents[2]
ASSETS = ROOT / "octsim" / "report" / "assets"


def test_a_wheel_has_every_asset(tmp_path: Path) -> None:
    (built,) = WheelBuilder(str(ROOT)).build(directory=str(tmp_path), versions=["standard"])
    with zipfile.ZipFile(built) as wheel:
        names = set(wheel.namelist())
    expected = {file.relative_to(ROOT).as_posix() for file in ASSETS.rglob("*") if file.is_file()}
    assert expected
    assert expected <= names


def test_a_script_can_t_end_the_element_that_it_stands_in() -> None:
    for file in ASSETS.rglob("*.js"):
        assert "</script" not in file.read_text("utf-8").lower()


def test_an_own_script_is_no_longer_than_a_module() -> None:
    for file in ASSETS.glob("*"):
        if file.is_file():
            assert len(file.read_text("utf-8").splitlines()) <= 300
