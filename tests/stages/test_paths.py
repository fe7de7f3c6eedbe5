"""What each light path has in the spectra: its own literal sum, and all of them together."""

import cmath

import numpy as np
import pytest
import reference
import xarray as xr
from gridded import GIVEN, SMALL
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


@pytest.mark.filterwarnings("ignore::octsim.base.errors.OctsimWarning")
def test_paths_of_a_grid_over_scenes_are_told_apart_by_their_names() -> None:
    lifted = {"scene.cylinders.0.elevation": ["0 deg", "5 deg"]}
    config = octsim.load_config(SMALL, GIVEN, {"grid": lifted})
    detected = octsim.detections(config)
    paths = octsim.light_paths(config, detected)
    names = paths["path"].values.tolist()
    assert len(set(names)) == len(names) == len(set(paths["path_code"].values.tolist()))
    assert np.allclose(paths["share"].sum("path"), 1, atol=1e-12)
    level, tilted = (
        paths["path_rays"].isel(cylinders_0_elevation=one).sum("diameter") for one in (0, 1)
    )
    assert (level.sel(path="PT CR PT") > 0) & (tilted.sel(path="PT CR PT") > 0)
    by_foot = [name for name in names if "foot" in name]
    assert by_foot
    assert not level.sel(path=by_foot).any()
    assert tilted.sel(path=by_foot).any()
    for elevation, lone in (("0 deg", level), ("5 deg", tilted)):
        one = {"scene": {"cylinders": [{"medium": "neuron", "elevation": elevation}]}}
        alone = octsim.load_config(SMALL, GIVEN, one)
        found = octsim.light_paths(alone, octsim.detections(alone))["path_rays"].sum("diameter")
        assert lone.sel(path=found["path"]).values.tolist() == found.values.tolist()
