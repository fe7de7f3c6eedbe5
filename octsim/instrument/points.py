"""Points of a sweep, each a diameter at a focus: taken from a store, or traced and kept there."""

import threading
import time
from functools import cache

from octsim.base.provenance import source_digest
from octsim.config.models import Config
from octsim.datasets.catalog import instrument, parts_of
from octsim.instrument.instrument import Tracer, tracer
from octsim.instrument.point_entries import pack, unpack
from octsim.instrument.point_keys import instrument_key, point_key
from octsim.instrument.point_store import PointStore, Rate
from octsim.schemes.light import Light
from octsim.stages.cost_estimate import rate_name

_CODE = {"vogel": "octsim.schemes.vogel", "paths": "octsim.schemes.paths.integrate"}
"""Modules that a scheme's points follow from."""
_RECORD_AFTER = 1000  # points
_NOT_TIMED = 8  # of the first points some may wait for code to be compiled


class Points:
    """Where a stage has its light from; safe to use from several threads.

    Parameters
    ----------
    store : PointStore, optional
        Where traced points are kept.
    """

    def __init__(self, store: PointStore | None = None) -> None:
        self._store, self._lock = store, threading.Lock()
        self._timed: dict[str, Rate] = {}  # that is not recorded yet
        self.traced, self.from_cache = 0, 0

    def tracer(self, config: Config) -> Tracer:
        """Return the function of diameter and focus (µm) that gives a config's detected light."""

        @cache  # a beam is only placed where it is needed
        def trace_at() -> Tracer:
            return tracer(config)

        if self._store is None:
            return lambda diameter, focus: self._trace(trace_at(), diameter, focus)
        code = source_digest(_CODE[config.tracing.scheme], "octsim.instrument.point_entries")
        key_of = instrument_key(parts_of(config.to_dict(), *instrument(config)), code)
        store = self._store

        def at(diameter: float, focus: float) -> Light:
            key = point_key(key_of, diameter, focus)
            body = store.get(key)
            if body is not None:
                with self._lock:
                    self.from_cache += 1
                return unpack(body)
            begin = time.thread_time()
            light = self._trace(trace_at(), diameter, focus)
            seconds = time.thread_time() - begin
            body = pack(light)
            store.put(key, body)
            self._time(rate_name(config), seconds, len(body))
            return light

        return at

    def keep(self) -> None:
        """Record in the store what points took to trace; the points themselves are there."""
        with self._lock:
            timed, self._timed = self._timed, {}
        if self._store is not None:
            for name, rate in timed.items():
                self._store.record(name, rate)

    def _trace(self, trace_at: Tracer, diameter: float, focus: float) -> Light:
        light = trace_at(diameter, focus)
        with self._lock:
            self.traced += 1
        return light

    def _time(self, name: str, seconds: float, size: int) -> None:
        with self._lock:
            if self.traced <= _NOT_TIMED:
                return
            timed = self._timed.get(name, Rate()).and_also(Rate(1, seconds, size))
            self._timed[name] = timed
        if timed.points >= _RECORD_AFTER:
            self.keep()
