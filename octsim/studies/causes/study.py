"""Why the slope scatters, and spikes: the dataset causes.nc (`snakemake causes`)."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.derive import by_accuracy
from octsim.config.models import Config, FocusLine
from octsim.datasets.files import make
from octsim.optics.two_beams import aliasing_step, predicted_phase_slope
from octsim.phase.slopes import trend
from octsim.phase.transform import centred_by
from octsim.stages.focus_law import focus_line, sweep_foci
from octsim.studies.causes.beat import Parts, fields_at, parts
from octsim.studies.causes.beat_slope import beat_slopes
from octsim.studies.causes.switches import (
    ALL,
    CAUSES,
    Causes,
    Reading,
    Stencil,
    every_slope,
    marginals,
    neighbours,
    shapley,
    share,
    signal,
    slopes,
    strongest,
    true_level,
    weights,
)

Array = NDArray[np.float64]
POINT = 1e-5
"""Half width of the difference that stands for a derivative at a point, µm."""
STEPS = (1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2)
"""Half widths whose slopes are compared, µm; the sweep's own step is added."""
_NEAR, _NEAR_NUM = 0.02, 81  # spectra around the spike: µm to each side, and how many
LEAKAGE: Causes = frozenset({"centre", "envelope", "image"})
"""What leaks into the component whose phase is read."""
_ACCURACY = 1e-8  # of converged spectra: slopes over 0.02 nm stand on their last digits
SERIES: dict[str, Causes] = {
    "as the run": ALL,
    "converged": ALL - {"rays"},
    "without leakage": ALL - {"rays"} - LEAKAGE,
    "beat alone, the run's rays": frozenset({"rays"}),
    "beat alone": frozenset(),
}
"""What each series of slopes over the step has of the causes; the step is varied."""


class _Spectra:
    """Spectra of a sweep, the run's own and converged ones, moved along the diameter."""

    def __init__(self, config: Config, line: FocusLine, threads: int, diameter: Array) -> None:
        self.run, self.exact = config, by_accuracy(config, _ACCURACY)
        self.line, self.threads, self.diameter = line, threads, diameter
        self.moved = cache(self._moved)  # each point is traced once

    def _moved(self, has_rays: bool, offset: float) -> Parts:
        at = self.diameter + offset
        instrument = self.run if has_rays else self.exact
        return parts(fields_at(instrument, at, self.line.at(at), self.threads))

    def stencil(self, present: Causes, step: float) -> Stencil:
        """Give spectra a step (µm) apart, of the rays that a subset of the causes has."""
        below, at, above = (self.moved("rays" in present, o) for o in (-step, 0.0, step))
        return Stencil(below, at, above, np.full(self.diameter.size, 2 * step))

    def chosen(self, present: Causes) -> Stencil:
        """Give the stencil of a subset of the causes."""
        if "step" in present:
            return neighbours(self.moved("rays" in present, 0.0), self.diameter)
        return self.stencil(present, POINT)


def causes(config: Config, law: xr.Dataset | None = None, threads: int = 1) -> xr.Dataset:
    """Tell how much each cause carries of the phase slope's scatter, and what makes its spike.

    Parameters
    ----------
    config : Config
        The run whose slope it is.
    law : Dataset, optional
        The fitted focus law, where ``sweep.focus`` is ``law``.
    threads : int
        Points traced at once.

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
    foci, line = sweep_foci(config, law), focus_line(config, law)
    spectra = _Spectra(config, line, threads, config.sweep.diameters.values())
    k, n_neuron = config.spectrum.wavenumbers(), config.scene.refractive_index.neuron
    steps = _steps(spectra.diameter, aliasing_step(n_neuron, k[0], k[-1]))
    reading = Reading(config.processing, n_neuron, spectra.diameter, k)
    values = every_slope(spectra.chosen, reading)
    own = spectra.chosen(ALL).at
    smooth = trend(spectra.diameter, values[frozenset()])
    off = values[ALL] - trend(spectra.diameter, values[ALL])
    spike = float(spectra.diameter[np.abs(off).argmax()])
    side = min(_NEAR, spike / 2)
    near = np.linspace(spike - side, spike + side, _NEAR_NUM)
    return make(
        "causes",
        config,
        "Causes of the phase slope's scatter and of its spike",
        {
            "phase_slope": ("diameter", values[ALL]),
            "component": ("diameter", strongest(signal(own, ALL, config.processing))),
            "focus": ("diameter", foci),
            "predicted_phase_slope": predicted_phase_slope(n_neuron, k[0], k[-1]),
            **_shares(values, smooth),
            **_ideal(reading),
            **_beats(spectra, reading, foci),
            **_over_step(spectra, reading, steps),
            **_around(spectra, reading, near),
            "spike_diameter": spike,
        },
        {
            "diameter": spectra.diameter,
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
    """Give the steps that diameters allow, and over whose width a phase moves by less than π."""
    own = diameter[1] - diameter[0]
    most = min(diameter[0], aliasing) / 2
    steps: Array = np.array([step for step in sorted({*STEPS, own}) if step < most])
    return steps


def _shares(values: dict[Causes, Array], smooth: Array) -> dict[str, Any]:
    """Share the slope's variance out among the causes, the trend, and what nothing explains."""
    whole, none = values[ALL], values[frozenset()]
    part = shapley(values)
    added = {c: [share(one, whole) for one in marginals(values, c).values()] for c in CAUSES}
    only = {c: values[frozenset({c})].std() for c in CAUSES}
    no_leak = values[ALL - LEAKAGE]

    def by_cause(give: Callable[[str], float]) -> tuple[str, Array]:
        return "cause", np.array([give(cause) for cause in CAUSES])

    return {
        "cause_phase_slope": (("cause", "diameter"), np.stack([part[c] for c in CAUSES])),
        "phase_slope_without": (
            ("cause", "diameter"),
            np.stack([values[ALL - {c}] for c in CAUSES]),
        ),
        "trend_phase_slope": ("diameter", smooth),
        "unexplained_phase_slope": ("diameter", none - smooth),
        "cause_share": by_cause(lambda c: share(part[c], whole)),
        "least_share": by_cause(lambda c: min(added[c])),
        "largest_share": by_cause(lambda c: max(added[c])),
        "share_removed_first": by_cause(lambda c: share(whole - values[ALL - {c}], whole)),
        "share_removed_last": by_cause(lambda c: share(values[frozenset({c})] - none, whole)),
        "scatter_without": by_cause(lambda c: values[ALL - {c}].std()),
        "scatter_with_only": by_cause(lambda c: only[c]),
        "trend_share": share(smooth, whole),
        "unexplained_share": share(none - smooth, whole),
        "phase_slope_standard_deviation": whole.std(),
        "scatter_without_leakage": no_leak.std(),
        # what is left about the trend: removed, not only shared out
        "left_without_leakage": (no_leak - smooth).var() / whole.var(),
        "left_without_all": (none - smooth).var() / whole.var(),
    }


def _ideal(reading: Reading) -> dict[str, Any]:
    """Read the thesis's ideal cos(2ndk), which is all beat: as it does, and without the image."""
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


def _beats(spectra: _Spectra, reading: Reading, foci: Array) -> dict[str, Any]:
    """Differentiate the beat's own phase, with a focus that follows the diameter and a held one."""
    follows, held = (
        beat_slopes(spectra.exact, reading, focusing, spectra.threads)
        for focusing in (spectra.line.at, lambda _: foci)
    )
    named: dict[str, Any] = {}
    for prefix, found in (("", follows), ("held_", held)):
        for name, slope in found._asdict().items():
            side, _, error = name.partition("_")
            suffix = "_error" if error else ""
            named[f"{prefix}{side}_phase_slope{suffix}"] = ("diameter", slope)
    return named


def _over_step(spectra: _Spectra, reading: Reading, steps: Array) -> dict[str, Any]:
    """Give scatter and largest deviation from the trend of slopes over steps, of each series."""
    shape = len(SERIES), steps.size
    scatter, largest, noise = np.empty(shape), np.empty(shape), np.empty(steps.size)
    for j, step in enumerate(steps.tolist()):
        found = {
            present: slopes(spectra.stencil(present, step), present, reading)
            for present in SERIES.values()
        }
        for i, slope in enumerate(found.values()):
            off = slope - trend(spectra.diameter, slope)
            scatter[i, j], largest[i, j] = slope.std(), np.abs(off).max()
        by_rays = found[frozenset({"rays"})] - found[frozenset()]
        noise[j] = np.sqrt(np.mean(by_rays**2))
    dimensions = ("series", "half_step")
    return {
        "step_scatter": (dimensions, scatter),
        "step_largest": (dimensions, largest),
        "step_ray_noise": ("half_step", noise),
    }


def _around(spectra: _Spectra, reading: Reading, near: Array) -> dict[str, Any]:
    """Show what happens around a spike: converged spectra, their level, and what it leaks."""
    here = _Spectra(spectra.run, spectra.line, spectra.threads, near)
    read = reading._replace(diameter=near)
    stencil, processing = here.chosen(ALL - {"rays", "step"}), reading.processing
    intensity = stencil.at.intensity()
    subtracted = (intensity - centred_by(intensity, processing))[:, 0]
    off = subtracted - true_level(stencil.at, processing)[:, 0]
    window = weights(processing, read.wavenumber.size)
    full = signal(stencil.at, ALL, processing)
    component = strongest(full)
    read_off = np.fft.fft(full)[np.arange(near.size), component]
    # what a constant gives in that component, through the window
    leaked = -off * np.fft.fft(window)[component]
    present = ALL - {"rays", "step"}
    own = ("spike_neighbour", "wavenumber")
    return {
        "spike_intensity": (own, intensity),
        "spike_component": ("spike_neighbour", component),
        "spike_maximum": ("spike_neighbour", read.wavenumber[intensity.argmax(axis=1)]),
        "spike_minimum": ("spike_neighbour", read.wavenumber[intensity.argmin(axis=1)]),
        "spike_level_error": ("spike_neighbour", off),
        "spike_amplitude": ("spike_neighbour", np.abs(stencil.at.beat) @ window),
        "spike_leakage": ("spike_neighbour", np.abs(leaked / read_off)),
        "spike_leaked_phase": ("spike_neighbour", np.angle(read_off * (read_off - leaked).conj())),
        "spike_phase_slope": ("spike_neighbour", slopes(stencil, present, read)),
        "spike_phase_slope_without_centre": (
            "spike_neighbour",
            slopes(stencil, present - {"centre"}, read),
        ),
    }


def summary(found: xr.Dataset) -> str:
    """Say in one line what carries the scatter, and where the spike is."""
    order = np.argsort(-found["cause_share"].values)
    said = ", ".join(
        f"{found['cause'].values[i]} {round(100 * found['cause_share'].values[i], 1) + 0.0:.1f} %"
        for i in order.tolist()
    )
    left = 100 * float(found["left_without_leakage"])
    return (
        f"scatter of the phase slope {float(found['phase_slope_standard_deviation']):.3f} mrad/nm: "
        f"{said} of its variance; {left:.2g} % is left with {', '.join(sorted(LEAKAGE))} switched "
        f"off; spike at {float(found['spike_diameter']):.4g} um"
    )
