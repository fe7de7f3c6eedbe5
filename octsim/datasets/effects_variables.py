"""What each variable of `effects.nc` is, and its unit: what effects change, and cost."""

from collections.abc import Mapping

_MEASURES = {
    "spectrum_change": ("1", "change of the intensity over its maximum, median of the diameters"),
    "shape_change": ("1", "change of the intensity over its mean, median of the diameters"),
    "signal_ratio": ("1", "mean intensity over that without, median of the diameters"),
    "mean_slope_change": ("mrad/nm", "change of the mean phase slope"),
    "slope_change_scatter": ("mrad/nm", "scatter of the change of the local phase slope"),
    "worst_slope_change": ("mrad/nm", "largest change of the local phase slope"),
    "configured_slope_change": ("mrad/nm", "mean change of the slope by the run's estimator"),
    "configured_local_change": ("mrad/nm", "scatter of that change over the diameters"),
}
_ALONE = {
    **_MEASURES,
    "calibration_change": ("1", "change of the mean phase slope, relative to it"),
}

EFFECTS: Mapping[str, tuple[str, str]] = {
    # name: (units, long_name)
    **_ALONE,
    **{f"{name}_noise": (unit, f"noise of the {what}") for name, (unit, what) in _ALONE.items()},
    **{f"pair_{name}": (unit, f"of a pair: {what}") for name, (unit, what) in _ALONE.items()},
    "effect": ("1", "effect that is tried, at a size"),
    "effect_kind": ("1", "what it is one of"),
    "effect_meaning": ("1", "what the effect is"),
    "effect_status": ("1", "whether the change is measured, and why not"),
    "able_schemes": ("1", "schemes that honour the effect"),
    "cost_ratio": ("1", "processor time of a point over that without the effect, median"),
    "diameters_with_fringe": ("1", "number of diameters with a fringe, with it and without"),
    "rank": ("1", "place by the change of the mean phase slope; 0 where it is not measured"),
    "resolved": ("1", "whether the change of the mean phase slope is above its noise"),
    "needed": ("1", "whether it moves the phase slope by more than the tolerances"),
    "undecided": ("1", "whether noise hides if it does"),
    "effect_phase_change": ("rad", "change of the phase"),
    "effect_slope_change": ("mrad/nm", "change of the local phase slope"),
    "baseline_slope": ("mrad/nm", "slope of the line through the phase, as configured"),
    "baseline_local_scatter": ("mrad/nm", "scatter of the local phase slope, as configured"),
    "baseline_configured_slope": ("mrad/nm", "mean slope by the run's estimator"),
    "baseline_configured_scatter": ("mrad/nm", "scatter of the slope by the run's estimator"),
    "baseline_seconds": ("s", "processor time of a point as configured, median"),
    "pair": ("1", "two effects at once"),
    "pair_first": ("1", "the larger one of a pair"),
    "pair_second": ("1", "the other one of a pair"),
    "pair_sum": ("mrad/nm", "sum of the changes of the mean phase slope of each alone"),
    "pair_excess": ("mrad/nm", "change of the mean phase slope beyond that sum"),
    "pair_excess_noise": ("mrad/nm", "noise of the change beyond the sum"),
    "pair_local_excess": ("mrad/nm", "scatter of the local phase slope beyond the sum"),
    "pair_adds_up": ("1", "whether a pair is the sum of its parts, within noise or tolerance"),
    "pair_cost_ratio": ("1", "processor time of a point over that without the pair, median"),
}
