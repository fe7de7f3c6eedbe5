"""Grids: what a config varies, and datasets over it that equal those of every plain config."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import octsim
from octsim.base.errors import ConfigError, OctsimError
from octsim.config.grid import axes, combinations, remarks, without_grid
from octsim.config.load import load_config
from octsim.config.messages import known_keys
from octsim.config.models import Config
from octsim.datasets.axes import axis_name, dimension_name
from octsim.datasets.keys import stage_axes
from octsim.datasets.reader import Stored
from octsim.datasets.writer import write_stream
from octsim.schemes.light import AccuracyStatus
from octsim.stages import workload
from octsim.stages.phase_slope import summary
from octsim.stages.spectra import doubts

SMALL: dict[str, Any] = {
    "tracing": {"rays": 150},
    "spectrum": {"samples": 40},
    "focus_scan": {"focus": {"num": 5}},
    "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 9}},
    "sweep": {"diameters": {"start": "1.2 um", "stop": "1.3 um", "num": 5}},
}
GIVEN = {"sweep": {"focus": {"slope": 0.58, "intercept": "69 nm"}}}
STAGES = [
    "focus_scan", "focus_sweep", "gaussian_fits", "focus_law", "detections", "spectra", "paths",
    "fourier", "phase_slope",
]  # fmt: skip


def gridded(grid: dict[str, Any], *overlays: dict[str, Any]) -> Config:
    return load_config(SMALL, *overlays, {"grid": grid})


def run(config: Config, threads: int = 1) -> dict[str, xr.Dataset]:
    """Every stage of a run, in memory."""
    found = {"focus_scan": octsim.focus_scan(config, threads)}
    found["focus_sweep"] = octsim.focus_sweep(config, threads)
    found["gaussian_fits"] = octsim.gaussian_fits(config, found["focus_sweep"])
    found["focus_law"] = octsim.focus_law(config, found["gaussian_fits"])
    found["detections"] = octsim.detections(config, found["focus_law"], threads)
    found["spectra"] = octsim.spectra(config, found["detections"], threads)
    found["paths"] = octsim.light_paths(config, found["detections"])
    found["fourier"] = octsim.fourier(config, found["spectra"])
    found["phase_slope"] = octsim.phase_slope(config, found["fourier"])
    return found


def test_a_product_takes_every_value_with_every_other_the_last_key_fastest() -> None:
    config = gridded(
        {
            "detector.core_diameter": ["3.5 um", "4.4 um"],
            "scene.gap": {"start": "0 nm", "stop": "50 nm", "num": 3},
        }
    )
    found = [(at.config.detector.core_diameter, at.config.scene.gap) for at in combinations(config)]
    assert found == [(3.5, 0), (3.5, 0.025), (3.5, 0.05), (4.4, 0), (4.4, 0.025), (4.4, 0.05)]
    assert [axis_name(axis) for axis in axes(config)] == ["core_diameter", "gap"]


def test_zipped_keys_go_side_by_side() -> None:
    config = gridded({"combine": "zip", "scene.gap": ["1 nm", "2 nm"], "tracing.rays": [100, 300]})
    found = [(at.config.scene.gap, at.config.tracing.rays) for at in combinations(config)]
    assert found == [(0.001, 100), (0.002, 300)]


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("scene.gap", ["1 nm", "20 nm"]),
        ("tracing.rays", [100, 200]),
        ("processing.window", ["hann", "boxcar"]),
        ("sweep.focus", ["law", {"slope": 0.58, "intercept": "69 nm"}]),
        ("sweep.diameters.num", [3, 9]),
        ("tracing", [{"rays": 100}, {"scheme": "paths"}]),
        ("scene.refractive_index", [{"glass": 1.5}, {"neuron": 1.4, "water": 1.32}]),
    ],
)
def test_a_combination_is_the_config_with_its_value_written_in(key: str, values: list[Any]) -> None:
    for at, value in zip(combinations(gridded({key: values})), values, strict=True):
        overlay: Any = value
        for name in reversed(key.split(".")):
            overlay = {name: overlay}
        assert at.config == load_config(SMALL, overlay)


def test_a_preset_of_the_grid_brings_its_keys_and_those_beside_it_win() -> None:
    config = gridded({"tracing.preset": ["draft", "reference"], "tracing.max_intersections": [5]})
    tracings = [at.config.tracing for at in combinations(config)]
    assert [(t.scheme, t.accuracy, t.max_intersections) for t in tracings] == [
        ("paths", 3e-2, 5), ("paths", 1e-8, 5),
    ]  # fmt: skip


def test_a_checked_grid_is_read_back_the_same() -> None:
    config = gridded({"scene.gap": {"start": "0 nm", "stop": "10 nm", "num": 4}})
    assert load_config(config.to_dict()) == config


def test_every_key_gives_a_dimension_of_its_own() -> None:
    names = [dimension_name(key) for key in known_keys()]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize(
    ("grid", "message"),
    [
        ({"detector.core_diametr": ["4 um"]}, "grid.detector.core_diametr: unknown key;"),
        ({"scene": {"gap": ["5 nm"]}}, "don't nest here: write grid: {scene.gap"),
        ({"combine": "zip", "scene.gap": ["1 nm"], "tracing.rays": [1, 2]}, "scene.gap has 1, tr"),
        ({"scene.gap": []}, r"grid.scene.gap: \[\] given; list one value or more"),
        ({"scene.gap": {"start": "1 nm", "stop": "1 nm", "num": 2}}, "or the range is empty"),
        ({"scene.gap": {"start": "1 nm", "stop": "2 nm", "num": 0}}, "grid.scene.gap.num: 0 given"),
        ({"scene.gap": {"start": "1 nm", "stop": 2, "num": 2}}, "both ends should be numbers, or"),
        ({"scene.gap": {"start": "1 nm", "stop": "2 nm"}}, "has start, stop and num"),
        ({"scene.gap": [5]}, "grid.scene.gap: 5 given; a length needs its unit"),
        ({"scene.gap": "5 nm"}, "grid.scene.gap: '5 nm' given; it should be a list of values, or"),
        ({"scene.gap": ["5 nm", "0.005 um"]}, "grid.scene.gap: .* stands twice"),
        ({"combine": "zip", "scene.gap": ["1 nm"] * 2, "tracing.rays": [1, 1]}, "stands twice"),
        ({"tracing.rays": {"start": 100, "stop": 200, "num": 4}}, "are not all whole numbers"),
        ({"tracing.rays": [1.5]}, "grid.tracing.rays: 1.5 given; it should be a whole number"),
        ({"tracing": [{}], "tracing.rays": [1]}, "grid.tracing: given beside grid.tracing.rays"),
        ({"run": ["a", "b"]}, "grid.run: can't be varied"),
        ({"sweep.diameters": {"start": "1 um", "stop": "2 um", "num": 2}}, "is itself a range"),
        ({"combine": "outer"}, "grid.combine: 'outer' given; the nearest that is known is"),
        ({"objective.numerical_aperture": [1, 1.6]}, "grid, at objective.numerical_aperture = 1.6"),
        ({"scene.gap": {"start": "0 nm", "stop": "1 um", "num": 1000},
          "tracing.rays": {"start": 1, "stop": 1000, "num": 1000}}, "1000000 combinations; at mo"),
    ],
)  # fmt: skip
def test_a_grid_that_is_wrong_is_refused_in_a_line(grid: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message) as raised:
        gridded(grid)
    assert all(line for line in str(raised.value).splitlines())


def test_only_combinations_have_to_be_possible() -> None:
    # of itself impossible: an aperture above the glass's index, which every combination raises
    high = {"objective": {"numerical_aperture": 1.6}}
    config = gridded({"scene.refractive_index.glass": [1.7, 1.8]}, high)
    assert len(list(combinations(config))) == 2


def test_two_remarks_on_one_key_are_both_said() -> None:
    coarse = {"sweep": {"diameters": {"start": "1 um", "stop": "9 um", "num": 20}}}
    for grid in ({}, {"scene.gap": ["1 nm", "2 nm"]}):
        said = [line for line in remarks(gridded(grid, coarse)) if "sweep.diameters: " in line]
        assert len(said) == 2
        assert all(line.endswith("(at 2 of 2 combinations)") for line in said) == bool(grid)


def test_remarks_tell_at_how_many_combinations_they_hold() -> None:
    config = gridded(
        {"sweep.diameters.num": [2, 3, 50]}, {"sweep": {"diameters": {"stop": "2 um"}}}
    )
    said = [line for line in remarks(config) if line.startswith("sweep.diameters: a step")]
    assert len(said) == 1
    assert said[0].endswith("(at 2 of 3 combinations)")


@pytest.mark.parametrize(
    ("key", "stages"),
    [
        ("processing.window", {"fourier", "phase_slope"}),
        ("spectrum.wavelength.min", {
            "focus_scan", "focus_sweep", "gaussian_fits", "focus_law", "spectra", "paths",
            "fourier", "phase_slope"}),
        ("focus_scan.diameter", {"focus_scan"}),
        ("focus_law.fraction.num", {"focus_sweep", "gaussian_fits", "focus_law"}),
        ("scene.gap", set(STAGES)),
        ("tracing.accuracy", set()),
    ],
)  # fmt: skip
def test_a_stage_has_the_axes_of_the_keys_it_depends_on(key: str, stages: set[str]) -> None:
    values = {
        "processing.window": ["hann", "boxcar"], "spectrum.wavelength.min": ["650 nm", "700 nm"],
        "focus_scan.diameter": ["1 um", "2 um"], "focus_law.fraction.num": [9, 11],
        "scene.gap": ["1 nm", "5 nm"], "tracing.accuracy": [1e-3, 1e-4],
    }  # fmt: skip
    config = gridded({key: values[key]}, GIVEN)
    assert {stage for stage in STAGES if stage_axes(stage, config)} == stages


GRIDS: dict[str, dict[str, Any]] = {
    "product": {"scene.gap": ["0 nm", "30 nm"], "processing.window": ["hann", "hamming"]},
    "zip": {
        "combine": "zip", "scene.gap": ["0 nm", "30 nm", "30 nm"],
        "processing.centre": ["mean", "mean", "midpoint"],
    },
    "band": {"spectrum.wavelength.min": ["650 nm", "700 nm"], "tracing.rays": [150, 160]},
    "sizes": {"sweep.diameters.num": [5, 9, 3], "spectrum.samples": [40, 33]},
    "schemes": {"tracing.scheme": ["vogel", "paths"], "focus_scan.focus.num": [5, 4]},
    "estimators": {"processing.estimator": ["fft", "sinusoid", "esprit", "maximum_likelihood"]},
    "preset": {
        "combine": "zip", "tracing.preset": ["draft", "draft", "standard"],
        "scene.gap": ["0 nm", "30 nm", "30 nm"],
    },
    "focus": {"sweep.focus": ["law", {"slope": 0.58, "intercept": "69 nm"}]},
}  # fmt: skip


@pytest.mark.parametrize("name", GRIDS)
def test_a_dataset_over_a_grid_holds_that_of_every_plain_config(name: str) -> None:
    overlay = {"tracing": {"accuracy": 1e-2}}
    config = gridded(GRIDS[name], overlay)
    whole = run(config)
    for at in combinations(config):
        plain = run(at.config)
        for stage in STAGES:
            swept = "focus" if stage == "focus_scan" else "diameter"
            part, alone = Stored(whole[stage], stage, config).part(at, swept=swept), plain[stage]
            if stage == "paths":  # it lists the paths of all combinations
                part = part.set_index(path="path_code").sel(path=alone["path_code"].values)
                alone = alone.set_index(path="path_code")
            if stage == "phase_slope":  # nothing tells how many components are this one's own
                assert (
                    part.isel(component=slice(alone.sizes["component"], None))[
                        "component_phase_slope"
                    ]
                    .isnull()
                    .all()
                )
                part = part.isel(component=slice(alone.sizes["component"]))
            assert set(alone.variables) - set(part.variables) <= {"outcome"}
            for variable in set(alone.variables) & set(part.variables):
                assert part[variable].dims == alone[variable].dims
                np.testing.assert_array_equal(part[variable].values, alone[variable].values)


@pytest.mark.parametrize("name", GRIDS)
def test_a_file_holds_what_memory_does(name: str, tmp_path: Path) -> None:
    config = gridded(GRIDS[name], {"tracing": {"accuracy": 1e-2}})
    law = octsim.focus_law(config, octsim.gaussian_fits(config, octsim.focus_sweep(config)))
    detected = octsim.detections(config, law)
    spectra = octsim.spectra(config, detected)
    streams = {
        "detections": (octsim.detections.stream(config, law), detected),
        "spectra": (octsim.spectra.stream(config, detected), spectra),
        "fourier": (octsim.fourier.stream(config, spectra), octsim.fourier(config, spectra)),
    }
    for stage, (stream, held) in streams.items():
        write_stream(stream, tmp_path / f"{stage}.nc")
        with xr.open_dataset(tmp_path / f"{stage}.nc") as stored:
            xr.testing.assert_identical(stored.load(), held)


def test_blocks_threads_and_order_change_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    grids = [{"scene.gap": values} for values in (["0 nm", "30 nm"], ["30 nm", "0 nm"])]
    configs = [gridded(grid, {"tracing": {"scheme": "paths", "accuracy": 1e-2}}) for grid in grids]
    whole = run(configs[0])
    for most, config, threads in ((1, configs[0], 1), (2, configs[1], 2), (3, configs[0], 3)):
        monkeypatch.setattr(workload, "_MOST_POINTS", most)
        again = run(config, threads)
        for stage in STAGES:
            for at in combinations(config):
                swept = "focus" if stage == "focus_scan" else "diameter"
                one = Stored(whole[stage], stage, configs[0]).part(at, swept=swept)
                other = Stored(again[stage], stage, config).part(at, swept=swept)
                assert one.drop_attrs().identical(other.drop_attrs()), stage


def test_a_combination_without_a_focus_law_is_nan_and_the_others_are_there() -> None:
    # the narrow range of foci has no peak within it
    config = gridded({"focus_law.fraction.stop": [0.8, 0.42]})
    found = run(config)
    status = found["spectra"]["accuracy_status"].values
    assert (status[1] == AccuracyStatus.NO_FOCUS).all()
    assert (status[0] == AccuracyStatus.NOT_CONTROLLED).all()
    slopes = found["phase_slope"]["mean_phase_slope"].values
    assert np.isnan(slopes).tolist() == [False, True]
    assert found["spectra"]["intensity"].isnull()[1].all()
    assert found["detections"]["rays_detected"].values[1].sum() == 0
    said = doubts(found["spectra"])
    assert any(line.startswith("there is no focus law at 1 of 2 combinations") for line in said)
    assert any("raise tracing.rays" in line for line in said)
    assert "over 2 combinations" in summary(found["phase_slope"])
    with pytest.raises(OctsimError, match="there is no law"):
        run(gridded({"focus_law.fraction.stop": [0.41, 0.42]}))


@pytest.mark.parametrize("name", GRIDS)
def test_the_points_of_a_stage_s_parts_are_all_that_its_layout_counts(name: str) -> None:
    config = gridded(GRIDS[name], GIVEN)
    sweep = octsim.focus_sweep(config)
    for stream in (
        octsim.focus_scan.stream(config),
        octsim.focus_sweep.stream(config),
        octsim.gaussian_fits.stream(config, sweep),
        octsim.detections.stream(
            config, octsim.focus_law(config, octsim.gaussian_fits(config, sweep))
        ),
    ):
        assert sum(part.points for part in stream.parts) == stream.layout.points


def test_a_part_of_a_combination_is_read_alone() -> None:
    config = gridded({"scene.gap": ["0 nm", "30 nm"]}, GIVEN)
    stored = Stored(octsim.detections(config), "detections", config)
    at = list(combinations(config))[1]
    whole = stored.part(at)
    first, rest = stored.part(at, slice(0, 2)), stored.part(at, slice(2, 5))
    for name in ("amplitude", "focus", "diameter"):
        joined = np.concatenate([first[name].values, rest[name].values])
        np.testing.assert_array_equal(joined, whole[name].values)
    assert first["rays_detected"].sum() == first.sizes["ray"]


def test_a_target_of_a_single_config_refuses_a_grid() -> None:
    with pytest.raises(ConfigError, match=r"grid: scene.gap given, but tradeoff is of a single"):
        without_grid(gridded({"scene.gap": ["0 nm", "30 nm"]}), "tradeoff")
    assert without_grid(load_config(SMALL), "tradeoff") == load_config(SMALL)


def test_a_key_of_a_target_that_a_run_has_once_is_not_varied() -> None:
    with pytest.raises(ConfigError, match="can't be varied"):
        load_config({"grid": {"calibration.step": ["0.1 nm", "0.2 nm"]}})
