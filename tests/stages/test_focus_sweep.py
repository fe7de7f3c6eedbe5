"""The intensity over the focus, for the diameters of the focus law."""

import numpy as np
import pytest
import reference
import xarray as xr
from literal import literal
from made_runs import WHOLE

import octsim
from octsim.config.following import fitted_diameters

CONFIG = octsim.load_config(WHOLE)


def test_foci_are_fractions_of_the_diameter(stages: dict[str, xr.Dataset]) -> None:
    swept = stages["focus_sweep"]
    assert np.array_equal(swept["diameter"], fitted_diameters(CONFIG).values())
    assert np.array_equal(swept["fraction"], CONFIG.focus_law.fraction.values())
    expected = (swept["fraction"] * swept["diameter"]).transpose("diameter", "fraction")
    assert np.array_equal(swept["focus"], expected)


def test_intensity_is_the_mean_of_the_literal_spectrum(stages: dict[str, xr.Dataset]) -> None:
    swept = stages["focus_sweep"]
    for row, column in ((0, 0), (1, 5), (2, 10)):
        at = swept.isel(diameter=row, fraction=column)
        found = literal(CONFIG, float(at["diameter"]), float(at["focus"])).detections
        expected = reference.spectrum(found, reference.wavenumbers()).mean()
        assert float(at["intensity"]) == pytest.approx(expected, rel=1e-9)


def test_a_scan_of_one_of_its_diameters_has_the_same_intensity(
    stages: dict[str, xr.Dataset],
) -> None:
    at = stages["focus_sweep"].isel(diameter=1)
    first, last = at["focus"].values[[0, -1]].tolist()
    scanned = octsim.focus_scan(
        octsim.load_config(
            WHOLE,
            {
                "focus_scan": {
                    "diameter": f"{float(at['diameter'])!r} um",
                    "focus": {"start": f"{first!r} um", "stop": f"{last!r} um", "num": 11},
                }
            },
        )
    )
    for name in ("intensity", "intensity_error"):
        assert np.allclose(scanned[name], at[name], rtol=1e-9, atol=0)
