"""Points of a sweep, each a diameter at a focus: taken from the cache, or traced and kept."""

import threading
import time
from functools import cache

from octsim.base.provenance import source_digest
from octsim.config.derive import parts_of
from octsim.config.models import Config
from octsim.datasets.catalog import instrument
from octsim.instrument.cache import PointCache
from octsim.instrument.instrument import Tracer, tracer
from octsim.instrument.point_entries import pack, unpack
from octsim.instrument.point_keys import instrument_key, point_key
from octsim.schemes.light import Light
from octsim.stages.cost_estimate import rate_name

_CODE = {"vogel": "octsim.schemes.vogel", "paths": "octsim.schemes.paths.integrate"}
"""Modules that a scheme's points follow from."""
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

    def __init__(self, cache: PointCache | None = None) -> None:
        self._cache, self._lock = cache, threading.Lock()
        self._new: list[tuple[bytes, bytes]] = []
        self._bytes, self._kept = 0, time.monotonic()
        self._timed: dict[str, list[float]] = {}  # points, s and bytes, of a rate's name
        self.traced, self.from_cache = 0, 0

    def tracer(self, config: Config) -> Tracer:
        """Make the function of diameter and focus (µm) that gives a config's detected light."""

        @cache  # a beam is only placed where it is needed
        def trace_at() -> Tracer:
            return tracer(config)

        if self._cache is None:
            return lambda diameter, focus: self._trace(trace_at(), diameter, focus)
        code = source_digest(_CODE[config.tracing.scheme], "octsim.instrument.point_entries")
        key_of = instrument_key(parts_of(config.to_dict(), *instrument(config)), code)
        stored = self._cache

        def at(diameter: float, focus: float) -> Light:
            key = point_key(key_of, diameter, focus)
            body = stored.get(key)
            if body is not None:
                with self._lock:
                    self.from_cache += 1
                return unpack(body)
            begin = time.thread_time()
            light = self._trace(trace_at(), diameter, focus)
            body = pack(light)
            self._keep(key, body)
            self._time(rate_name(config), time.thread_time() - begin, len(body))
            return light

        return at

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

    def _trace(self, trace_at: Tracer, diameter: float, focus: float) -> Light:
        light = trace_at(diameter, focus)
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
