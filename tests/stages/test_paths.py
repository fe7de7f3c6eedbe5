"""What each light path has in the spectra: its own literal sum, and all of them together."""

import cmath

import numpy as np
import pytest
import reference
import xarray as xr
from literal import literal
from made_runs import WHOLE

import octsim


def test_a_path_s_field_is_the_literal_sum_of_its_rays(stages: dict[str, xr.Dataset]) -> None:
    k = stages["spectra"]["wavenumber"].values
    middle = float(k[0] + k[-1]) / 2
    at = stages["paths"].isel(diameter=3)
    focus = float(stages["spectra"]["focus"][3])
    found = literal(octsim.load_config(WHOLE), float(at["diameter"]), focus).detections
    assert {ray.path for ray in found} == set(at["path"].values[at["path_rays"].values > 0])
    for name in at["path"].values[:6]:
        rays, one = [ray for ray in found if ray.path == name], at.sel(path=name)
        expected = reference.field_at(rays, middle)
        field = cmath.rect(float(one["field_amplitude"]), float(one["field_phase"]))
        assert field == pytest.approx(expected, rel=1e-7)
        assert int(one["path_rays"]) == len(rays)
        size = np.abs([ray.amplitude for ray in rays])
        mean = np.average([ray.optical_path_length for ray in rays], weights=size)
        assert float(one["mean_optical_path_length"]) == pytest.approx(mean, rel=1e-12)


def test_the_shares_of_all_paths_sum_to_one(stages: dict[str, xr.Dataset]) -> None:
    shares = stages["paths"]["share"].sum("path")
    assert np.allclose(shares, 1, atol=1e-12)
    assert list(stages["paths"]["path"].values[:3]) == ["PT CT CR CT PT", "PT CR PT", "PR"]


def test_the_paths_fields_sum_to_the_spectrum(stages: dict[str, xr.Dataset]) -> None:
    paths, spectra = stages["paths"], stages["spectra"]
    fields = paths["field_amplitude"] * np.exp(1j * paths["field_phase"].fillna(0))
    k = spectra["wavenumber"]
    middle = float(k[0] + k[-1]) / 2
    expected = spectra["intensity"].interp(wavenumber=middle, method="cubic")
    assert np.allclose(np.abs(fields.sum("path")) ** 2, expected, rtol=1e-3)
