"""The field by Maxwell's equations, as it is stored: it gives the spectra, and its parts."""

import numpy as np
import pytest
import xarray as xr
from made_runs import every_stage
from scipy.interpolate import BarycentricInterpolator

import octsim
from octsim.config.derive import merge
from octsim.schemes.light import AccuracyStatus

SMALL = {
    "tracing": {"preset": "exact"},
    "focus_scan": {"focus": {"num": 3}},
    "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 5}},
    "spectrum": {"samples": 60},
    "sweep": {"diameters": {"start": "0.6 um", "stop": "2 um", "num": 4},
              "focus": {"slope": 0.581, "intercept": "69 nm"}},
}  # fmt: skip


@pytest.fixture(scope="module")
def run() -> dict[str, xr.Dataset]:
    return every_stage(octsim.load_config(SMALL))


def field(at: xr.Dataset, k: np.ndarray) -> np.ndarray:
    """Return both polarisations' field at wavenumbers, from nodes with their phase back in."""
    there = np.isfinite(at["node_wavenumber"].values)
    node = at["node_wavenumber"].values[there]
    values = (at["real"] + 1j * at["imaginary"]).values[:, there]
    smooth = np.stack([BarycentricInterpolator(node, one)(k) for one in values])
    return smooth * np.exp(1j * k * float(at["removed_optical_path_length"]))


def test_the_spectrum_is_the_mean_intensity_of_both_polarisations(
    run: dict[str, xr.Dataset],
) -> None:
    k = run["spectra"]["wavenumber"].values
    for row in range(4):
        at = run["fields"].isel(diameter=row)
        expected = (np.abs(field(at, k)) ** 2).mean(axis=0)
        assert np.allclose(run["spectra"]["intensity"][row], expected, rtol=1e-9, atol=0)


def test_the_field_is_stored_as_design_has_it(run: dict[str, xr.Dataset]) -> None:
    fields = run["fields"]
    assert fields["real"].dims == fields["imaginary"].dims == ("diameter", "polarisation", "node")
    assert (fields["accuracy_status"] == AccuracyStatus.REACHED).all()
    # a larger cylinder's field takes more nodes; those that a smaller one lacks are NaN
    counts = np.isfinite(fields["node_wavenumber"].values).sum(axis=1)
    assert (np.diff(counts) >= 0).all()
    assert counts[0] < counts[-1]
    assert (np.isfinite(fields["real"].values[:, 0]).sum(axis=1) == counts).all()


def test_the_parts_shares_sum_to_one_and_the_far_side_s_path_is_longer_by_the_cylinder(
    run: dict[str, xr.Dataset],
) -> None:
    paths = run["paths"]
    assert paths["path"].values.tolist() == ["plane", "near side", "far side", "rest"]
    assert np.allclose(paths["share"].sum("path"), 1, atol=1e-12)
    length = paths["mean_optical_path_length"]
    apart = (length.sel(path="far side") - length.sel(path="near side")).values
    # but for the phase of focused light itself (Gouy's)
    assert np.allclose(apart, 2 * 1.39 * paths["diameter"].values, rtol=0, atol=0.2)


def test_a_grid_over_schemes_has_the_light_of_each_where_it_belongs() -> None:
    grid = {"grid": {"tracing": [{"scheme": "vogel", "rays": 200}, {"preset": "exact"}]}}
    overlay = {key: value for key, value in SMALL.items() if key != "tracing"}
    made = every_stage(octsim.load_config(overlay, grid))
    rays = every_stage(octsim.load_config(overlay, {"tracing": {"rays": 200}}))
    waves = every_stage(octsim.load_config(SMALL))
    for place, plain in enumerate((rays, waves)):
        own = made["spectra"]["intensity"].isel(tracing=place)
        assert np.array_equal(own, plain["spectra"]["intensity"])
    assert np.isnan(made["fields"]["real"].isel(tracing=0)).all()
    assert np.array_equal(
        made["fields"]["real"].isel(tracing=1), waves["fields"]["real"], equal_nan=True
    )


def test_a_polarisation_is_of_the_spectra_and_not_of_the_field() -> None:
    crossed = merge(SMALL, {"polarisation": {"input": "0 deg", "analyser": "90 deg"}})
    turned = merge(SMALL, {"polarisation": {"input": "45 deg", "analyser": "45 deg"}})
    plain, dark, both = (octsim.load_config(one) for one in (SMALL, crossed, turned))
    fields = octsim.fields(plain)
    # across and along the cylinder nothing is turned
    assert octsim.spectra(dark, fields=fields)["intensity"].max() < 1e-30
    k = plain.spectrum.wavenumbers()
    expected = [np.abs(field(fields.isel(diameter=n), k).mean(axis=0)) ** 2 for n in range(4)]
    found = octsim.spectra(both, fields=fields)["intensity"]
    assert np.allclose(found, expected, rtol=1e-8)


def test_light_that_is_not_given_is_asked_for_by_name() -> None:
    with pytest.raises(octsim.OctsimError, match="fields: not given"):
        octsim.spectra(octsim.load_config(SMALL))
