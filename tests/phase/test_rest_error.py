"""The error that the samples at rest state: it covers what it should, and says where it can't."""

import numpy as np
import pytest
from scipy.stats import norm, t

from octsim.phase.measured_series import Series, change_from_rest
from octsim.phase.rest_error import ErrorStatus, smallest_step, stated_change, student_factor

ONE_SIGMA = 0.6827


@pytest.mark.parametrize("freedom", [1, 2, 3, 5, 19, 1000])
def test_student_s_factor_covers_as_often_as_one_sigma(freedom: int) -> None:
    for deviations in (1.0, 4.0):
        covered = 1 - 2 * t.sf(student_factor(freedom, deviations), freedom)
        assert covered == pytest.approx(1 - 2 * norm.sf(deviations), abs=1e-12)
    assert student_factor(np.inf, 4.0) == 4.0


@pytest.mark.parametrize(("rest", "drifts"), [(3, False), (4, True), (5, False), (20, False)])
def test_the_stated_error_covers_a_change_from_few_samples_at_rest(rest: int, drifts: bool) -> None:
    generator, time = np.random.default_rng(rest), np.arange(rest + 1.0)
    trials, plain, stated = 6000, 0, 0
    for _ in range(trials):
        series = Series(time, 0.2 + 0.01 * drifts * time + generator.normal(0, 1e-3, rest + 1))
        change, status = stated_change(series, rest, drifts)
        assert status == ErrorStatus.SCATTER
        plain += abs(change.phase[-1]) <= change_from_rest(series, rest, drifts).error[-1]
        stated += abs(change.phase[-1]) <= change.error[-1]
    deviation = np.sqrt(ONE_SIGMA * (1 - ONE_SIGMA) / trials)
    assert stated / trials == pytest.approx(ONE_SIGMA, abs=4 * deviation)
    if rest < 6:
        assert plain / trials < ONE_SIGMA - 5 * deviation, "without Student's t it is too small"


def test_rounding_is_stated_where_the_scatter_is_less() -> None:
    generator, step = np.random.default_rng(2), 0.01
    trials, covered = 2000, 0
    for _ in range(trials):
        # at rest, and then a rise of a step or so a sample, to anywhere between two
        rise = np.cumsum(generator.uniform(0.5, 1.2, 30)) * step
        true = generator.uniform(0, step) + np.append(np.zeros(20), rise)
        change, status = stated_change(Series(np.arange(50.0), step * np.round(true / step)), 20)
        assert status == ErrorStatus.ROUNDING
        assert change.error == pytest.approx(step / np.sqrt(12) * np.sqrt(2 + 1 / 20))
        covered += abs(change.phase[-1] - (true[-1] - true[0])) <= change.error[-1]
    # the difference of two roundings is triangular, of which this is the share
    within = change.error[-1] / step
    share = 1 - (1 - within) ** 2
    assert share == pytest.approx(ONE_SIGMA, abs=0.04)
    assert covered / trials == pytest.approx(share, abs=4 * np.sqrt(share * (1 - share) / trials))


def test_steps_of_a_recorder_are_found_whatever_the_phases() -> None:
    phase = 0.01 * np.array([3.0, 3, 7, 4, 12, np.nan, 3])
    assert smallest_step(phase) == pytest.approx(0.01)
    assert smallest_step(np.array([0.0, 0.01])) == 0.01
    for none in (np.full(5, 0.1), np.array([0.0, 0.01, 0.025]), np.array([np.nan]), np.array([])):
        assert np.isnan(smallest_step(none))


def test_an_error_is_unknown_where_all_at_rest_is_equal_and_no_step_is_seen() -> None:
    still = np.full(30, 0.1)
    for phase in (still, np.append(still[:25], [0.2, 0.31, 0.433, 0.5, 0.58])):
        change, status = stated_change(Series(np.arange(30.0), phase), 20)
        assert status == ErrorStatus.UNKNOWN
        assert np.isnan(change.error).all()
        assert change.phase == pytest.approx(phase - 0.1)


def test_an_error_that_is_given_is_left_as_it_is() -> None:
    series = Series(np.arange(30.0), np.full(30, 0.1), np.full(30, 2e-3))
    change, status = stated_change(series, 20)
    assert status == ErrorStatus.GIVEN
    assert np.array_equal(change.error, change_from_rest(series, 20).error)
