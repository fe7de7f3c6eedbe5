"""Spectra with an effect and without it, point by point, and what both take."""

import time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.threads import each
from octsim.config.models import Config
from octsim.config.scheme import scheme_of
from octsim.instrument.instrument import Instrument
from octsim.schemes.light import AccuracyStatus
from octsim.studies.effects.variants import Variant

Array = NDArray[np.float64]
_ROUGHEST = 0.1
"""The largest accuracy that a config may ask for."""


class Swept(NamedTuple):
    """Spectra of D diameters with an effect and without it."""

    with_effect: Array
    """(D, K)."""
    without_effect: Array
    """(D, K)."""
    error: Array
    """Larger of the two estimated errors, (D,)."""
    status: AccuracyStatus
    """Of the spectrum that is farthest from as asked."""
    seconds: Array
    """Processor time of a point, with the effect and without it, (2, D), s."""

    @property
    def cost_ratio(self) -> float:
        """Median over the diameters of how many times as long it takes with the effect."""
        return float(np.median(self.seconds[0] / self.seconds[1]))


def swept(variant: Variant, diameter: Array, foci: Array, threads: int) -> Swept:
    """Find the light of each diameter with an effect and without it, one after the other.

    Nothing is kept from before, as what it takes is measured; what the machine is busy with
    besides is so for both.

    Parameters
    ----------
    variant : Variant
    diameter, foci : ndarray, shape (D,)
        µm.
    threads : int
    """
    one, other = Instrument(variant.with_effect), Instrument(variant.without_effect)

    def at(place: tuple[float, float]) -> tuple[Array, Array, float, AccuracyStatus, float, float]:
        size, focus = place
        start = time.thread_time()
        plain = other.spectrum(size, focus)
        middle = time.thread_time()
        changed = one.spectrum(size, focus + variant.focus)
        end = time.thread_time()
        return (
            changed.intensity, plain.intensity, max(changed.error, plain.error),
            max(changed.status, plain.status), end - middle, middle - start,
        )  # fmt: skip

    places = zip(diameter.tolist(), foci.tolist(), strict=True)
    changed, plain, error, status, *seconds = zip(*each(at, places, threads), strict=True)
    return Swept(np.stack(changed), np.stack(plain), np.array(error), max(status),
                 np.maximum(seconds, 1e-9))  # fmt: skip


def rougher(config: Config) -> Config:
    """Return a config, not checked, with half the rays, or a tenth of the accuracy."""
    tracing = config.tracing
    update: dict[str, float] = {"accuracy": min(10 * tracing.accuracy, _ROUGHEST)}
    if scheme_of(config).counts_rays:
        update = {"rays": max(tracing.rays // 2, 1)}
    return config.model_copy(update={"tracing": tracing.model_copy(update=update)})


def made_rougher(variant: Variant) -> Variant:
    """Return an effect as it is found with less effort."""
    return variant._replace(
        with_effect=rougher(variant.with_effect), without_effect=rougher(variant.without_effect)
    )
