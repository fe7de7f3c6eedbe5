"""One look for all figures: colour-blind safe, told apart in grey, units on every axis."""

import json
import logging
import textwrap
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.collections import Collection, QuadMesh
from matplotlib.figure import Figure
from matplotlib.layout_engine import PlaceHolderLayoutEngine
from matplotlib.lines import Line2D

from octsim.base.files import whole
from octsim.phase.fringe_status import doubts_of
from octsim.schemes.table import SCHEMES, UNIT_OF_INTENSITY

# Okabe and Ito's colours; the order keeps neighbours apart in lightness too.
BLUE, ORANGE, GREEN, BLACK = "#0072B2", "#E69F00", "#009E73", "#000000"
PURPLE, VERMILION, SKY = "#CC79A7", "#D55E00", "#56B4E9"
# green is the ideal spectrum's, black the prediction's
_COMPONENTS = (BLUE, ORANGE, PURPLE, VERMILION, SKY)
_LETTERS = 110  # of a line below a figure
_SYMBOLS = {"um": "µm", "um-1": "1/µm", "1": ""}
logging.getLogger("fontTools").setLevel(logging.WARNING)  # each step of it is no word for a log
_MANY = 5000
_TOLD = "told"  # marks what is written beside a figure, for its caption
# what a file would say of its making, and so be other bytes each time
_UNDATED: Mapping[str, dict[str, Any]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None},
    ".pdf": {"CreationDate": None},
}
_CANVAS = {".png": FigureCanvasAgg, ".svg": FigureCanvasSVG, ".pdf": FigureCanvasPdf}
_LOOK: Any = {
    "axes.formatter.useoffset": False,  # ticks say what they are
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "figure.constrained_layout.use": True,
    "figure.dpi": 150,
    "figure.figsize": (6.4, 4.0),
    "font.size": 10,
    "grid.alpha": 0.25,
    "legend.edgecolor": "none",
    "lines.linewidth": 1.5,
    "pdf.fonttype": 42,  # text stays text, that can be searched and edited
    "svg.hashsalt": "octsim",
}


def look() -> AbstractContextManager[None]:
    """Return the context in which figures are made and saved, whatever a matplotlibrc says."""
    return mpl.rc_context({**mpl.rcParamsDefault, **_LOOK})


def component_colour(component: int) -> str:
    """Colour of a component of the Fourier transform, the same in every figure."""
    return _COMPONENTS[(component - 1) % len(_COMPONENTS)]


def label(variable: xr.DataArray, name: str | None = None) -> str:
    """Axis label of a variable: its long name, or another, with its unit."""
    text = name or str(variable.attrs["long_name"])
    units = str(variable.attrs["units"])
    symbol = _SYMBOLS.get(units, units)
    text = text[:1].upper() + text[1:]
    return f"{text} ({symbol})" if symbol else text


def unit_of_intensity(dataset: xr.Dataset) -> str:
    """Return what an intensity of 1 is, by the scheme of a dataset of a plain config."""
    scheme = json.loads(dataset.attrs["config"])["tracing"]["scheme"]
    return UNIT_OF_INTENSITY[SCHEMES[scheme].light]


def title(dataset: xr.Dataset, text: str) -> str:
    """Title of a figure: what it shows, and of which run."""
    return f"{text} · run {json.loads(dataset.attrs['config'])['run']}"


def tell_doubts(figure: Figure, dataset: xr.Dataset) -> None:
    """Write below a figure which spectra have no fringe, or a doubtful one, and what to do."""
    if "fringe_status" not in dataset:
        return
    tell(figure, doubts_of(dataset["fringe_status"].values, "diameters"))


def tell(figure: Figure, said: Sequence[str]) -> None:
    """Write lines below a figure, or above one with a legend there, if there are some."""
    if said:
        lines = [line for one in said for line in textwrap.wrap(one, _LETTERS)]
        write = figure.suptitle if figure.legends else figure.supxlabel
        write("\n".join(lines), color=VERMILION, fontsize=7, gid=_TOLD)


def told_in(figure: Figure) -> list[str]:
    """Return the lines that are written below a figure, or above it."""
    return [
        line
        for text in figure.texts
        if text.get_gid() == _TOLD
        for line in text.get_text().splitlines()
    ]


def save(figure: Figure, path: Path) -> None:
    """Write a figure as its path's ending says, whole or not at all, the same bytes each time.

    What has very many points is pixels in an SVG or a PDF too, so that its size does not grow with
    the data. All forms have the layout that is found first.

    Raises
    ------
    FileError
        If the file can't be written.
    """
    FigureCanvasAgg(figure)
    for artist in figure.findobj(_has_many_points):
        artist.set_rasterized(True)
    if not isinstance(figure.get_layout_engine(), PlaceHolderLayoutEngine | None):
        figure.draw_without_rendering()  # which takes as long as the drawing
        figure.set_layout_engine("none")
    # not savefig, which draws twice
    form, canvas, dpi = path.suffix.removeprefix("."), _CANVAS[path.suffix](figure), figure.dpi
    try:
        with whole(path) as temporary:
            getattr(canvas, f"print_{form}")(temporary, metadata=_UNDATED[path.suffix])
    finally:
        figure.dpi = dpi  # an SVG and a PDF have their own
        FigureCanvasAgg(figure)


def _has_many_points(artist: Artist) -> bool:
    """Return whether an artist would be more than about half a megabyte of an SVG."""
    counts = [0]
    if isinstance(artist, Line2D):
        counts = [np.asarray(artist.get_xdata()).size]
    elif isinstance(artist, QuadMesh):
        counts = [np.asarray(artist.get_array()).size]
    elif isinstance(artist, Collection):
        outlines = sum(len(np.asarray(path.vertices)) for path in artist.get_paths())
        counts = [outlines, np.asarray(artist.get_offsets()).size // 2]
    return max(counts) > _MANY
