"""What accuracy costs: settings against a converged reference (`snakemake tradeoff`)."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.derive import by_accuracy, by_rays, reference
from octsim.config.models import Config, FocusLine
from octsim.config.ranges import even
from octsim.datasets.files import make
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.stages.focus_law import focus_law, sweep_foci
from octsim.stages.focus_sweep import focus_sweep
from octsim.stages.gaussian_fits import gaussian_fits
from octsim.studies.tradeoff.effect_costs import EFFECTS, effect_costs
from octsim.studies.tradeoff.errors import (
    Errors,
    MaxwellErrors,
    ReferenceSweep,
    errors_of,
    intensity_errors,
    maxwell,
    maxwell_errors_of,
    why_no_maxwell,
)
from octsim.studies.tradeoff.frontier import COUNTED, TARGETS, comparison, efficient
from octsim.studies.tradeoff.measured_cost import MeasuredCost, apart, sweep_cost
from octsim.studies.tradeoff.missing import setting_statuses
from octsim.studies.tradeoff.settings import (
    Setting,
    is_of_the_trade,
    is_of_waves,
    is_the_runs,
    preset_of,
    settings,
)

Array = NDArray[np.float64]
_NO_LAW = FocusLine.model_construct(slope=np.nan, intercept=np.nan)


def fitted_law(config: Config, threads: int, points: Points) -> xr.Dataset:
    """Return a config's focus law."""
    return focus_law(config, gaussian_fits(config, focus_sweep(config, threads, points)))


def tradeoff(
    config: Config,
    threads: int = 1,
    prepare: Callable[[], None] | None = None,
    chosen: Iterable[Setting] | None = None,
    separate: bool = True,
    points: Points | None = None,
    tried: Iterable[str] = EFFECTS,
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
    tried : iterable of str
        Effects that are measured by each scheme, by their names in `effects.nc`.

    Returns
    -------
    Dataset
        Errors, costs, and whether it is efficient, of each setting, and statuses that say why one
        is missing; how many times fewer segments light paths need than counted rays, for each
        target error; and what effects cost and change by each scheme.
    """
    even(config.sweep.diameters, "tradeoff")
    unsolved = why_no_maxwell(config)
    listed = list(settings(config, waves=not unsolved) if chosen is None else chosen)
    points = points or Points()
    # compiled code goes to the processes with this one's memory
    solved = () if unsolved else (maxwell(config, 0.1),)
    for least in (by_rays(config, 1), by_accuracy(config, 0.1), *solved):
        start = config.sweep.diameters.start
        Instrument(least).spectrum(start, start / 2)
    converged = reference(config)
    law = fitted_law(converged, threads, points)
    sweep_foci(converged, law)  # says what is wrong with a law that does not serve
    focus = config.sweep.focus
    line = focus if isinstance(focus, FocusLine) else FocusLine.fitted(law)
    rays = ReferenceSweep(config, line, threads, points)
    waves = None if unsolved else ReferenceSweep(config, line, threads, points, maxwell)
    # before what is not timed, whose memory would be there to use again
    costs = [_measured(setting, line, prepare, separate) for setting in listed]
    errors, from_maxwell = [], []
    for setting, cost in zip(listed, costs, strict=True):
        own = waves if waves is not None and is_of_waves(setting.config) else rays
        errors.append(errors_of(setting, cost.intensity, own))
        from_maxwell.append(maxwell_errors_of(setting, cost.intensity, waves))
    laws = [
        FocusLine.fitted(fitted_law(setting.config, threads, points)) if setting.law else _NO_LAW
        for setting in listed
    ]
    variables = {
        **_columns(listed, costs, errors, from_maxwell),
        **_law_errors(laws, FocusLine.fitted(law), config),
        **_changes(listed, costs),
    }
    effects = effect_costs(config, line, tried)
    table = _dataset(config, listed, variables, effects, solved=not unsolved)
    return table.assign_attrs(maxwell=unsolved or _maxwell_is(config))


def _maxwell_is(config: Config) -> str:
    """Say what errors from Maxwell are measured from."""
    exact = maxwell(config)
    pupil = exact.objective.pupil or "the mode of a fibre, of 5 um mode-field diameter"
    return f"scheme {exact.tracing.scheme} at {exact.tracing.accuracy:g}, pupil: {pupil}"


def _measured(
    setting: Setting, line: FocusLine, prepare: Callable[[], None] | None, separate: bool
) -> MeasuredCost:
    """Return what a setting costs, on this process or on one of its own."""
    diameters = setting.config.sweep.diameters.values()[:: setting.every]
    swept = setting.config, diameters, line.at(diameters)
    return apart(prepare, sweep_cost, *swept) if separate else sweep_cost(*swept)


def _columns(
    listed: list[Setting],
    costs: list[MeasuredCost],
    errors: list[Errors],
    from_maxwell: list[MaxwellErrors],
) -> dict[str, Any]:
    # of as many diameters as the sweep has, where only some were traced
    whole = np.array(
        [
            setting.config.sweep.diameters.num / cost.intensity.shape[0]
            for setting, cost in zip(listed, costs, strict=True)
        ]
    )
    waves = [is_of_waves(setting.config) for setting in listed]
    column = {
        **{name: np.array([getattr(error, name) for error in errors]) for name in Errors._fields},
        **{
            name: np.array([getattr(error, name) for error in from_maxwell])
            for name in MaxwellErrors._fields
        },
        "segments_per_diameter": np.where(waves, np.nan, [cost.segments for cost in costs]),
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


def _dataset(
    config: Config,
    listed: list[Setting],
    variables: dict[str, Any],
    effects: tuple[dict[str, Any], dict[str, Any]],
    *,
    solved: bool,
) -> xr.Dataset:
    value = np.array([setting.value for setting in listed], float)
    factor = np.array([setting.factor for setting in listed])
    column = {name: values for name, (_, values) in variables.items()}
    segments, error = column["segments_per_diameter"], column["worst_intensity_error"]
    # points of other diameters and wavenumbers, and the reference, are not of this trade
    traced = np.array([is_of_the_trade(s) for s in listed])
    # an error from rays' own limit and one from waves' are not of one trade
    by_rays = traced & np.array([not is_of_waves(s.config) for s in listed])
    own = np.array([is_the_runs(setting, config) for setting in listed])
    compared = comparison(factor, value, segments, error)
    of_each = column | {"rays_law_error": compared["rays_law_error"][1]}
    # the sweep itself, and not the same setting as a point of another factor
    first = np.flatnonzero(own)[:1]
    flags = {
        "frontier": efficient(segments, np.where(by_rays, error, np.nan)),
        "phase_slope_frontier": efficient(
            column["cpu_seconds"], np.where(by_rays, column["phase_slope_rms_error"], np.nan)
        ),
        "maxwell_frontier": efficient(
            column["cpu_seconds"], column["maxwell_spectrum_worst_error"]
        ),
        "maxwell_slope_frontier": efficient(
            column["cpu_seconds"], column["maxwell_slope_rms_error"]
        ),
        "default": np.isin(np.arange(value.size), first),
    }
    return make(
        "tradeoff",
        config,
        "Error against a converged reference, and cost, as one setting after the other is varied",
        {
            **variables,
            **compared,
            **setting_statuses(listed, of_each, solved=solved),
            **{name: ("setting", flag.astype(np.int8)) for name, flag in flags.items()},
            "preset": ("setting", [preset_of(setting) for setting in listed]),
            **effects[0],
        },
        {
            "setting": [f"{setting.factor} {setting.value:g}" for setting in listed],
            "factor": ("setting", factor.tolist()),
            "value": ("setting", value),
            "scheme": ("setting", [setting.config.tracing.scheme for setting in listed]),
            "target": [f"error of {COUNTED} rays", *(f"{target:g}" for target in TARGETS)],
            **effects[1],
        },
    )


def summary(dataset: xr.Dataset) -> str:
    """Return where the run and the presets are, in one line."""
    named = dataset.isel(setting=(dataset["preset"] != "") | (dataset["default"] == 1))
    places = [
        f"{str(one['preset'].item()) or 'this run'} {one['worst_intensity_error'].item():.1e} "
        f"from its limit, {one['maxwell_spectrum_worst_error'].item():.1e} from Maxwell, "
        f"in {one['cpu_seconds'].item():.3g} s"
        for one in (named.isel(setting=i) for i in range(named.sizes["setting"]))
    ]
    return f"tradeoff: error of the intensity {'; '.join(places)} ({dataset.attrs['maxwell']})"
