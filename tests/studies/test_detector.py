"""The detector's falloff and radius: edge rays, ray noise, Maxwell's, and what is recommended."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from missing import unexplained

from octsim.base.errors import ConfigError
from octsim.config.derive import changed, counting_rays
from octsim.config.load import load_config
from octsim.datasets.files import read, write
from octsim.figures.detector import detector_figure
from octsim.figures.style import look, save
from octsim.instrument.instrument import Instrument
from octsim.schemes.returned_rays import LENGTH, Returned, X, Y
from octsim.stages.by_maxwell import ExactStatus
from octsim.studies.detector import cases as cases_module
from octsim.studies.detector.cases import FALLOFFS, LimitStatus, cases, radii_of
from octsim.studies.detector.collected import LARGER, collected, optics_by, returned
from octsim.studies.detector.over_diameter import jumps, over_diameter
from octsim.studies.detector.recommended import (
    as_close,
    chosen,
    doubts,
    least,
    own,
    recommendation,
    summary,
)
from octsim.studies.detector.study import detector

LINE = {"slope": 0.58, "intercept": "64 nm"}
RUN = load_config(
    {
        "tracing": {"rays": 1000},
        "spectrum": {"samples": 200},
        "sweep": {"focus": LINE, "diameters": {"start": "1.2 um", "stop": "1.26 um", "num": 7}},
    }
)


@pytest.fixture(scope="module")
def few() -> xr.Dataset:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cases_module, "RADII", (0.07, 0.2))
        return detector(RUN)


def test_every_falloff_is_compared_at_every_radius_and_the_run_s_own() -> None:
    every, radii = cases(RUN), radii_of(RUN)
    assert len(every) == len(FALLOFFS) * len(radii)
    assert 0.11 in np.round(radii, 12)
    assert radii == sorted(radii)
    for case in every:
        assert case.counted.detector.falloff == case.falloff
        assert case.counted.detector.core_diameter == pytest.approx(40 * case.radius)
        # all else is the run's
        assert changed(case.counted, {"detector": RUN.to_dict()["detector"]}) == counting_rays(RUN)
    known = {case.falloff for case in every if case.status == LimitStatus.KNOWN}
    assert known == set(FALLOFFS) - {"fibre"}
    wide = changed(RUN, {"detector": {"falloff": "gaussian", "mode_field_diameter": "10 um"}})
    assert 0.25 in np.round(radii_of(wide), 12)


@pytest.mark.parametrize(
    ("overlay", "key"),
    [
        ({"polarisation": {"input": "left"}}, r"polarisation\.input: left"),
        ({"scene": {"attenuation": {"neuron": "100 /cm"}}}, r"scene\.attenuation\.neuron"),
        ({"beam": {"waist": "diffraction"}}, r"beam\.waist"),
    ],
)
def test_rays_that_are_not_the_same_for_all_are_refused_by_name(
    overlay: dict[str, object], key: str
) -> None:
    with pytest.raises(ConfigError, match=key):
        cases(changed(RUN, overlay))


@pytest.mark.parametrize("falloff", FALLOFFS)
def test_what_is_collected_of_rays_found_once_is_what_the_instrument_sees(falloff: str) -> None:
    every = [case for case in cases(RUN) if case.falloff in (falloff, "fibre")]
    optics, focus = optics_by([case.counted for case in every]), 0.58 * 1.3 + 0.064
    rays = returned(every[0].counted, optics, 1.3, focus)
    for case, one in zip(every, optics, strict=True):
        if case.falloff != falloff or round(case.radius, 2) not in (0.07, 0.11, 0.4):
            continue
        seen = Instrument(case.counted).spectrum(1.3, focus).intensity
        found = collected(one, rays, rays)
        # a falloff that depends on the wavenumber is interpolated over the band
        allowed = 1e-6 if falloff == "fibre" else 1e-12
        assert np.abs(found.intensity - seen).max() < allowed * seen.max()
        assert np.array_equal(found.swapped, found.intensity)
        assert found.edge_rays == 0


def at(x: list[float], ray: list[int]) -> Returned:
    """Return rays of amplitude 1/100 that leave the focal plane at places, with no scene."""
    numbers = np.zeros((6, len(x)))
    numbers[X], numbers[Y], numbers[LENGTH], numbers[5] = x, 0.0, np.arange(len(x)), 0.01
    number = np.array(ray)
    return Returned(number, np.ones_like(number), numbers, 0, np.zeros(7, np.int64))


def test_edge_rays_are_those_that_cross_the_detector_s_edge() -> None:
    (optics,) = optics_by([c.counted for c in cases(RUN) if str(c[:2]) == "('top_hat', 0.2)"])
    # ray 2 leaves, ray 3 enters, ray 4 takes its path at the first diameter only
    now = at([0.0, 0.1, 0.199, 0.201, 0.15], [0, 1, 2, 3, 4])
    larger = at([0.0, 0.1, 0.201, 0.199], [0, 1, 2, 3])
    found = collected(optics, now, larger)
    assert (found.rays, found.edge_rays) == (4, 2)
    assert found.effective_rays == pytest.approx(4)
    assert found.edge_amplitude == pytest.approx(0.5)
    assert found.outermost == pytest.approx(0.25)
    k = optics.wavenumber
    fields = [np.exp(1j * k * length) for length in range(5)]
    assert found.intensity == pytest.approx(1e-4 * abs(sum(fields[j] for j in (0, 1, 2, 4))) ** 2)
    assert found.swapped == pytest.approx(1e-4 * abs(sum(fields[j] for j in (0, 1, 3, 4))) ** 2)


def test_a_line_its_scatter_and_jumps_are_those_of_known_phases() -> None:
    diameter = np.linspace(1, 2, 51)
    rough = 0.01 * (-1.0) ** np.arange(51)
    phase = np.angle(np.exp(1j * (23.0 * diameter + 0.2)))
    found = over_diameter(diameter, np.stack([phase, phase + rough]), 23.2)
    assert found.line == pytest.approx([23.0, 23.0], abs=1e-3)
    assert found.slope[0] == pytest.approx(np.full(51, 23.0))
    assert found.scatter[0] == pytest.approx(0, abs=1e-9)
    # a steady difference is none
    steady = phase + 0.3 * diameter + 0.1
    assert jumps(steady, phase) == pytest.approx(0, abs=1e-12)
    assert jumps(phase + rough, phase) == pytest.approx(0.04)
    # coarse steps, of more than a turn, and gaps
    few = np.array([1.0, 1.3, 1.5, 1.9])
    known = 23.0 * few + np.array([0.0, 0.0, np.nan, 0.0])
    assert over_diameter(few, known, 23.2).line == pytest.approx(23.0)


def test_a_hard_edge_jumps_and_a_bell_curve_does_not(few: xr.Dataset) -> None:
    edge = few["edge_phase_jump"].max("detector_radius")
    assert edge.sel(falloff="top_hat") > 20 * edge.sel(falloff="parabolic")
    assert edge.sel(falloff=["gaussian", "fibre"]).max() < 1e-6
    noise = few["ray_noise"]
    assert (noise.sel(falloff="top_hat") > noise.sel(falloff="parabolic")).all()
    assert (noise.sel(falloff="parabolic") > noise.sel(falloff="gaussian")).all()
    assert noise.sel(falloff="fibre").isnull().all()
    jump = few["phase_jump"]
    assert (jump.sel(falloff="top_hat") > jump.sel(falloff="parabolic")).all()
    assert (few["signal"].sel(falloff="top_hat") > few["signal"].sel(falloff="parabolic")).all()


def test_counted_rays_and_their_limit_have_the_same_slope(few: xr.Dataset) -> None:
    line = few["line_slope"].sel(falloff=["parabolic", "cosine", "gaussian"])
    assert np.abs(line.sel(ray_scheme="vogel") - line.sel(ray_scheme="paths")).max() < 0.2
    assert few["limit_status"].sel(falloff="fibre").values.tolist() == [
        LimitStatus.BEYOND_PATHS
    ] * few.sizes["detector_radius"]  # fmt: skip


def test_the_slope_by_maxwell_is_that_of_its_spectra(few: xr.Dataset) -> None:
    assert int(few["exact_status"]) == ExactStatus.COMPARED
    away = few["ray_phase_slope"] - few["sweep_maxwell_phase_slope"]
    expected = np.sqrt((away**2).mean("diameter"))
    xr.testing.assert_allclose(few["slope_difference"], expected)
    xr.testing.assert_allclose(few["slope_bias"], away.mean("diameter"))
    assert few["shape_difference"].sel(ray_scheme="vogel").min() > 0.1


def test_without_maxwell_ray_noise_alone_decides(few: xr.Dataset) -> None:
    names = ["slope_difference", "slope_bias", "shape_difference", "sweep_maxwell_phase_slope"]
    without = few.assign({name: few[name] * np.nan for name in names})
    without["exact_status"] = few["exact_status"] * 0 + ExactStatus.BEYOND_SCHEME
    assert as_close(without).all()
    assert chosen(without) == least(few["ray_noise"])
    assert "Maxwell" not in recommendation(without)
    assert any("nothing is compared" in line for line in doubts(without))


def test_the_recommendation_follows_from_the_numbers(few: xr.Dataset) -> None:
    said, taken = recommendation(few), chosen(few)
    assert taken is not None
    assert few.attrs["recommendation"] == said
    assert f"least ray noise: {least(few['ray_noise'])}" in said
    assert f"{{falloff: {taken.falloff}, " in said
    assert own(few).falloff == "parabolic"
    assert own(few).radius == pytest.approx(0.11)
    assert bool(as_close(few).sel(taken.at))
    # with other numbers it is another
    noise = few["ray_noise"].copy()
    noise.loc[own(few).at] = 1e-9
    other = few.assign(ray_noise=noise)
    assert "keep it" in recommendation(other)
    unknown = few.assign(ray_noise=few["ray_noise"] * np.nan)
    assert "no ray noise is known" in recommendation(unknown)


def test_detectors_are_told_apart_where_their_differences_scatter_less(few: xr.Dataset) -> None:
    assert as_close(few).all()  # seven diameters do not tell
    many = xr.concat([few] * 8, "diameter", data_vars="minimal")
    exact = many["sweep_maxwell_phase_slope"]
    rays = many["ray_phase_slope"]
    noise = rays.copy(data=0.5 * np.random.default_rng(1).normal(size=rays.shape))
    far = 2.0 * (many["falloff"] == "top_hat")
    many["ray_phase_slope"] = (noise + exact + far).transpose(*rays.dims)
    rms = np.sqrt(((many["ray_phase_slope"] - exact) ** 2).mean("diameter"))
    many["slope_difference"] = rms
    close = as_close(many)
    assert not close.sel(falloff="top_hat").any()
    assert close.sel(falloff=[name for name in FALLOFFS if name != "top_hat"]).mean() > 0.7


def test_more_diameters_than_are_compared_are_taken_over_their_range() -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cases_module, "RADII", ())
        found = detector(RUN, number=3)
    assert found["diameter"].values == pytest.approx([1.2, 1.23, 1.26])
    assert found["focus"].values == pytest.approx(0.58 * found["diameter"].values + 0.064)


def test_the_study_is_kept_told_and_drawn(few: xr.Dataset, tmp_path: Path) -> None:
    write(few, tmp_path / "detector.nc")
    kept = read(tmp_path / "detector.nc", "detector", RUN)
    xr.testing.assert_equal(kept, few)
    assert summary(kept) == f"detector: {recommendation(few)}"
    assert json.loads(kept.attrs["config"])["tracing"]["rays"] == 1000
    assert LARGER == 1e-3
    with look():
        save(detector_figure(kept), tmp_path / "detector.png")
    assert (tmp_path / "detector.png").stat().st_size > 10_000


def test_a_status_says_why_a_number_is_missing(few: xr.Dataset) -> None:
    assert list(unexplained(few)) == []
