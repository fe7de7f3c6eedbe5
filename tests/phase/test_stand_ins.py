"""Numbers that stand for none are told from those that stand for themselves."""

import numpy as np
import pytest

from octsim.phase.stand_ins import stand_ins

COUNTS = np.random.default_rng(4).uniform(5, 900, (3, 50))


@pytest.mark.parametrize("value", [9.969209968386869e36, 1e20, -1e30, -9999.0, 99999.0])
def test_fill_values_are_found_wherever_they_stand(value: float) -> None:
    values = COUNTS.copy()
    values[1, [7, 30]] = value
    assert np.argwhere(stand_ins(values)).tolist() == [[1, 7], [1, 30]]
    assert np.array_equal(stand_ins(values[1]), stand_ins(values)[1])


def test_numbers_of_a_size_with_others_are_themselves() -> None:
    assert not stand_ins(COUNTS).any()
    assert not stand_ins(np.array([999.0, 998, 400, -999])).any()
    assert not stand_ins(np.full(5, 999.0)).any()
    assert not stand_ins(np.array([np.nan, np.inf, 1.0])).any()
    assert not stand_ins(1e3 * COUNTS - 9999).any()
    assert stand_ins(np.array([])).shape == (0,)


@pytest.mark.parametrize("code", [-999.0, 999.0, -9999.0, 32767.0])
def test_a_code_far_beside_close_values_is_found_though_they_are_not_ten_times_smaller(
    code: float,
) -> None:
    phases = np.random.default_rng(1).normal(150, 20, 60)  # mrad
    phases[20:30] = code
    assert np.flatnonzero(stand_ins(phases)).tolist() == list(range(20, 30))


def test_the_one_negative_value_is_none_if_it_is_a_code() -> None:
    counts = 10 * COUNTS[0]
    counts[[3, 4]] = -999
    assert np.flatnonzero(stand_ins(counts)).tolist() == [3, 4]
    counts[[3, 4]] = -998
    assert not stand_ins(counts).any()


def test_a_code_that_others_come_near_is_a_value() -> None:
    assert not stand_ins(np.linspace(-1998, 0, 3)).any()
    assert not stand_ins(np.append(np.linspace(-990, 300, 50), -999)).any()
    assert not stand_ins(np.append(np.linspace(0, 400, 50), 999)).any()
