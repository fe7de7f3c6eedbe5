"""Points of a sweep, each a diameter at a focus: taken from a store, or found and kept there."""

import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from octsim.instrument.point_entries import light_from_bytes, light_to_bytes
from octsim.instrument.point_keys import point_key
from octsim.schemes.light import Found

if TYPE_CHECKING:
    # a store saves time and decides no result, so that its code is none that results follow from
    from octsim.instrument.point_store import PointStore

LightAtPoint = Callable[[float, float], Found]
"""From diameter and focus, µm, to detected light."""
_RECORD_AFTER = 1000  # points
_NOT_TIMED = 8  # of the first points some may wait for code to be compiled


class Points:
    """Where a stage has its light from, and how many points it needed; safe to use from threads.

    Parameters
    ----------
    store : PointStore, optional
        Where light is kept that was found before.
    """

    def __init__(self, store: "PointStore | None" = None) -> None:
        self._store, self._lock = store, threading.Lock()
        self._timed: dict[str, tuple[int, float, int]] = {}  # points, s and bytes, not recorded yet
        self.traced, self.from_cache = 0, 0

    def keeping(self, find: LightAtPoint, key: Callable[[], bytes], rate: str) -> LightAtPoint:
        """Return a function as `find` that takes light from where it is kept, or keeps it.

        Parameters
        ----------
        find : callable
            From diameter and focus, µm, to light.
        key : callable
            Returns the key of the instrument, by `instrument_key`; asked for where light is kept.
        rate : str
            Name of the points that take about the same.
        """
        store = self._store
        if store is None:

            def found(diameter: float, focus: float) -> Found:
                light = find(diameter, focus)
                self._count()
                return light

            return found
        instrument = key()

        def at(diameter: float, focus: float) -> Found:
            key = point_key(instrument, diameter, focus)
            body = store.get(key)
            if body is not None:
                with self._lock:
                    self.from_cache += 1
                return light_from_bytes(body)
            begin = time.thread_time()
            light = find(diameter, focus)
            seconds, number = time.thread_time() - begin, self._count()
            body = light_to_bytes(light)
            store.put(key, body)
            if number > _NOT_TIMED:
                self._time(rate, seconds, len(body))
            return light

        return at

    def counts(self) -> dict[str, int]:
        """Return how many points were found anew, and how many were kept from before."""
        return {"points_traced": self.traced, "points_from_cache": self.from_cache}

    def keep(self) -> None:
        """Record in the store what points took to find; the points themselves are there."""
        with self._lock:
            timed, self._timed = self._timed, {}
        if self._store is not None and timed:
            from octsim.instrument.point_store import Rate

            for name, sums in timed.items():
                self._store.record(name, Rate(*sums))

    def _count(self) -> int:
        """Count a point that was found anew, and return its number, which no other thread gets."""
        with self._lock:
            self.traced += 1
            return self.traced

    def _time(self, name: str, seconds: float, size: int) -> None:
        with self._lock:
            points, before, held = self._timed.get(name, (0, 0.0, 0))
            self._timed[name] = points + 1, before + seconds, held + size
        if points + 1 >= _RECORD_AFTER:
            self.keep()
