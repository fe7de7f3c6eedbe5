"""Datasets over a grid equal those of every plain config, whatever the blocks."""

import numpy as np
import pytest
from gridded import GIVEN, GRIDS, gridded, run_of_grid
from made_runs import every_stage

import octsim
from octsim.config.grid import combinations
from octsim.datasets.keys import stages_of
from octsim.datasets.reader import Stored
from octsim.stages import workload


@pytest.mark.parametrize("name", GRIDS)
def test_a_dataset_over_a_grid_holds_that_of_every_plain_config(name: str) -> None:
    config, whole = run_of_grid(name)
    for at in combinations(config):
        plain = every_stage(at.config)
        for stage in stages_of(at.config):
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


def test_blocks_threads_and_order_change_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    grids = [{"scene.gap": values} for values in (["0 nm", "30 nm"], ["30 nm", "0 nm"])]
    configs = [gridded(grid, {"tracing": {"scheme": "paths", "accuracy": 1e-2}}) for grid in grids]
    whole = every_stage(configs[0])
    for most, config, threads in ((1, configs[0], 1), (2, configs[1], 2), (3, configs[0], 3)):
        monkeypatch.setattr(workload, "_MOST_POINTS", most)
        again = every_stage(config, threads)
        for stage in stages_of(config):
            for at in combinations(config):
                swept = "focus" if stage == "focus_scan" else "diameter"
                one = Stored(whole[stage], stage, configs[0]).part(at, swept=swept)
                other = Stored(again[stage], stage, config).part(at, swept=swept)
                assert one.drop_attrs().identical(other.drop_attrs()), stage


# of a grid over kinds of light, a stage has the points of some combinations
@pytest.mark.parametrize("name", sorted(set(GRIDS) - {"waves"}))
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
