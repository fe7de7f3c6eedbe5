"""Tables of a scene's faces: how many meetings have a code."""

import numpy as np
import pytest

from octsim.optics.layered import plates
from octsim.optics.materials import Constant
from octsim.optics.scene import Region, Scene, neuron_on_glass
from octsim.tracing.faces import faces_at, most_meetings
from octsim.tracing.path_counts import MOST_PATHS

GLASS, WATER, NEURON = Constant(1.52), Constant(1.33), Constant(1.39)


def layers(number: int) -> Scene:
    regions = [Region(f"layer {i}", Constant(1.3 + 0.01 * i)) for i in range(number + 1)]
    return plates(regions, [0.1 * i for i in range(number)])


@pytest.mark.parametrize("number", [1, 2, 3, 5])
def test_codes_of_plates_have_room_for_as_many_meetings_as_their_digits_allow(
    number: int,
) -> None:
    # a leading 1, and a digit for each surface and way that light takes there
    digits, most = 2 * number, most_meetings(layers(number))
    assert 2 * digits**most <= MOST_PATHS * 2 <= 2 * digits ** (most + 1)


def test_faces_are_the_sides_of_surfaces_with_the_indices_on_both() -> None:
    faces = faces_at(neuron_on_glass(GLASS, WATER, NEURON, 0.005, 1.4), 8.0)
    # plane from below and from above, cylinder from inside and from outside
    assert faces.surface.tolist() == [0, 0, 1, 1]
    assert faces.n_i.tolist() == [1.52, 1.33, 1.39, 1.33]
    assert faces.n_t.tolist() == [1.33, 1.52, 1.33, 1.39]
    # light on a side goes back where it came from, or on behind the other
    assert np.array_equal(faces.after_reflection, [1, 2, 3, 4])
    assert np.array_equal(faces.after_transmission, [2, 1, 4, 3])
