"""What is seen of a diameter by every detector: phases, brightness, and the spectrum's shape."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.models import Config, FocusLine
from octsim.instrument.instrument import Instrument, PointSpectrum
from octsim.instrument.points import Points
from octsim.phase.derivatives import wrapped
from octsim.phase.estimators.sinusoid import fit_sinusoid
from octsim.phase.estimators.visible import fringe_at
from octsim.phase.fringe_status import WITH_PHASE
from octsim.schemes.light import AccuracyStatus, Optics
from octsim.studies.detector.cases import Case
from octsim.studies.detector.collected import LARGER, Collected, collected, optics_by, returned
from octsim.studies.validity.errors import by_estimator

Array = NDArray[np.float64]
SCHEMES = ("vogel", "paths")
"""Of rays: those that are counted, and what they come to as they become more."""


class Seen(NamedTuple):
    """What N detectors see of a diameter, by S schemes; NaN where a scheme can't do a detector."""

    phase: Array
    """At the middle of the band, (S, N), rad; NaN without a fringe."""
    fringe: NDArray[np.int8]
    """Its `FringeStatus`, (S, N)."""
    intensity: Array
    """Mean over the band, (S, N)."""
    shape_error: Array
    """Mean square, over the band, of the spectrum over its mean less Maxwell's, (S, N)."""
    exact_phase: float
    """By Maxwell's equations."""
    exact_accuracy: AccuracyStatus
    """Of theirs."""
    edge_step: Array
    """By how much the phase moves as rays enter and leave, (N,), rad."""
    collected: tuple[Collected, ...]
    """By counted rays, N of them."""
    error: Array
    """Estimated error of the intensity by light paths, (N,)."""
    accuracy: NDArray[np.int8]
    """`AccuracyStatus` of light paths, (N,)."""


class Bench:
    """Every detector on one instrument, and the same instrument by Maxwell's equations.

    It can be used from several threads.

    Parameters
    ----------
    every : sequence of Case
        The detectors.
    exact : Config or None
        By Maxwell's equations; None where those are not solved.
    line : FocusLine
        Which the focus follows.
    points : Points, optional
        Where light that was found before is kept.
    """

    def __init__(
        self, every: Sequence[Case], exact: Config | None, line: FocusLine, points: Points | None
    ) -> None:
        self._config, self._line = every[0].counted, line
        self._optics: list[Optics] = optics_by([case.counted for case in every])
        self._limits = [_instrument(case.limit, points) for case in every]
        self._exact = _instrument(exact, points)
        self._wavenumber = self._config.spectrum.wavenumbers()
        self._processing = by_estimator(self._config.processing, "sinusoid")

    def seen(self, diameter: float) -> Seen:
        """Return what is seen of a diameter, µm."""
        focus = self._line.at(diameter)
        rays, larger = (
            returned(self._config, self._optics, d, self._line.at(d))
            for d in (diameter, diameter + LARGER)
        )
        found = tuple(collected(optics, rays, larger) for optics in self._optics)
        limits = [self._spectrum(one, diameter, focus) for one in self._limits]
        exact, _, status = self._spectrum(self._exact, diameter, focus)
        own, swapped = (
            np.stack([self._config.spectrum.recorded(one, self._wavenumber)[0] for one in each])
            for each in ([one.intensity for one in found], [one.swapped for one in found])
        )
        spectra = np.stack([*own, *(one.intensity for one in limits)])
        fringe, phase = self._phases(np.vstack([spectra, swapped, exact]), diameter)
        shape = (len(SCHEMES), len(found))
        counted, limit, after = phase[:-1].reshape(3, -1)
        mean = spectra.mean(axis=1)
        over = spectra / np.where(mean > 0, mean, np.nan)[:, np.newaxis]
        error = ((over - exact / exact.mean()) ** 2).mean(axis=1)
        return Seen(
            np.stack([counted, limit]), fringe[: spectra.shape[0]].reshape(shape),
            mean.reshape(shape), error.reshape(shape), float(phase[-1]), status,
            wrapped(after - counted), found, np.array([one.error for one in limits]),
            np.array([one.status for one in limits], np.int8),
        )  # fmt: skip

    def _spectrum(self, one: Instrument | None, diameter: float, focus: float) -> PointSpectrum:
        if one is None:
            nothing = np.full(self._wavenumber.size, np.nan)
            return PointSpectrum(nothing, np.nan, AccuracyStatus.REACHED)
        return one.spectrum(diameter, focus)

    def _phases(self, spectra: Array, diameter: float) -> tuple[NDArray[np.int8], Array]:
        """Return the status of the fringe of spectra, and their phases, NaN without one."""
        depth = np.full(len(spectra), self._config.swept_group_index * diameter)
        power = self._config.spectrum.power()
        status = fringe_at(spectra, self._wavenumber, depth, source=power).status
        phase, some = np.full(len(spectra), np.nan), np.flatnonzero(np.isin(status, WITH_PHASE))
        fits = fit_sinusoid(spectra[some], self._wavenumber, depth[some], self._processing, power)
        for part, fit in fits:
            phase[some[part]] = fit.phase
        return status, phase


def _instrument(config: Config | None, points: Points | None) -> Instrument | None:
    return None if config is None else Instrument(config, points)
