"""Why the slope scatters, and spikes: the dataset causes.nc (`snakemake causes`)."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.derive import by_accuracy, with_flat_source
from octsim.config.models import Config
from octsim.config.ranges import even
from octsim.datasets.files import flags, make
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.optics.two_beams import aliasing_step, indices, predicted_phase_slope
from octsim.phase.slopes import trend
from octsim.stages.focus_law import focus_line, sweep_foci
from octsim.studies.causes.beat import Parts
from octsim.studies.causes.beat_slope import beat_slopes
from octsim.studies.causes.moved_spectra import MovedSpectra
from octsim.studies.causes.spike import diameters_around, spike_variables
from octsim.studies.causes.switches import (
    ALL,
    CAUSES,
    Causes,
    Reading,
    ShareStatus,
    every_slope,
    marginals,
    neighbours,
    shapley,
    share_status,
    signal,
    slopes,
    strongest,
    variance_share,
)

Array = NDArray[np.float64]
NONE: Causes = frozenset()
STEPS = (1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2)
"""Half widths whose slopes are compared, µm; the sweep's own step is added."""
LEAKAGE: Causes = frozenset({"centre", "envelope", "image"})
"""What leaks into the component whose phase is read."""
_ACCURACY = 1e-8  # of converged spectra: slopes over 0.02 nm stand on their last digits
SERIES: Mapping[str, Causes] = {
    "as the run": ALL,
    "converged": ALL - {"rays"},
    "without leakage": ALL - {"rays"} - LEAKAGE,
    "beat alone, the run's rays": frozenset({"rays"}),
    "beat alone": NONE,
}
"""What each series of slopes over the step has of the causes; the step is varied."""


def causes(
    config: Config,
    law: xr.Dataset | None = None,
    threads: int = 1,
    points: Points | None = None,
) -> xr.Dataset:
    """Return how much each cause carries of the phase slope's scatter, and what makes its spike.

    Parameters
    ----------
    config : Config
        The run whose slope it is.
    law : Dataset, optional
        The fitted focus law, where ``sweep.focus`` is ``law``.
    threads : int
        Points traced at once.
    points : Points, optional
        Where light that was found before is kept.

    Returns
    -------
    Dataset
        The slope as the run has it and its parts by cause (diameter), shares of the variance
        (cause), the slope of the beat's own phase with the focus following the diameter and held
        (diameter), scatter over the step (series, half_step), and spectra around the spike
        (spike_neighbour, wavenumber).

    Raises
    ------
    OctsimError
        If the law is needed and there is none, or nothing beats at one of the diameters.
    """
    config = with_flat_source(config)  # causes are of the scene
    foci, line = sweep_foci(config, law), focus_line(config, law)
    run, converged = (Instrument(one, points) for one in (config, by_accuracy(config, _ACCURACY)))
    diameter = even(config.sweep.diameters, "causes").values()
    spectra = MovedSpectra(run, converged, line, diameter, threads)
    k, neuron = run.wavenumber, config.swept_material
    steps = _steps(diameter, aliasing_step(neuron, k[0], k[-1]))
    reading = Reading(config.processing, indices(neuron, k), diameter, k)
    values = every_slope(spectra.chosen, reading)
    prepared = signal(spectra.chosen(ALL).at, ALL, config.processing)
    smooth = trend(diameter, values[NONE])
    off_trend = np.abs(values[ALL] - trend(diameter, values[ALL]))
    spike = float(diameter[off_trend.argmax()])
    near = diameters_around(spike)
    return make(
        "causes",
        config,
        "Causes of the phase slope's scatter and of its spike",
        {
            "phase_slope": ("diameter", values[ALL]),
            "component": ("diameter", strongest(prepared)),
            "focus": ("diameter", foci),
            "predicted_phase_slope": predicted_phase_slope(neuron, k[0], k[-1]),
            **_shares(values, smooth),
            **_ideal(reading),
            **_beats(spectra, reading, foci),
            **_over_step(spectra, reading, steps),
            **spike_variables(spectra.around(near), reading._replace(diameter=near)),
            "spike_diameter": spike,
        },
        {
            "diameter": diameter,
            "cause": list(CAUSES),
            "cause_name": ("cause", [name for name, _ in CAUSES.values()]),
            "cause_replacement": ("cause", [instead for _, instead in CAUSES.values()]),
            "series": list(SERIES),
            "half_step": steps,
            "spike_neighbour": near,
            "wavenumber": k,
        },
    )


def _steps(diameter: Array, aliasing: float) -> Array:
    """Return the steps that diameters allow, and over whose width a phase moves by less than π."""
    own = diameter[1] - diameter[0]
    most = min(diameter[0], aliasing) / 2
    steps: Array = np.array([step for step in sorted({*STEPS, own}) if step < most])
    return steps


def _shares(values: dict[Causes, Array], smooth: Array) -> dict[str, Any]:
    """Return how the slope's variance is shared by causes, trend and what nothing explains."""
    whole, none = values[ALL], values[NONE]
    part = shapley(values)
    added = {
        c: [variance_share(one, whole) for one in marginals(values, c).values()] for c in CAUSES
    }
    only = {c: values[frozenset({c})].std() for c in CAUSES}
    no_leak = values[ALL - LEAKAGE]

    def by_cause(of: Callable[[str], float]) -> tuple[str, Array]:
        return "cause", np.array([of(cause) for cause in CAUSES])

    return {
        "cause_phase_slope": (("cause", "diameter"), np.stack([part[c] for c in CAUSES])),
        "phase_slope_without": (
            ("cause", "diameter"),
            np.stack([values[ALL - {c}] for c in CAUSES]),
        ),
        "trend_phase_slope": ("diameter", smooth),
        "unexplained_phase_slope": ("diameter", none - smooth),
        "cause_share": by_cause(lambda c: variance_share(part[c], whole)),
        "least_share": by_cause(lambda c: min(added[c])),
        "largest_share": by_cause(lambda c: max(added[c])),
        "share_removed_first": by_cause(lambda c: variance_share(whole - values[ALL - {c}], whole)),
        "share_removed_last": by_cause(
            lambda c: variance_share(values[frozenset({c})] - none, whole)
        ),
        "scatter_without": by_cause(lambda c: values[ALL - {c}].std()),
        "scatter_with_only": by_cause(lambda c: only[c]),
        "share_status": ((), *flags(ShareStatus, np.array(share_status(whole)))),
        "trend_share": variance_share(smooth, whole),
        "unexplained_share": variance_share(none - smooth, whole),
        "phase_slope_standard_deviation": whole.std(),
        "scatter_without_leakage": no_leak.std(),
        # what is left about the trend: removed, not only shared out
        "left_without_leakage": (no_leak - smooth).var() / whole.var(),
        "left_without_all": (none - smooth).var() / whole.var(),
    }


def _ideal(reading: Reading) -> dict[str, Any]:
    """Return how the ideal cos(2ndk), all beat, is read: by the thesis, and without the image."""
    beat = np.exp(2j * reading.n_neuron * np.outer(reading.diameter, reading.wavenumber))
    nothing = np.zeros(beat.shape)
    stencil = neighbours(Parts(beat, nothing, nothing), reading.diameter)
    read = slopes(stencil, ALL, reading)
    without = slopes(stencil, ALL - {"image"}, reading)
    return {
        "ideal_phase_slope": ("diameter", read),
        "ideal_phase_slope_standard_deviation": read.std(),
        "ideal_scatter_without_image": without.std(),
    }


def _beats(spectra: MovedSpectra, reading: Reading, foci: Array) -> dict[str, Any]:
    """Return the beat's own slope, with a focus that follows the diameter and with a held one."""
    follows, held = (
        beat_slopes(spectra.converged, reading, focusing, spectra.threads)
        for focusing in (spectra.line.at, lambda _: foci)
    )
    named: dict[str, Any] = {}
    for prefix, of_focus in (("", follows), ("held_", held)):
        for name, slope in of_focus._asdict().items():
            side, _, error = name.partition("_")
            suffix = "_error" if error else ""
            named[f"{prefix}{side}_phase_slope{suffix}"] = ("diameter", slope)
    return named


def _over_step(spectra: MovedSpectra, reading: Reading, steps: Array) -> dict[str, Any]:
    """Return scatter and largest deviation from the trend of slopes over steps, of each series."""
    shape = len(SERIES), steps.size
    scatter, largest, noise = np.empty(shape), np.empty(shape), np.empty(steps.size)
    for j, step in enumerate(steps.tolist()):
        slope_of = {
            present: slopes(spectra.stencil(present, step), present, reading)
            for present in SERIES.values()
        }
        for i, slope in enumerate(slope_of.values()):
            off = slope - trend(spectra.diameter, slope)
            scatter[i, j], largest[i, j] = slope.std(), np.abs(off).max()
        by_rays = slope_of[frozenset({"rays"})] - slope_of[NONE]
        noise[j] = np.sqrt(np.mean(by_rays**2))
    dimensions = ("series", "half_step")
    return {
        "step_scatter": (dimensions, scatter),
        "step_largest": (dimensions, largest),
        "step_ray_noise": ("half_step", noise),
    }


def summary(dataset: xr.Dataset) -> str:
    """Return what carries the scatter, and where the spike is, in one line."""
    names, shares = dataset["cause"].values, 100 * dataset["cause_share"].values
    carried = ", ".join(
        f"{names[i]} {round(shares[i], 1) + 0.0:.1f} %" for i in np.argsort(-shares).tolist()
    )
    scatter, left = (
        float(dataset[name]) for name in ("phase_slope_standard_deviation", "left_without_leakage")
    )
    return (
        f"scatter of the phase slope {scatter:.3f} mrad/nm: {carried} of its variance; "
        f"{100 * left:.2g} % is left with {', '.join(sorted(LEAKAGE))} switched off; spike at "
        f"{float(dataset['spike_diameter']):.4g} um"
    )
