"""What accuracy costs: settings against a converged reference (`snakemake tradeoff`)."""

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.derive import by_accuracy, by_rays, changed, reference
from octsim.config.models import Config, FocusLine
from octsim.config.scheme import scheme_of
from octsim.datasets.files import make
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.phase.slopes import phase_slopes
from octsim.phase.transform import fourier_components
from octsim.stages.focus_law import focus_law, sweep_foci
from octsim.stages.focus_sweep import focus_sweep
from octsim.stages.gaussian_fits import gaussian_fits
from octsim.studies.tradeoff.frontier import COUNTED, TARGETS, comparison, efficient
from octsim.studies.tradeoff.measured_cost import MeasuredCost, apart, sweep_cost
from octsim.studies.tradeoff.settings import (
    CONVERGED_SAMPLES,
    FINER,
    Setting,
    is_the_runs,
    preset_of,
    settings,
)

Array = NDArray[np.float64]
_NO_LAW = FocusLine.model_construct(slope=np.nan, intercept=np.nan)


class Errors(NamedTuple):
    """How far one setting is from the converged reference."""

    worst_intensity_error: float
    """Largest over the diameters of max |I − I_ref| / max I_ref over k."""
    median_intensity_error: float
    """Median over the diameters of the same."""
    beyond_accuracy: int
    """Number of diameters where that is above the accuracy that was asked for."""
    phase_slope_rms_error: float = np.nan
    """Over the diameters, mrad/nm."""
    phase_slope_largest_error: float = np.nan
    """Over the diameters, mrad/nm."""


def intensity_errors(intensity: Array, exact: Array) -> Array:
    """Return max |I − I_ref| / max I_ref of each spectrum, (D, K) to (D,); NaN where it is dark."""
    with np.errstate(divide="ignore", invalid="ignore"):
        errors: Array = np.abs(intensity - exact).max(axis=1) / exact.max(axis=1)
    return errors


def strongest_slopes(config: Config, intensity: Array) -> Array:
    """Return the phase slope of the strongest component (D,), mrad/nm, of spectra (D, K)."""
    components = fourier_components(intensity, config.processing)
    diameters = config.sweep.diameters.values()
    return phase_slopes(diameters, np.abs(components), np.angle(components)).strongest


def fitted_law(config: Config, threads: int, points: Points) -> xr.Dataset:
    """Return a config's focus law."""
    return focus_law(config, gaussian_fits(config, focus_sweep(config, threads, points)))


class ReferenceSweep:
    """Converged spectra and slopes of a run; each is made when it is first asked for."""

    def __init__(self, config: Config, line: FocusLine, threads: int, points: Points) -> None:
        self._config, self._line, self._threads, self._points = config, line, threads, points
        self._spectra: dict[tuple[int, int], Array] = {}

    def spectra(self, num: int, samples: int) -> Array:
        """Return the spectra (D, K) of some number of diameters and of wavenumbers."""
        if (num, samples) not in self._spectra:
            config = reference(self._sampled(num, samples))
            diameters = config.sweep.diameters.values()
            self._spectra[num, samples] = Instrument(config, self._points).spectra(
                diameters, self._line.at(diameters), self._threads
            )
        return self._spectra[num, samples]

    def slopes(self, setting: Setting) -> Array:
        """Return what a setting's slope would be, were the factor that it varies converged."""
        num, samples = setting.config.sweep.diameters.num, setting.config.spectrum.samples
        if setting.factor == "spectrum.samples":
            samples = CONVERGED_SAMPLES
        steps = 1
        if setting.factor == "sweep.diameters.num":
            finest = FINER * (self._config.sweep.diameters.num - 1)
            steps, num = finest // (num - 1), finest + 1
        converged = strongest_slopes(self._sampled(num, samples), self.spectra(num, samples))
        return converged[::steps]

    def _sampled(self, num: int, samples: int) -> Config:
        return changed(
            self._config,
            {"sweep": {"diameters": {"num": num}}, "spectrum": {"samples": samples}},
        )


def tradeoff(
    config: Config,
    threads: int = 1,
    prepare: Callable[[], None] | None = None,
    chosen: Iterable[Setting] | None = None,
    separate: bool = True,
    points: Points | None = None,
) -> xr.Dataset:
    """Return what each setting costs and how far it is from a converged reference.

    All spectra are focused by one line, the given one or the reference's law, so that errors of the
    intensity compare like with like.

    Parameters
    ----------
    config : Config
        The run whose settings are varied.
    threads : int
        For what is not timed.
    prepare : callable, optional
        What each process of a measurement does first.
    chosen : iterable of Setting, optional
        Instead of `octsim.studies.tradeoff.settings.settings`.
    separate : bool
        Whether each is measured in a process of its own, without which memory says little.
    points : Points, optional
        Where light that was found before is kept; what is measured is found anew.

    Returns
    -------
    Dataset
        Errors, costs, and whether it is efficient, of each setting; and how many times fewer
        segments light paths need than counted rays, for each target error.
    """
    listed = list(settings(config) if chosen is None else chosen)
    points = points or Points()
    # compiled code goes to the processes with this one's memory
    for least in (by_rays(config, 1), by_accuracy(config, 0.1)):
        start = config.sweep.diameters.start
        Instrument(least).spectrum(start, start / 2)
    converged = reference(config)
    law = fitted_law(converged, threads, points)
    sweep_foci(converged, law)  # says what is wrong with a law that does not serve
    focus = config.sweep.focus
    line = focus if isinstance(focus, FocusLine) else FocusLine.fitted(law)
    exact = ReferenceSweep(config, line, threads, points)
    # before what is not timed, whose memory would be there to use again
    costs = [_measured(setting, line, prepare, separate) for setting in listed]
    errors = [
        _errors(setting, cost.intensity, exact) for setting, cost in zip(listed, costs, strict=True)
    ]
    laws = [
        FocusLine.fitted(fitted_law(setting.config, threads, points)) if setting.law else _NO_LAW
        for setting in listed
    ]
    variables = {
        **_columns(listed, costs, errors),
        **_law_errors(laws, FocusLine.fitted(law), config),
        **_changes(listed, costs),
    }
    return _dataset(config, listed, variables)


def _measured(
    setting: Setting, line: FocusLine, prepare: Callable[[], None] | None, separate: bool
) -> MeasuredCost:
    """Return what a setting costs, on this process or on one of its own."""
    diameters = setting.config.sweep.diameters.values()[:: setting.every]
    swept = setting.config, diameters, line.at(diameters)
    return apart(prepare, sweep_cost, *swept) if separate else sweep_cost(*swept)


def _errors(setting: Setting, intensity: Array, exact: ReferenceSweep) -> Errors:
    config = setting.config
    spectra = exact.spectra(config.sweep.diameters.num, config.spectrum.samples)
    off = intensity_errors(intensity, spectra[:: setting.every])
    asked = config.tracing.accuracy if scheme_of(config).controls_error else np.inf
    errors = Errors(float(off.max()), float(np.median(off)), int((off > asked).sum()))
    if setting.every > 1:
        return errors
    slope_off = strongest_slopes(config, intensity) - exact.slopes(setting)
    return errors._replace(
        phase_slope_rms_error=float(np.sqrt(np.mean(slope_off**2))),
        phase_slope_largest_error=float(np.abs(slope_off).max()),
    )


def _columns(
    listed: list[Setting], costs: list[MeasuredCost], errors: list[Errors]
) -> dict[str, Any]:
    # of as many diameters as the sweep has, where only some were traced
    whole = np.array(
        [
            setting.config.sweep.diameters.num / cost.intensity.shape[0]
            for setting, cost in zip(listed, costs, strict=True)
        ]
    )
    column = {
        **{name: np.array([getattr(error, name) for error in errors]) for name in Errors._fields},
        "segments_per_diameter": np.array([cost.segments for cost in costs]),
        "cpu_seconds": whole * [cost.cpu_seconds for cost in costs],
        "peak_memory": np.array([cost.peak_memory for cost in costs]),
        "unreached": np.array([cost.unreached for cost in costs]),
        "diameters_traced": np.array([cost.intensity.shape[0] for cost in costs]),
    }
    return {name: ("setting", values) for name, values in column.items()}


def _law_errors(laws: list[FocusLine], exact: FocusLine, config: Config) -> dict[str, Any]:
    diameters = config.sweep.diameters.values()
    off = [np.abs(law.at(diameters) - exact.at(diameters)).max() for law in laws]
    return {
        "law_slope_error": ("setting", np.array([abs(law.slope - exact.slope) for law in laws])),
        "law_intercept_error": (
            "setting",
            np.array([abs(law.intercept - exact.intercept) for law in laws]),
        ),
        "focus_error": ("setting", np.array(off)),
    }


def _changes(listed: list[Setting], costs: list[MeasuredCost]) -> dict[str, Any]:
    """Return what dropping faint rays changes by itself: rays of one number differ by more."""
    factor, change = "tracing.min_amplitude", np.full(len(listed), np.nan)
    of_all = [
        cost.intensity
        for setting, cost in zip(listed, costs, strict=True)
        if (setting.factor, setting.value) == (factor, 0)
    ]
    if of_all:
        for i, setting in enumerate(listed):
            if setting.factor == factor:
                change[i] = intensity_errors(costs[i].intensity, of_all[0]).max()
    return {"intensity_change": ("setting", change)}


def _dataset(config: Config, listed: list[Setting], variables: dict[str, Any]) -> xr.Dataset:
    value = np.array([setting.value for setting in listed], float)
    factor = np.array([setting.factor for setting in listed])
    column = {name: values for name, (_, values) in variables.items()}
    segments, error = column["segments_per_diameter"], column["worst_intensity_error"]
    # points of other diameters and wavenumbers, and the reference, are not of this trade
    traced = np.array([s.factor == "run" or s.factor.startswith("tracing.") for s in listed])
    own = np.array([is_the_runs(setting, config) for setting in listed])
    # the sweep itself, and not the same setting as a point of another factor
    first = np.flatnonzero(own)[:1]
    flags = {
        "frontier": efficient(segments, np.where(traced, error, np.nan)),
        "phase_slope_frontier": efficient(
            column["cpu_seconds"], np.where(traced, column["phase_slope_rms_error"], np.nan)
        ),
        "default": np.isin(np.arange(value.size), first),
    }
    return make(
        "tradeoff",
        config,
        "Error against a converged reference, and cost, as one setting after the other is varied",
        {
            **variables,
            **comparison(factor, value, segments, error),
            **{name: ("setting", flag.astype(np.int8)) for name, flag in flags.items()},
            "preset": ("setting", [preset_of(setting) for setting in listed]),
        },
        {
            "setting": [f"{setting.factor} {setting.value:g}" for setting in listed],
            "factor": ("setting", factor.tolist()),
            "value": ("setting", value),
            "scheme": ("setting", [setting.config.tracing.scheme for setting in listed]),
            "target": [f"error of {COUNTED} rays", *(f"{target:g}" for target in TARGETS)],
        },
    )


def summary(dataset: xr.Dataset) -> str:
    """Return where the run and the presets are, in one line."""
    named = dataset.isel(setting=(dataset["preset"] != "") | (dataset["default"] == 1))
    places = [
        f"{str(one['preset'].item()) or 'this run'} {one['worst_intensity_error'].item():.1e} "
        f"with {one['segments_per_diameter'].item():.3g} segments a diameter"
        for one in (named.isel(setting=i) for i in range(named.sizes["setting"]))
    ]
    return f"tradeoff: error of the intensity {'; '.join(places)}"
