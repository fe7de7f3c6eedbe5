"""The part on effects of the page of what accuracy costs, written from `tradeoff.nc`."""

import numpy as np
import xarray as xr
from markdown import table


def effect_costs_part(trade: xr.Dataset) -> str:
    """Write what each kind of effect costs, and what it changes, by each scheme."""
    schemes = [str(name) for name in trade["effect_scheme"].values]
    rows = []
    for name in trade["effect"].values:
        one = trade.sel(effect=name)
        rows.append([str(name), *(_cell(one.sel(effect_scheme=scheme)) for scheme in schemes)])
    return table(["effect", *schemes], rows)


def _cell(one: xr.Dataset) -> str:
    ratio, change = float(one["effect_cost_ratio"]), float(one["effect_intensity_change"])
    return f"× {ratio:.3g} ({change:.1e})" if np.isfinite(ratio) else "–"
