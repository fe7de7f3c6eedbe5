"""Where studies have their light from: one store of points, to the bit, or each point anew."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr
from made_runs import few_parameters

import octsim
from octsim.config.load import load_config
from octsim.instrument.points import LightAtPoint, Points
from octsim.schemes.light import Found
from octsim.studies.calibration import parameters, round_trips
from octsim.studies.causes.study import causes
from octsim.studies.estimators.study import estimators
from octsim.studies.tradeoff.measured_cost import sweep_cost
from octsim.studies.tradeoff.settings import settings
from octsim.studies.tradeoff.study import tradeoff

SMALL = load_config({
    "tracing": {"rays": 100},
    "spectrum": {"samples": 100},
    "focus_law": {
        "diameters": {"start": "1 um", "stop": "1.4 um", "num": 2},
        "fraction": {"num": 5},
    },
    "sweep": {
        "diameters": {"start": "1.2 um", "stop": "1.3 um", "num": 6},
        "focus": {"slope": 0.58, "intercept": "66 nm"},
    },
    # light paths, and for each slope beside theirs counted rays and waves
    "calibration": {"diameters": {"num": 8}, "scheme": "paths"},
})  # fmt: skip
MEASURED_ANEW = {
    "cpu_seconds", "peak_memory", "estimator_seconds", "phase_slope_frontier",
    "maxwell_frontier", "maxwell_slope_frontier",
}  # fmt: skip


class Remembered(Points):
    """Points that are kept in memory, by instrument and place."""

    def __init__(self, memory: dict[tuple[bytes, float, float], Found]) -> None:
        super().__init__()
        self.memory = memory

    def keeping(self, find: LightAtPoint, key: Callable[[], bytes], rate: str) -> LightAtPoint:
        instrument, found_anew = key(), super().keeping(find, key, rate)

        def at(diameter: float, focus: float) -> Found:
            place = instrument, float(diameter), float(focus)
            if place in self.memory:
                self.from_cache += 1
            else:
                self.memory[place] = found_anew(diameter, focus)
            return self.memory[place]

        return at


def of_tradeoff(**keywords: Any) -> xr.Dataset:
    chosen = [s for s in settings(SMALL) if (s.factor, s.value) in {("tracing.rays", 100)}]
    return tradeoff(SMALL, chosen=chosen, separate=False, tried=(), **keywords)


def of_action_potential(**keywords: Any) -> xr.Dataset:
    return octsim.action_potential(SMALL, octsim.calibration(SMALL, **keywords), **keywords)


@pytest.mark.parametrize(
    "study",
    [
        of_action_potential,
        lambda **keywords: causes(SMALL, **keywords),
        lambda **keywords: estimators(SMALL, runs=2, **keywords),
        of_tradeoff,
    ],
    ids=["calibration and action_potential", "causes", "estimators", "tradeoff"],
)
def test_a_study_s_light_is_kept_and_comes_back_to_the_bit(
    study: Callable[..., xr.Dataset], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(round_trips, "TRIALS", 3)
    monkeypatch.setattr(parameters, "PARAMETERS", few_parameters("diameter", "gap"))
    kept: dict[tuple[bytes, float, float], Found] = {}
    first, again = Remembered(kept), Remembered(kept)
    traced, known = study(points=first), study(points=again)
    assert first.traced == len(kept) > 0
    assert again.traced == 0
    assert again.from_cache >= len(kept)
    xr.testing.assert_identical(
        traced.drop_vars(MEASURED_ANEW, errors="ignore"),
        known.drop_vars(MEASURED_ANEW, errors="ignore"),
    )


def test_what_is_timed_has_its_light_from_nowhere(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> LightAtPoint:
        raise AssertionError("light was asked for where it is kept")

    monkeypatch.setattr(Points, "keeping", refused)
    cost = sweep_cost(SMALL, np.array([1.2]), np.array([0.7]))
    assert cost.segments > 0
