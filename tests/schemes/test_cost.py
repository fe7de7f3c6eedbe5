"""What a point is said to take before it is traced."""

import math

import numpy as np
import pytest

from octsim.config.derive import by_waves, changed
from octsim.config.load import load_config
from octsim.instrument.instrument import Instrument
from octsim.schemes.cost import of_waves


@pytest.mark.parametrize(("accuracy", "diameter"), [(1e-2, 0.5), (1e-2, 2.0), (1e-4, 1.0)])
def test_waves_are_kept_in_about_as_many_bytes_as_said(accuracy: float, diameter: float) -> None:
    config = changed(by_waves(load_config()), {"tracing": {"accuracy": accuracy}})
    light = Instrument(config).light(diameter, 0.581 * diameter + 0.069)
    size = sum(part.nbytes for part in light if isinstance(part, np.ndarray))
    assert of_waves({"accuracy": accuracy}, diameter).size == pytest.approx(size, rel=0.5)


def test_waves_take_more_by_diameter_and_by_digits_and_never_without_end() -> None:
    at = [of_waves({"accuracy": 1e-4}, diameter) for diameter in (0.01, 1, 2, 4)]
    assert (np.diff([cost.seconds for cost in at]) > 0).all()
    assert (np.diff([cost.memory for cost in at]) > 0).all()
    assert of_waves({"accuracy": 1e-6}, 2).seconds > at[2].seconds
    assert math.isfinite(of_waves({"accuracy": 1e-8}, 1000).seconds)
