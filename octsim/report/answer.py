"""The number that a run comes to, with its error, and at which diameter."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from octsim.config.scheme import scheme_of
from octsim.report.markup import Html, element, joined
from octsim.report.shown import Shown
from octsim.report.words import capital, command, signed, with_error
from octsim.stages import phase_slope
from octsim.studies.calibration import told

_UNIT = "mrad/nm"


def answer(shown: Shown) -> Html:
    """Return the section with the phase slope: by the calibration where there is one."""
    slopes, calibrated = shown.datasets.get("phase_slope"), shown.datasets.get("calibration")
    if calibrated is not None:
        first = _of_calibration(calibrated)
    elif slopes is not None:
        first = _of_sweep(slopes)
    else:
        first = _nothing("This run has no phase_slope.nc yet; made by", command(""))
    facts = [
        element("div", element("dt", name), element("dd", said)) for name, said in _facts(shown)
    ]
    return element(
        "section", first, element("dl", *facts, class_="facts"), class_="answer", id="answer"
    )


def _number(text: str, what: str, *notes: object) -> Html:
    unit = element("span", _UNIT, class_="unit")
    return joined(
        element("p", element("strong", text), " ", unit, class_="number"),
        element("p", what, class_="of"),
        *(element("p", note, class_="note") for note in notes),
    )


def _nothing(text: str, how: str = "") -> Html:
    code = (" ", element("code", how)) if how else ()
    return joined(
        element("p", element("strong", "No phase slope"), class_="number"),
        element("p", text, *code, class_="of"),
    )


def _of_calibration(table: xr.Dataset) -> Html:
    """Show the slope at the middle of the calibrated diameters, with its standard error."""
    one = table.isel(diameter=table.sizes["diameter"] // 2)
    slope = float(one["fixed_focus_phase_slope"])
    error = float(one["fixed_focus_phase_slope_standard_error"])
    if not (np.isfinite(slope) and slope):
        return _nothing(f"{capital(told.summary(table))}.")
    what = (
        f"phase slope ± its standard error, at the diameter d = {float(one['diameter']):.4g} µm "
        "with the focus held: by calibration.nc"
    )
    return _number(
        with_error(slope, error),
        what,
        f"So 1 mrad of phase is {signed(1000 / slope, 2)} pm of the diameter there.",
        f"{capital(told.summary(table))}.",
    )  # fmt: skip


def _of_sweep(slopes: xr.Dataset) -> Html:
    """Show the mean slope over the diameters, with its scatter."""
    known = np.isfinite(slopes["phase_slope"].values)
    if not known.any():
        return _nothing(f"{capital(phase_slope.summary(slopes))}.")
    diameter = slopes["diameter"].values[known]
    number = with_error(
        float(slopes["mean_phase_slope"]), float(slopes["phase_slope_standard_deviation"])
    )
    some = "" if known.all() else f", the {known.sum()} of {known.size} that have one"
    what = (
        f"mean phase slope ± scatter over the diameters d = {diameter.min():.4g} to "
        f"{diameter.max():.4g} µm{some}: by phase_slope.nc"
    )
    note = (
        "The scatter is that of the slope from diameter to diameter. A standard error at one "
        "diameter is made by "
    )
    return _number(number, what, joined(note, element("code", command("calibration"))))


def _facts(shown: Shown) -> Iterator[tuple[str, str]]:
    """Return what stands beside the number, by name."""
    config, slopes = shown.config, shown.datasets.get("phase_slope")
    if slopes is not None:
        if "calibration" in shown.datasets and np.isfinite(slopes["phase_slope"]).any():
            scatter = float(slopes["phase_slope_standard_deviation"])
            mean = with_error(float(slopes["mean_phase_slope"]), scatter)
            yield "Mean ± scatter of the sweep", f"{mean} {_UNIT}, the focus following the diameter"
        yield "Prediction", f"{signed(float(slopes['predicted_phase_slope']))} {_UNIT}"
        if np.isfinite(slopes["phase_slope"]).any():
            at = float(slopes["largest_deviation_diameter"])
            off = signed(float(slopes["largest_deviation"]))
            yield "Largest deviation from it", f"{off} {_UNIT} at d = {at:.4g} µm"
    line, law = config.sweep.focus, shown.datasets.get("focus_law")
    if line != "law":
        yield "Focus, as given", f"z = {line.slope:g} d {1000 * line.intercept:+g} nm"
    elif law is not None and np.isfinite(law["slope"]):
        slope, error = (float(law[name]) for name in ("slope", "slope_standard_error"))
        yield (
            "Focus law",
            f"z = ({with_error(slope, error)}) d {1000 * float(law['intercept']):+.3g} nm",
        )
    scheme = scheme_of(config)
    by = "Maxwell's equations" if scheme.light == "waves" else "rays"
    yield "Scheme", f"{scheme.name}: by {'counted ' * scheme.counts_rays}{by}"
    wavelengths = sorted(2000 * np.pi / config.spectrum.wavenumbers()[[0, -1]])
    yield "Band", "{:.0f} to {:.0f} nm".format(*wavelengths)
    yield "Objective", f"NA {config.objective.numerical_aperture:g}"
    yield "Estimator", config.processing.estimator.replace("_", " ")
