"""What a run is said to take: within a factor of two of what was measured, up to 10⁷ rays."""

from typing import Any

import pytest

from octsim.config.load import load_config
from octsim.schemes.cost import PointCost
from octsim.stages.cost_estimate import Cost, estimate

# processor time of a point (s), and memory beyond a process that traces 1000 rays (MB), of one
# thread, each measured once on a machine with other load
MEASURED = {
    "detections": {
        10**3: (0.0019, 2), 10**4: (0.0106, 6), 10**5: (0.084, 18), 10**6: (0.878, 85),
        10**7: (12.9, 1125),
    },
    "spectra": {
        10**4: (0.0041, 3), 10**5: (0.023, 7), 10**6: (0.277, 23),
        10**7: (3.51, 197),
    },
}  # fmt: skip


def stages_of(rays: int, points: int = 2, **more: Any) -> dict[str, Cost]:
    def typical(_: str, cost: PointCost) -> PointCost:
        return cost

    sweep = {"diameters": {"num": points}, "focus": {"slope": 0.58, "intercept": "69 nm"}}
    config = load_config({"tracing": {"rays": rays}, "sweep": sweep, **more})
    return dict(estimate(config, typical).stages)


@pytest.mark.parametrize("stage", MEASURED)
def test_time_and_memory_of_rays_are_within_a_factor_of_two(stage: str) -> None:
    alone = 300e6  # of a process
    for rays, (seconds, megabytes) in MEASURED[stage].items():
        cost = stages_of(rays)[stage]
        each = cost.cpu_seconds / 2  # of two points
        assert seconds / 2 <= each <= 2 * seconds, rays
        whole = alone + 1e6 * megabytes
        assert whole / 2 <= cost.memory(1) <= 2 * whole, rays
        if megabytes > 50:  # what is not the process's own
            assert megabytes / 2 <= (cost.memory(1) - alone) / 1e6 <= 2 * megabytes


def test_each_thread_more_takes_the_memory_of_a_point_more() -> None:
    cost = stages_of(10**7)["detections"]
    assert cost.memory(3) - cost.memory(2) == pytest.approx(cost.memory(1) - Cost().memory(1))


def test_what_is_summed_goes_with_the_samples_and_the_points() -> None:
    once = stages_of(10**6, 2, spectrum={"samples": 500})["spectra"]
    more = stages_of(10**6, 8, spectrum={"samples": 1000})["spectra"]
    assert more.cpu_seconds == pytest.approx(8 * once.cpu_seconds)


def test_rays_with_a_field_at_each_sample_are_not_summed_again() -> None:
    plain = stages_of(10**5)["spectra"]
    sampled = stages_of(10**5, polarisation={"input": "left"})["spectra"]
    assert sampled.cpu_seconds < 0.1 * plain.cpu_seconds


def test_polarised_rays_take_the_memory_that_was_measured() -> None:
    cost = stages_of(10**5, polarisation={"input": "left"})["detections"]
    measured = 104e6  # beyond a process's own
    assert measured / 2 <= cost.memory(1) - Cost().memory(1) <= 2 * measured
