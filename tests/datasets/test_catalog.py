"""The catalog keeps the rule of the house: the name of a dataset says where all of it is."""

import ast
from pathlib import Path

import pytest

from octsim.base.named import named
from octsim.datasets.catalog import CATALOG, STAGES, TARGETS
from octsim.datasets.gallery import SPIRAL, all_run_figures

ROOT = Path(__file__).parents[2]
ROOMS = sorted(file.parent for file in (ROOT / "octsim").glob("*/__init__.py"))
STUDIES = sorted(file.parent for file in (ROOT / "octsim" / "studies").glob("*/__init__.py"))
OF_THE_CALIBRATION = {"expansion", "action_potential"}
# of no dataset, and of a dataset over a grid
FIGURES_OF_THEIR_OWN = {
    "figure_1": "octsim.figures.beam", "grid": "octsim.figures.grid",
    "scene": "octsim.figures.scene", "aperture": "octsim.figures.aperture",
}  # fmt: skip


def module_of(function: str) -> str:
    return function.partition(":")[0]


def test_a_run_s_datasets_are_made_in_modules_of_their_names() -> None:
    for name in STAGES:
        assert CATALOG[name].module == f"octsim.stages.{name}"


def test_datasets_beside_a_run_are_made_in_rooms_of_their_names() -> None:
    for name in TARGETS:
        own = f"octsim.studies.{name}.study"
        beside = f"octsim.studies.calibration.{name}"
        assert CATALOG[name].module == (beside if name in OF_THE_CALIBRATION else own)


@pytest.mark.parametrize("name", CATALOG)
def test_a_figure_is_drawn_in_the_module_of_its_dataset(name: str) -> None:
    for figure in CATALOG[name].figures:
        expected = FIGURES_OF_THEIR_OWN.get(figure.name, f"octsim.figures.{name}")
        assert module_of(figure.draw) == expected, figure.name


def test_the_figure_of_no_dataset_is_of_the_beam() -> None:
    assert module_of(SPIRAL.draw) == FIGURES_OF_THEIR_OWN[SPIRAL.name]
    assert [name for name, drawn in all_run_figures().items() if not drawn.sources] == [SPIRAL.name]


@pytest.mark.parametrize("name", CATALOG)
def test_what_a_row_names_is_there(name: str) -> None:
    row = CATALOG[name]
    given = (row.make, row.summary, row.doubts, *(figure.draw for figure in row.figures))
    assert all(callable(named(function)) for function in given if function)


@pytest.mark.parametrize("name", CATALOG)
def test_a_dataset_is_tested_in_a_file_of_its_name(name: str) -> None:
    room = "studies" if CATALOG[name].beside else "stages"
    assert (ROOT / "tests" / room / f"test_{name}.py").is_file()


def test_a_dataset_comes_after_those_that_it_is_made_from() -> None:
    # so that there is no cycle
    made: list[str] = []
    for row in CATALOG.values():
        assert set(row.after) <= set(made), row.name
        made.append(row.name)


@pytest.mark.parametrize("name", CATALOG)
def test_a_figure_is_of_its_dataset_and_of_what_is_made_by_then(name: str) -> None:
    row = CATALOG[name]
    # datasets of one job are made before any of their figures, and all of a run before its own
    job = {one.name for one in CATALOG.values() if one.rule == row.rule}
    job |= set() if row.beside else set(STAGES)
    for figure in row.figures:
        of = figure.of or (name,)
        assert name in of
        assert set(of) <= job | set(row.after), figure.name


def test_figures_have_names_of_their_own() -> None:
    names = [figure.name for row in CATALOG.values() for figure in row.figures]
    assert len({SPIRAL.name, *names}) == 1 + len(names)


@pytest.mark.parametrize("room", [*ROOMS, *STUDIES], ids=lambda room: room.name)
def test_a_room_says_in_a_line_what_it_is(room: Path) -> None:
    said = ast.get_docstring(ast.parse((room / "__init__.py").read_text(encoding="utf-8")))
    assert said
    assert len(said.splitlines()) == 1


def test_a_module_is_no_longer_than_300_lines() -> None:
    lengths = {
        str(file.relative_to(ROOT)): len(file.read_text(encoding="utf-8").splitlines())
        for file in (ROOT / "octsim").rglob("*.py")
    }
    assert {name: lines for name, lines in lengths.items() if lines > 300} == {}
