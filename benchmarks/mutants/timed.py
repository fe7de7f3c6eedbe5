"""What pytest is told in a trial: which tests, and how long each and all may compute."""

import math
import signal
from collections.abc import Collection, Generator
from types import FrameType

import pytest


class Timed:
    """A plugin of pytest's that runs chosen tests, each within its processor time.

    Processor time does not depend on what else this machine does.

    Parameters
    ----------
    only : collection of str
        Names of the tests to run; all where there are none.
    without : collection of str
        Names of those not to run.
    longest : float
        Processor time that one test may take, s; it is left then.
    most : float
        Processor time after which no other test is begun, s.
    """

    def __init__(
        self, only: Collection[str], without: Collection[str], longest: float, most: float
    ) -> None:
        self._only, self._without = set(only), set(without)
        self._longest, self._left = longest, most
        self.seconds: dict[str, float] = {}
        """Processor time that each test took; infinite of those that did not pass or were left."""
        self.failed = ""
        """The first test that failed."""
        self.slow: list[str] = []
        """Tests that were left as they took too long."""

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Leave the chosen tests."""
        items[:] = [
            one
            for one in items
            if one.nodeid not in self._without and (not self._only or one.nodeid in self._only)
        ]

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        """Run one test, with what it needs to be set up, until its time is over."""

        def stop(_number: int, _frame: FrameType | None) -> None:
            if item.nodeid not in self.slow:
                self.slow.append(item.nodeid)
            pytest.skip("takes too long")

        before = signal.signal(signal.SIGPROF, stop)
        signal.setitimer(signal.ITIMER_PROF, self._longest, 1.0)  # again, should a test go on
        try:
            done = yield
        finally:
            left, _ = signal.setitimer(signal.ITIMER_PROF, 0)
            signal.signal(signal.SIGPROF, before)
        took = self._longest - left
        self._left -= self._longest if item.nodeid in self.slow else took
        self.seconds.setdefault(item.nodeid, took)
        if self._left <= 0:
            item.session.shouldstop = "as long as was asked for"
        return done

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note a test that does not pass, in whatever phase of it."""
        if report.failed:
            self.failed = self.failed or report.nodeid
        if not report.passed:
            self.seconds[report.nodeid] = math.inf
