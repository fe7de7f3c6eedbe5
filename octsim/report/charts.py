"""The places of a report's charts: the page's script draws them from its values."""

from collections.abc import Mapping
from typing import Any

from octsim.report.markup import Html, element, joined
from octsim.report.words import capital, command


def charts(values: Mapping[str, Any]) -> Html:
    """Return the sections with charts, of what there are values for.

    Parameters
    ----------
    values : mapping
        As `values_of` returns them.
    """
    return joined(_over_diameter(values), _image(values), _traces(values))


def _chart(name: str, title: str, *below: object) -> Html:
    """Return the place of a chart: the script puts canvas, legend and text for readers there."""
    return element(
        "figure",
        element("figcaption", element("h3", title)),
        element("div", class_="plot", id=f"{name}-plot"),
        element("p", class_="key", id=f"{name}-key"),
        *below,
        class_="chart",
        data_chart=name,
    )


def _save(file: str, what: str) -> Html:
    button = element("button", what, type="button", data_file=file, class_="save")
    return element("p", button, class_="saves")


def _over_diameter(values: Mapping[str, Any]) -> Html:
    head = element("h2", "The slope over the diameter")
    if values["diameter"] is None:
        said = element("p", "There is no phase_slope.nc; made by ", element("code", command("")))
        return element("section", head, said, id="slope")
    slider = element(
        "div",
        element("label", "Diameter ", element("output", id="chosen"), for_="diameter"),
        element("input", type="range", id="diameter", min=0, max=0, value=0, step=1),
        class_="slider",
    )
    how = element(
        "p", "Slide, or click in the first chart or the image, to see one diameter's spectrum, "
        "A-scan and light paths.", class_="note",
    )  # fmt: skip
    parts = [how, slider, element("dl", class_="facts", id="readout")]
    if values["slope"] is not None:
        parts.insert(0, _chart("slope", "Phase slope", _save("phase_slope.csv", "phase_slope.csv")))
    pair, here = [], " of this diameter"
    if values["spectra"] is not None:
        pair = [
            _chart("spectrum", "Spectrum", _save("spectrum.csv", f"spectrum.csv{here}")),
            _chart(
                "ascan", "A-scan over the optical depth", _save("a_scan.csv", f"a_scan.csv{here}")
            ),
        ]
    paths = [] if values["paths"] is None else [_paths()]
    return element(
        "section", head, *parts, element("div", *pair, class_="pair"), *paths, id="slope"
    )


def _paths() -> Html:
    heads = ("Light path", "Share of the intensity", "Field amplitude", "Mean optical path (µm)")
    head = element("tr", *(element("th", one, scope="col") for one in heads))
    body = element("tbody", id="paths-body")
    caption = element("caption", "Light paths at this diameter")
    inner = element("table", caption, element("thead", head), body)
    note = (
        "A share is of the interference too, so that it can be negative or above 100 %; all paths "
        "of a run come to 100 %."
    )
    return joined(
        element("div", inner, class_="wide", tabindex=0, role="region", aria_label="Light paths"),
        element("p", note, class_="note"), _save("light_paths.csv", "light_paths.csv"),
    )  # fmt: skip


def _image(values: Mapping[str, Any]) -> Html:
    if values["spectra"] is None:
        return Html()
    scale = element(
        "p", element("span", "0"), element("span", class_="scale", id="scale"),
        element("span", id="largest"), class_="colours",
    )  # fmt: skip
    save = _save("spectra.csv", "spectra.csv")
    step, of = values["spectra"]["every"], values["spectra"]["of"]
    some = (
        "" if step == 1 else f" One sample in {step} of {of} is in this page; spectra.nc has all."
    )
    note = element(
        "p", f"Intensity over wavenumber and diameter, in single precision.{some}", class_="note"
    )
    return element(
        "section", element("h2", "All spectra"),
        _chart("image", "Spectra as an image", scale, note, save), id="spectra",
    )  # fmt: skip


def _traces(values: Mapping[str, Any]) -> Html:
    if not values["traces"]:
        return Html()
    drawn = [
        _chart(
            f"trace-{number}", f"{capital(one['name'])} ({one['unit']})",
            *([] if one["every"] else [element(
                "p", f"What is seen of {one['of']} samples; expansion.nc has all.", class_="note"
            )]),
            _save(f"trace_{number}.csv", f"trace_{number}.csv"),
        )
        for number, one in enumerate(values["traces"])
    ]  # fmt: skip
    return element("section", element("h2", "Your trace"), *drawn, id="trace")
