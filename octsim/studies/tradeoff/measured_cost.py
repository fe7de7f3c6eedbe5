"""What a sweep costs: segments of ray, processor time, and memory of a process of its own."""

import contextlib
import ctypes
import multiprocessing
import resource
import statistics
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import NamedTuple, ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

from octsim.config.models import Config
from octsim.instrument.instrument import Instrument
from octsim.schemes.light import AccuracyStatus

_REPEATS = 3
_LONG = 1.0  # s; what takes longer is not repeated
_RSS_UNIT = 1 if sys.platform == "darwin" else 1024  # bytes
Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")


class MeasuredCost(NamedTuple):
    """A sweep's spectra, and what tracing and summing them cost on one thread."""

    intensity: NDArray[np.float64]
    """Spectra, (D, K)."""
    segments: float
    """Straight pieces of ray that were traced, a diameter; none of waves."""
    cpu_seconds: float
    """Processor time of the whole sweep; the median of a few, unless it takes long."""
    peak_memory: float
    """By how much the process's largest resident set grew, MiB; the spectra are part of it."""
    unreached: int
    """Number of diameters whose accuracy was asked for and is not reached."""


def sweep_cost(
    config: Config, diameters: NDArray[np.float64], foci: NDArray[np.float64]
) -> MeasuredCost:
    """Return what it takes to trace and sum a sweep on this thread, no light being kept.

    Compiled code should be there, and no memory free, as in a process that has just begun.

    Parameters
    ----------
    config : Config
        The instrument and the spectrum.
    diameters, foci : ndarray, shape (D,)
        Diameters and heights of the focus, µm.
    """
    places = list(zip(diameters.tolist(), foci.tolist(), strict=True))
    before = _largest_resident_set()

    def once() -> tuple[list[NDArray[np.float64]], list[int], list[AccuracyStatus], float]:
        # processor time of the process, as libraries of linear algebra have threads of their own
        start = time.process_time()
        instrument = Instrument(config)  # anew, as one keeps what its points share
        spectra, segments, status = [], [], []
        for diameter, focus in places:
            light = instrument.light(diameter, focus)
            spectra.append(instrument.sum(light).intensity)
            segments.append(light.segments)
            status.append(light.status)
        return spectra, segments, status, time.process_time() - start

    spectra, segments, status, seconds = once()
    grown = (_largest_resident_set() - before) / 2**20
    times = [seconds]
    if seconds < _LONG:
        times = [once()[-1] for _ in range(_REPEATS)]
    fine = (AccuracyStatus.REACHED, AccuracyStatus.NOT_CONTROLLED)
    return MeasuredCost(
        np.stack(spectra),
        float(np.mean(segments)),
        statistics.median(times),
        grown,
        sum(s not in fine for s in status),
    )


def apart(
    prepare: Callable[[], None] | None,
    work: Callable[Parameters, Result],
    *arguments: Parameters.args,
    **keywords: Parameters.kwargs,
) -> Result:
    """Return the result of work in a process of its own, where no memory is left from before.

    Parameters
    ----------
    prepare : callable or None
        What that process does first.
    work : callable
        A function of a module, as it is sent by its name.
    *arguments, **keywords
        What `work` takes.
    """
    _free_memory()
    # forked, as compiled code is then there at once
    with ProcessPoolExecutor(1, multiprocessing.get_context("fork"), prepare) as pool:
        return pool.submit(work, *arguments, **keywords).result()


def _free_memory() -> None:
    """Hand memory that is free to the system, or a new process would use it unseen."""
    with contextlib.suppress(AttributeError, OSError):  # the C library of GNU has it
        ctypes.CDLL(None).malloc_trim(0)


def _largest_resident_set() -> int:
    """Return the largest memory that this process has held so far, in bytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * _RSS_UNIT
