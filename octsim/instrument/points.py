"""Points of a sweep, each a diameter at a focus: taken from the cache, or traced and kept."""

import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from octsim.instrument.point_entries import pack, unpack
from octsim.instrument.point_keys import point_key
from octsim.schemes.light import Light

if TYPE_CHECKING:
    from octsim.instrument.cache import PointCache  # it saves time and decides no result

LightAtPoint = Callable[[float, float], Light]
"""From diameter and focus, µm, to detected light."""
_KEEP_AFTER = 1.0  # s, for which a killed run can have traced in vain
_KEEP_BYTES = 16_000_000
_NOT_TIMED = 8  # of the first points some may wait for code to be compiled


class Points:
    """Where a stage has its light from; safe to use from several threads.

    Parameters
    ----------
    cache : PointCache, optional
        Where traced points are kept.
    """

    def __init__(self, cache: "PointCache | None" = None) -> None:
        self._cache, self._lock = cache, threading.Lock()
        self._new: list[tuple[bytes, bytes]] = []
        self._bytes, self._kept = 0, time.monotonic()
        self._timed: dict[str, list[float]] = {}  # points, s and bytes, of a rate's name
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
        cache = self._cache
        if cache is None:
            return lambda diameter, focus: self._counted(find(diameter, focus))
        instrument = key()

        def at(diameter: float, focus: float) -> Light:
            key = point_key(instrument, diameter, focus)
            body = cache.get(key)
            if body is not None:
                with self._lock:
                    self.from_cache += 1
                return unpack(body)
            begin = time.thread_time()
            light = self._counted(find(diameter, focus))
            body = pack(light)
            self._keep(key, body)
            self._time(rate, time.thread_time() - begin, len(body))
            return light

        return at

    def counts(self) -> dict[str, int]:
        """Return how many points were found anew, and how many were kept from before."""
        return {"points_traced": self.traced, "points_from_cache": self.from_cache}

    def keep(self) -> None:
        """Write what was traced since the last time to the cache."""
        with self._lock:
            new, self._new, self._bytes = self._new, [], 0
            timed, self._timed = self._timed, {}
            self._kept = time.monotonic()
        if self._cache is not None:
            self._cache.put(new)
            for name, (points, seconds, size) in timed.items():
                self._cache.record(name, int(points), seconds, int(size))

    def _counted(self, light: Light) -> Light:
        with self._lock:
            self.traced += 1
        return light

    def _keep(self, key: bytes, body: bytes) -> None:
        with self._lock:
            self._new.append((key, body))
            self._bytes += len(body)
            late = time.monotonic() - self._kept > _KEEP_AFTER or self._bytes > _KEEP_BYTES
        if late:
            self.keep()

    def _time(self, name: str, seconds: float, size: int) -> None:
        with self._lock:
            if self.traced <= _NOT_TIMED:
                return
            sums = self._timed.setdefault(name, [0, 0.0, 0])
            sums[:] = sums[0] + 1, sums[1] + seconds, sums[2] + size
