"""A run over listed diameters is the run over the range that they are, to the bit."""

import numpy as np
import xarray as xr
from made_runs import every_stage

from octsim.config.load import load_config

LISTED = ["1.2 um", "1.3 um", "1.35 um", "1.4 um", "1.55 um"]
SMALL = {
    "tracing": {"rays": 200},
    "spectrum": {"samples": 64},
    "focus_scan": {"diameter": None, "focus": {"num": 5}},
    "focus_law": {"diameters": None, "fraction": {"num": 9}},
}


def test_a_list_of_evenly_spaced_diameters_gives_the_range_s_bits() -> None:
    evenly = {"start": "1.2 um", "stop": "1.4 um", "num": 5}
    one = load_config(SMALL, {"sweep": {"diameters": evenly}})
    values = [f"{value!r} um" for value in one.sweep.diameters.values().tolist()]
    other = load_config(SMALL, {"sweep": {"diameters": values}})
    by_range, by_list = every_stage(one), every_stage(other)
    for stage, dataset in by_range.items():
        xr.testing.assert_identical(dataset.drop_attrs(), by_list[stage].drop_attrs())


def test_a_slope_of_uneven_diameters_is_by_their_own_distances() -> None:
    made = every_stage(load_config(SMALL, {"sweep": {"diameters": LISTED}}))
    slopes, phase = made["phase_slope"], made["fourier"]["phase"]
    diameter = np.array([float(text.removesuffix(" um")) for text in LISTED])
    assert np.array_equal(slopes["diameter"], diameter)
    component = int(slopes["strongest_component"][2])
    unwrapped = np.unwrap(phase.isel(component=component).values)
    expected = np.gradient(unwrapped, diameter)[2]
    np.testing.assert_allclose(slopes["phase_slope"][2], expected, rtol=1e-9)
