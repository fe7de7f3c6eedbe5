"""Captions of figures as text, to be read without them."""

from matplotlib.figure import Figure

from octsim.config.models import Config
from octsim.datasets.gallery import CAPTIONS, Drawn
from octsim.figures.style import told_in


def caption_of(one: Drawn, figure: Figure, config: Config) -> str:
    """Return the caption of a figure.

    What it shows, the run, the files of the datasets that it is drawn from, what its legends say,
    and what is written beside it: a paragraph each.

    Parameters
    ----------
    one : Drawn
        The figure's row.
    figure : Figure
        The same, drawn.
    config : Config
        Of the run.
    """
    shows = CAPTIONS[one.figure.name]
    files = " and ".join(f"{name}.nc" for name in one.sources)
    source = f"Run {config.run}, drawn from {files}." if files else f"Run {config.run}."
    entries = _entries(figure)
    paragraphs = [
        f"{shows[:1].upper()}{shows[1:]}.",
        source,
        *([f"Legend: {'; '.join(entries)}."] if entries else []),
        "\n".join(told_in(figure)),
    ]
    return "\n\n".join(paragraph for paragraph in paragraphs if paragraph) + "\n"


def _entries(figure: Figure) -> list[str]:
    """Return what the legends of a figure say, each entry once."""
    own = [axes.get_legend() for axes in figure.axes]
    legends = [legend for legend in (*own, *figure.legends) if legend]
    return list(
        dict.fromkeys(
            text.get_text().replace("\n", " ") for legend in legends for text in legend.get_texts()
        )
    )
