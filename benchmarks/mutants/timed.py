"""What pytest is told in a trial: which tests not to run, and how long each and all may compute."""

import math
import signal
from collections import Counter
from collections.abc import Collection, Generator
from types import FrameType

import pytest

_CASES = 2
"""Of a test's cases that take too long, after which its others are taken to do so too."""


class Timed:
    """A plugin of pytest's that runs tests, each within its processor time.

    Processor time does not depend on what else this machine does.

    Parameters
    ----------
    without : collection of str
        Names of those not to run.
    longest : float
        Processor time that one test may take, s; it is left then.
    most : float
        Processor time after which no other test is begun, s.
    """

    def __init__(self, without: Collection[str], longest: float, most: float) -> None:
        self._without, self._longest, self._left = set(without), longest, most
        self._slow_cases = Counter[str]()
        self.seconds: dict[str, float] = {}
        """Processor time that each test took; infinite of those that did not pass or were left."""
        self.failed = ""
        """The first test that failed."""
        self.slow = ""
        """The first test that was left as it took too long."""

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Leave out what is not to run."""
        items[:] = [one for one in items if one.nodeid not in self._without]

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        """Run one test, with what it needs to be set up, until its time is over."""
        test = item.nodeid.partition("[")[0]
        if self._slow_cases[test] >= _CASES:
            item.add_marker(pytest.mark.skip)
        is_slow = False

        def stop(_number: int, _frame: FrameType | None) -> None:
            nonlocal is_slow
            is_slow = True
            pytest.skip("takes too long")

        before = signal.signal(signal.SIGPROF, stop)
        signal.setitimer(signal.ITIMER_PROF, self._longest, 1.0)  # again, should a test go on
        try:
            done = yield
        finally:
            left, _ = signal.setitimer(signal.ITIMER_PROF, 0)
            signal.signal(signal.SIGPROF, before)
        took = self._longest if is_slow else self._longest - left
        self._left -= took
        self.seconds.setdefault(item.nodeid, took)
        if is_slow:
            self._slow_cases[test] += 1
            self.slow = self.slow or item.nodeid
        if self._left <= 0:
            item.session.shouldstop = "as long as was asked for"
        return done

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note a test that does not pass, in whatever phase of it."""
        if report.failed:
            self.failed = self.failed or report.nodeid
        if not report.passed:
            self.seconds[report.nodeid] = math.inf
