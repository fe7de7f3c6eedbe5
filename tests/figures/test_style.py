"""A figure is laid out once, drawn once for each form, and stays what it was."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import RendererSVG
from matplotlib.figure import Figure

from octsim.base.errors import FileError
from octsim.figures.style import look, save


@pytest.fixture
def figure() -> Iterator[Figure]:
    with look():
        figure = Figure()
        figure.subplots().set_title("A line")
        figure.axes[0].plot([1, 2], [3, 4])
        yield figure


def test_it_is_laid_out_once_and_drawn_once_for_each_form(
    figure: Figure, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Figure] = []
    draw = Figure.draw

    def counted(self: Figure, renderer: object) -> None:
        drawn.append(self)
        draw(self, renderer)  # type: ignore[arg-type]

    monkeypatch.setattr(Figure, "draw", counted)
    counts = []
    for form in ("png", "svg", "pdf"):
        drawn.clear()
        save(figure, tmp_path / f"line.{form}")
        counts.append(len(drawn))
    assert counts == [2, 1, 1]
    left = figure.axes[0].get_position().x0
    assert left != pytest.approx(Figure().subplots().get_position().x0)  # it was laid out


def test_it_has_its_resolution_and_canvas_after_a_file_that_could_not_be_written(
    figure: Figure, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    figure.dpi = 80
    save(figure, tmp_path / "line.png")
    before = (tmp_path / "line.png").read_bytes()

    def full(_: RendererSVG) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(RendererSVG, "finalize", full)
    with pytest.raises(FileError, match=r"line\.svg: can't be written"):
        save(figure, tmp_path / "line.svg")
    assert figure.dpi == 80
    assert type(figure.canvas) is FigureCanvasAgg
    save(figure, tmp_path / "line.png")
    assert (tmp_path / "line.png").read_bytes() == before
