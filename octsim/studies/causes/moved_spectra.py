"""Spectra of a sweep whose diameters are moved, by the run's rays and by a converged sum."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from octsim.config.models import FocusLine
from octsim.instrument.instrument import Instrument
from octsim.studies.causes.beat import Parts, fields_at, parts
from octsim.studies.causes.switches import Causes, Stencil, neighbours

Array = NDArray[np.float64]
POINT = 1e-5
"""Half width of the difference that stands for a derivative at a point, µm."""


class MovedSpectra:
    """Spectra in parts, of diameters and of the same moved; each is made once, when asked for.

    Parameters
    ----------
    run, converged : Instrument
        What has the cause ``rays``, and what has not.
    line : FocusLine
        The focus of each diameter.
    diameter : ndarray, shape (D,)
        µm.
    threads : int
        Points traced at once.
    """

    def __init__(
        self,
        run: Instrument,
        converged: Instrument,
        line: FocusLine,
        diameter: Array,
        threads: int,
    ) -> None:
        self.run, self.converged = run, converged
        self.line, self.diameter, self.threads = line, diameter, threads
        self._moved = cache(self._parts)

    def around(self, diameter: Array) -> "MovedSpectra":
        """Return the same instruments' spectra of other diameters (D,), µm."""
        return MovedSpectra(self.run, self.converged, self.line, diameter, self.threads)

    def stencil(self, present: Causes, step: float) -> Stencil:
        """Return spectra a step (µm) apart, of the rays that some of the causes have."""
        below, at, above = (self._moved("rays" in present, by) for by in (-step, 0.0, step))
        return Stencil(below, at, above, np.full(self.diameter.size, 2 * step))

    def chosen(self, present: Causes) -> Stencil:
        """Return the stencil of some of the causes."""
        if "step" in present:
            return neighbours(self._moved("rays" in present, 0.0), self.diameter)
        return self.stencil(present, POINT)

    def _parts(self, by_run: bool, offset: float) -> Parts:
        at = self.diameter + offset
        instrument = self.run if by_run else self.converged
        return parts(fields_at(instrument, at, self.line.at(at), self.threads))
