"""What each effect changes in a scene, and what it costs (`snakemake effects`)."""

from typing import Any

import numpy as np
import xarray as xr

from octsim.config.models import Config
from octsim.datasets.files import flags, make
from octsim.optics.two_beams import predicted_phase_slope
from octsim.schemes.light import AccuracyStatus
from octsim.stages.focus_law import focus_line
from octsim.studies.effects.bench import Bench, Result, bench_of, for_noise, measured
from octsim.studies.effects.changes import change, local_slopes, mean_phase_slope, stacked, unwraps
from octsim.studies.effects.missing import ChangeStatus, change_status, change_statuses
from octsim.studies.effects.needed import (
    LOCAL_TOLERANCE,
    MEAN_TOLERANCE,
    ranks,
    sentence,
    verdict,
)
from octsim.studies.effects.pairs import columns_of, pairs_of
from octsim.studies.effects.variants import EffectStatus, variants

DIAMETERS = 51
"""Of the sweep's range, ends included."""


def effects(
    config: Config,
    law: xr.Dataset | None = None,
    threads: int = 1,
    number: int = DIAMETERS,
) -> xr.Dataset:
    """Measure each effect alone, and pairs of the largest, at the foci of the configured line.

    The focus law is not fitted anew with an effect. Phases are those of a least-squares sinusoid
    at the depth that the configured scene has; what the config already has is switched off instead.
    Rays that are counted are the same with an effect and without it. The noise is what half of
    the rays, or a tenth of the accuracy, change of the change.

    Parameters
    ----------
    config : Config
    law : Dataset, optional
        The fitted law; needed only where ``sweep.focus`` is ``law``.
    threads : int
        How many points are at work at a time.
    number : int
        How many diameters.

    Returns
    -------
    Dataset
        The measures of `octsim.studies.effects.changes.Measures` and their noise,
        calibration_change, cost_ratio, effect_status, rank, resolved and needed (effect);
        effect_phase_change and effect_slope_change (effect, diameter); of pairs what they have
        beyond their parts; and statuses, which say why a number is missing.

    Raises
    ------
    OctsimError
        If the law is needed and could not be fitted.
    """
    bench = bench_of(config, focus_line(config, law), number, threads)
    results = [measured(bench, variant) for variant in variants(bench.config)]
    pairs = pairs_of(bench, results)
    baseline, slope = _baseline(bench, results)
    table = make(
        "effects",
        config,
        "What each effect changes of the spectra and of the calibration, alone and in pairs",
        {
            **baseline,
            **_columns(results, slope),
            **_statuses(bench, results),
            **_by_diameter(bench, results),
            **columns_of(bench, results, pairs, slope),
        },
        {
            "effect": [one.variant.effect.name for one in results],
            "effect_kind": ("effect", [one.variant.effect.kind for one in results]),
            "diameter": bench.diameter,
            "focus": ("diameter", bench.foci),
            "pair": [one.result.variant.effect.name for one in pairs],
        },
    )
    table.attrs |= {"mean_tolerance": MEAN_TOLERANCE, "local_tolerance": LOCAL_TOLERANCE}
    return table.assign_attrs(sentence=sentence(table))


def _baseline(bench: Bench, results: list[Result]) -> tuple[dict[str, Any], float]:
    """Return what the baseline is, and its slope, mrad/nm."""
    found = next(one.spectra for one in results if one.variant.effect.focus)
    own = bench.seen(found.without_effect, found.error)
    k = bench.config.spectrum.wavenumbers()
    predicted = predicted_phase_slope(bench.config.swept_material, k[0], k[-1])
    slope = mean_phase_slope(own, bench.diameter, predicted)
    rest = own._replace(phase=own.phase - predicted * bench.diameter)
    local = local_slopes(change(rest, own._replace(phase=0 * own.phase)), bench.diameter)
    values: dict[str, Any] = {
        "baseline_slope": slope,
        "baseline_local_scatter": float(np.nanstd(local)),
        "baseline_configured_slope": float(own.slope.mean()),
        "baseline_configured_scatter": float(own.slope.std()),
        "baseline_seconds": float(np.median(found.seconds[1])),
    }
    status = change_status(values["baseline_local_scatter"])
    apart = not unwraps(bench.config, bench.diameter)
    configured = change_status(values["baseline_configured_slope"], apart=apart)
    values["baseline_status"] = (), *flags(ChangeStatus, status)
    values["baseline_configured_status"] = (), *flags(ChangeStatus, configured)
    return values, slope


def _columns(results: list[Result], slope: float) -> dict[str, Any]:
    values = stacked([one.measures for one in results])
    values |= {f"{name}_noise": v for name, v in stacked([o.noise for o in results]).items()}
    for suffix in ("", "_noise"):
        values[f"calibration_change{suffix}"] = values[f"mean_slope_change{suffix}"] / slope
    found = [one.found for one in results]
    status = np.array([one.status for one in results])
    accuracy = [one.status if one else AccuracyStatus.NOT_CONTROLLED for one in found]
    columns: dict[str, Any] = {
        **values,
        **verdict(values, slope),
        "rank": ranks(values["mean_slope_change"]),
        "cost_ratio": np.array([one.cost_ratio if one else np.nan for one in found]),
        "diameters_with_fringe": np.array(
            [0 if one.change is None else np.isfinite(one.change.phase).sum() for one in results]
        ),
        "intensity_error": np.array([one.error.max() if one else np.nan for one in found]),
    }
    return {
        **{name: ("effect", column) for name, column in columns.items()},
        "effect_status": ("effect", *flags(EffectStatus, status)),
        "accuracy_status": ("effect", *flags(AccuracyStatus, np.array(accuracy))),
        "effect_meaning": ("effect", [one.variant.effect.what for one in results]),
        "able_schemes": ("effect", [", ".join(one.variant.able) for one in results]),
    }


def _statuses(bench: Bench, results: list[Result]) -> dict[str, Any]:
    """Return why measures of effects and their noise are missing."""
    has = np.array([one.found is not None for one in results])
    known = stacked([one.measures for one in results])
    del known["mean_slope_change"]  # which effect_status says
    fewer, noise = for_noise(bench), stacked([one.noise for one in results])
    found = change_statuses(bench, known, has) | change_statuses(fewer, noise, has, noise=True)
    return {name: ("effect", *told) for name, told in found.items()}


def _by_diameter(bench: Bench, results: list[Result]) -> dict[str, Any]:
    nothing = np.full(bench.diameter.size, np.nan)
    changes = [one.change for one in results]
    local = [nothing if one is None else local_slopes(one, bench.diameter) for one in changes]
    phase = [nothing if one is None else one.phase for one in changes]
    has, over = np.array([[one is not None] for one in changes]), ("effect", "diameter")
    found = {"phase": np.stack(phase), "slope": np.stack(local)}
    return {
        **{f"effect_{name}_change": (over, values) for name, values in found.items()},
        **{
            f"{name}_change_status": (over, *flags(ChangeStatus, change_status(values, has)))
            for name, values in found.items()
        },
    }
