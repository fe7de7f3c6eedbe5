"""The scene as a picture inside the page, in the page's own colours of text."""

import io
import re
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from octsim.base.errors import OctsimError
from octsim.figures.scene import scene_figure
from octsim.figures.style import look
from octsim.report.markup import Html, element, escaped
from octsim.report.shown import Shown
from octsim.report.words import command

# what is black or nearly so on white paper has the colour of text, which is light in the dark
_INKS = ("#000000", "#333333", "#262626")
_IN_PAGE: Any = {"svg.fonttype": "none", "legend.framealpha": 0.0}
"""Text stays text, and nothing has a background of its own."""


def scene(shown: Shown) -> Html:
    """Return the section with the scene to scale and its rays."""
    head = element("h2", "The scene, to scale")
    spectra = shown.datasets.get("spectra")
    if spectra is None:
        said = element("p", "It is drawn from spectra.nc, made by ", element("code", command("")))
        return element("section", head, said, id="scene")
    middle = spectra["diameter"].size // 2
    if not np.isfinite(spectra["focus"].values[middle]):
        said = element("p", "It is not drawn, as the focus is not known: there is no focus law.")
        return element("section", head, said, id="scene")
    try:
        with look(), mpl.rc_context(_IN_PAGE):
            drawn = embedded(
                scene_figure(spectra), "The scene to scale, with rays of its light paths"
            )
    except OctsimError as error:
        return element("section", head, element("p", f"It is not drawn: {error}"), id="scene")
    caption = element(
        "figcaption",
        "A cut across the neuron at the middle diameter of the sweep. Rays of its strongest light "
        "paths have a colour each, and the legend their fields; a name says which surfaces light "
        "met, from first to last: T passed, R reflected.",
    )
    return element("section", head, element("figure", drawn, caption, class_="picture"), id="scene")


def embedded(figure: Figure, name: str) -> Html:
    """Return a figure as an SVG element without a background, named for those who don't see it."""
    stream = io.StringIO()
    figure.savefig(stream, format="svg", transparent=True, metadata={"Date": None})
    text = stream.getvalue()
    text = re.sub(r"<metadata>.*?</metadata>", "", text[text.index("<svg") :], flags=re.DOTALL)
    for ink in _INKS:
        text = text.replace(ink, "currentColor")
    # its own size gives way to the page's
    text = re.sub(r'^<svg ([^>]*?)width="[^"]*"', r"<svg \1", text)
    text = re.sub(r'^<svg ([^>]*?)height="[^"]*"', r"<svg \1", text)
    return Html(text.replace("<svg ", f'<svg role="img" aria-label="{escaped(name)}" ', 1))
