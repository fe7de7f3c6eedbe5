"""Components to the phase slope, beside the ideal and the prediction (figure 12)."""

from collections.abc import Iterator
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.grid import Combination
from octsim.config.models import Config
from octsim.datasets.files import Flags, flags
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.reader import Stored
from octsim.datasets.statuses import MeanStatus
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.optics.two_beams import ideal_spectra, predicted_phase_slope
from octsim.phase.by_config import ideal_phases
from octsim.phase.fringe_status import WITH_PHASE
from octsim.phase.slopes import phase_slopes, slope_of
from octsim.phase.transform import fourier_components
from octsim.stages.fourier import block_points, by_components


class SlopeStatus(IntEnum):
    """Whether a phase has a slope over the diameter."""

    KNOWN = 0
    NO_FRINGE = 1
    """The diameter's spectrum has no fringe; fringe_status says why."""
    NO_FRINGE_BESIDE = 2
    """That of a diameter beside it, which the difference needs, has none."""
    BELOW_ROUNDING = 3
    """The component holds nothing but rounding, there or beside."""
    NO_ESTIMATE = 4
    """The estimator has no phase of the spectrum, there or beside; estimate_status says why."""


class _Exact(NamedTuple):
    """A combination's slopes by Maxwell's equations, with the statuses of each and of all."""

    slope: NDArray[np.float64]
    of_each: Flags
    status: Flags


_OF_SLOPES = (
    "mean_phase_slope", "phase_slope_standard_deviation", "standard_deviation_from_ideal",
    "largest_deviation", "largest_deviation_diameter",
)  # fmt: skip


@Streamed
def phase_slope(
    config: Config, transformed: xr.Dataset, spectra: xr.Dataset | None = None
) -> Stream:
    """Differentiate the phase over the diameter, and compare with the ideal and the prediction.

    Parameters
    ----------
    config : Config
        The run.
    transformed : Dataset
        Of the stage fourier.
    spectra : Dataset, optional
        Of the stage spectra, whose foci the comparison with Maxwell's equations is made at.

    Returns
    -------
    Dataset
        phase_slope, strongest_component, fringe_status and ideal_phase_slope (diameter),
        component_phase_slope(diameter, component), predicted_phase_slope, and the thesis's summary
        figures as scalars. With spectra by rays, exact_phase_slope(diameter) by Maxwell's equations
        at a few diameters, NaN at the others, and exact_status. Where a slope is NaN, slope_status,
        component_slope_status, exact_slope_status and mean_slope_status say why.

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "tracing": {"rays": 200},
    ...         "sweep": {
    ...             "diameters": {"stop": "1.1 um", "num": 3},
    ...             "focus": {"slope": 0.58, "intercept": "66 nm"},
    ...         },
    ...     }
    ... )
    >>> spectra = octsim.spectra(config, octsim.detections(config))
    >>> transformed = octsim.fourier(config, spectra)
    >>> slopes = octsim.phase_slope(config, transformed)
    >>> round(float(slopes["predicted_phase_slope"]), 2), slopes["phase_slope"].units
    (23.14, 'mrad/nm')
    """

    def own(config: Config) -> dict[str, Coordinate]:
        return {"diameter": ("diameter", config.sweep.diameters.values())}

    title = "Phase slope: change of the spectrum's phase with the diameter"
    layout = Layout("phase_slope", config, title, own, "diameter", _component_count)
    stored = Stored(transformed, "fourier", config, layout)
    foci = None if spectra is None else Stored(spectra, "spectra", config, layout)
    return Stream(layout, _differentiated(layout, stored, foci))


def _component_count(config: Config) -> dict[str, int]:
    return {"component": config.spectrum.samples // 2 + 1}


def _differentiated(layout: Layout, stored: Stored, foci: Stored | None) -> Iterator[Part]:
    slopes: dict[str, list[NDArray[np.float64]]] = {"phase_slope": [], "ideal_phase_slope": []}
    for at, span in layout.blocks(block_points):
        count = layout.count(at)
        # a central difference looks at both neighbours
        wide = slice(max(span.start - 1, 0), min(span.stop + 1, count))
        variables = _slopes(at.config, stored.part(at, wide), span.start - wide.start, span)
        if foci is not None:
            if span.start == 0:
                exact = _exact(layout, at, foci)
            variables["exact_phase_slope"] = "diameter", exact.slope[span]
            variables["exact_slope_status"] = ("diameter", exact.of_each[0][span], exact.of_each[1])
            if span.stop == count:
                variables["exact_status"] = (), *exact.status
        for name, values in slopes.items():
            values.append(variables[name][1])
        if span.stop == count:
            joined = {name: np.concatenate(values) for name, values in slopes.items()}
            variables |= _figures(at.config, layout.own[at.position]["diameter"][1], **joined)
            slopes = {name: [] for name in slopes}
        yield Part(at, span.start, span.stop - span.start, variables)


def _exact(layout: Layout, at: Combination, stored: Stored) -> _Exact:
    """Return a combination's slopes by Maxwell's equations, and why there are none, if so."""
    # here, as without spectra there is no need of light
    from octsim.stages.by_maxwell import ExactSlopeStatus, ExactStatus, exact_slopes, not_compared

    foci = stored.part(at, names=("focus",))["focus"].values
    if at is layout.combinations[0]:
        found = exact_slopes(at.config, foci)
    else:
        found = not_compared(foci.size, ExactStatus.OTHER_COMBINATION)
    status = flags(ExactStatus, np.array(found.status))
    return _Exact(found.slope, flags(ExactSlopeStatus, found.of_each), status)


def slope_status(
    slope: NDArray[np.float64], visible: NDArray[np.bool_], otherwise: SlopeStatus
) -> NDArray[np.int64]:
    """Return the `SlopeStatus` of slopes (D, ...), of which some diameters have a phase.

    Parameters
    ----------
    slope : ndarray, shape (D, ...)
        NaN where there is none.
    visible : ndarray of bool, shape (D,) or that of the slopes
        Whether there is a phase.
    otherwise : SlopeStatus
        Why there is none where there are phases.
    """
    visible = visible.reshape(*visible.shape, *(1,) * (slope.ndim - visible.ndim))
    end = np.ones_like(visible[:1])
    beside = np.concatenate([end, visible[:-1]]) & np.concatenate([visible[1:], end])
    return np.select(
        [np.isfinite(slope), ~visible, ~beside],
        [SlopeStatus.KNOWN, SlopeStatus.NO_FRINGE, SlopeStatus.NO_FRINGE_BESIDE],
        otherwise,
    )


def _slopes(config: Config, part: xr.Dataset, before: int, span: slice) -> dict[str, Any]:
    """Return the slopes of some diameters of a part that holds their neighbours too."""
    inner = slice(before, before + span.stop - span.start)
    diameter, k = part["diameter"].values, config.spectrum.wavenumbers()
    phase, fringe = part["phase"].values, {}
    visible = np.ones(diameter.size, bool)
    if "fringe_status" in part:  # files of 0.3.0 and before don't have it
        status = part["fringe_status"]
        visible = np.isin(status.values, WITH_PHASE)
        phase = np.where(visible[:, np.newaxis], phase, np.nan)
        fringe["fringe_status"] = "diameter", status.values[inner], status.attrs
    found = phase_slopes(diameter, part["magnitude"].values, phase)
    spectra = ideal_spectra(config.swept_material, diameter, k)
    power = config.spectrum.power()
    shaped = spectra if power is None else spectra * power
    ideal = fourier_components(shaped, config.processing)
    ideals = phase_slopes(diameter, np.abs(ideal), np.angle(ideal))
    slope, ideal_slope = found.strongest, ideals.strongest
    otherwise = SlopeStatus.BELOW_ROUNDING
    if not by_components(config):
        otherwise = SlopeStatus.NO_ESTIMATE
        slope = slope_of(diameter, part["estimated_phase"].values)
        ideal_slope = slope_of(diameter, ideal_phases(config, spectra, diameter, k))
    of_slope = flags(SlopeStatus, slope_status(slope, visible, otherwise)[inner])
    of_component = flags(
        SlopeStatus, slope_status(found.by_component, visible, SlopeStatus.BELOW_ROUNDING)[inner]
    )
    return {
        **fringe,
        "phase_slope": ("diameter", slope[inner]),
        "slope_status": ("diameter", *of_slope),
        "strongest_component": ("diameter", found.component[inner]),
        "component_phase_slope": (("diameter", "component"), found.by_component[inner]),
        "component_slope_status": (("diameter", "component"), *of_component),
        "ideal_phase_slope": ("diameter", ideal_slope[inner]),
        "ideal_component": ("diameter", ideals.component[inner]),
    }


def _figures(
    config: Config,
    diameter: NDArray[np.float64],
    phase_slope: NDArray[np.float64],
    ideal_phase_slope: NDArray[np.float64],
) -> dict[str, Any]:
    """Return the thesis's summary figures of a sweep, over the diameters whose slope is known."""
    k = config.spectrum.wavenumbers()
    predicted = predicted_phase_slope(config.swept_material, k[0], k[-1])
    known = np.isfinite(phase_slope)
    status = MeanStatus.KNOWN if known.any() else MeanStatus.TOO_FEW
    ideal: dict[str, Any] = {
        "mean_slope_status": ((), *flags(MeanStatus, np.array(status))),
        "predicted_phase_slope": predicted,
        "mean_ideal_phase_slope": ideal_phase_slope.mean(),
        "ideal_phase_slope_standard_deviation": ideal_phase_slope.std(),
    }
    if not known.any():
        return ideal | dict.fromkeys(_OF_SLOPES, np.nan)
    slope, away = phase_slope[known], (phase_slope - ideal_phase_slope)[known]
    deviation = slope - predicted
    largest = int(np.abs(deviation).argmax())
    values = (slope.mean(), slope.std(), away.std(), deviation[largest], diameter[known][largest])
    return ideal | dict(zip(_OF_SLOPES, values, strict=True))


_NONE = "no phase slope: no spectrum has a fringe (fringe_status in fourier.nc says why)"


def summary(slopes: xr.Dataset) -> str:
    """Return in one line what a run found."""
    means = slopes["mean_phase_slope"].values
    if means.ndim:
        if np.isnan(means).all():
            return _NONE
        return (
            f"mean phase slope over the diameters {np.nanmin(means):.3f} to "
            f"{np.nanmax(means):.3f} mrad/nm over {means.size} combinations"
        )
    figures = (
        "mean_phase_slope", "phase_slope_standard_deviation", "predicted_phase_slope",
        "largest_deviation", "largest_deviation_diameter",
    )  # fmt: skip
    known = np.isfinite(slopes["phase_slope"].values)
    if not known.any():
        return _NONE
    some = "" if known.all() else f" that have one, {known.sum()} of {known.size}"
    mean, scatter, predicted, deviation, diameter = (float(slopes[name]) for name in figures)
    return (
        f"phase slope {mean:.3f} ± {scatter:.3f} mrad/nm (mean ± scatter over the "
        f"diameters{some}), prediction {predicted:.3f}; largest deviation from it "
        f"{deviation:+.3f} at {diameter:.4g} um"
    )
