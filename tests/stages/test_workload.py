"""A stage of a million points is cut into as many jobs as the docs say, and none is lost."""

import pytest

from octsim.config.grid import Combination
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.stages.scatter import Share
from octsim.stages.workload import shares_of


def million(rays: int, minutes: float) -> Config:
    return load_config(
        {
            "tracing": {"rays": rays},
            "scatter": {"minutes": minutes},
            "sweep": {
                "diameters": {"num": 100}, "focus": {"slope": 0.581, "intercept": "69 nm"},
            },
            "grid": {
                "scene.gap": {"start": "0 nm", "stop": "50 nm", "num": 100},
                "detector.core_diameter": {"start": "3.5 um", "stop": "5 um", "num": 100},
            },
        }
    )  # fmt: skip


@pytest.mark.parametrize(
    ("rays", "minutes", "jobs"), [(3000, 5, 9), (100_000, 5, 294), (100_000, 0.15, 9792)]
)
def test_a_million_points_are_as_many_jobs_as_their_time_asks_for(
    rays: int, minutes: float, jobs: int
) -> None:
    assert shares_of(million(rays, minutes))["detections"] == jobs


def test_ten_thousand_shares_have_each_block_once_and_about_as_much_to_do() -> None:
    at = Combination((0, 0), {}, million(3000, 5))
    blocks = [(at, slice(10 * n, 10 * n + 10)) for n in range(100_000)]
    found: list[object] = []
    counts = set()
    # a few of them, as each looks at all blocks; neighbours, and both ends
    for number in (1, 2, 5000, 5001, 9999, 10_000):
        own = Share(number, 10_000).among(blocks, lambda _: 0.003)
        counts.add(len(own))
        assert own == blocks[10 * (number - 1) : 10 * number]
        found += own
    assert counts == {10}
    assert len(found) == 60
