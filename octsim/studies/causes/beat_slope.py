"""The slope proper: how the phase of the beat, and of each side's field, moves at a point."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.instrument.instrument import Instrument
from octsim.phase.derivatives import phase_derivative
from octsim.studies.causes.beat import fields_at, parts
from octsim.studies.causes.switches import Reading, weights

Array = NDArray[np.float64]
Focusing = Callable[[Array], Array]
STEP = 1e-3
"""Half width of the differences, µm: these phases have no kinks, and 1 nm holds no noise."""


class BeatSlopes(NamedTuple):
    """Phase slopes over D diameters, rad/µm = mrad/nm, with estimates of their errors."""

    beat: Array
    """Of 2 E_n* E_f, meaned over the band with the window and the phase cos(2ndk) taken off."""
    near: Array
    """Of the field off the glass and the near side, at the middle of the band."""
    far: Array
    """Of the field off the far side, at the middle of the band."""
    beat_error: Array


def beat_slopes(
    instrument: Instrument, reading: Reading, focusing: Focusing, threads: int = 1
) -> BeatSlopes:
    r"""Return how the phases of the fields themselves move, with no Fourier transform between.

    Along the axis the far side's path grows by 2 n_neuron d and the near side's not at all, so at
    a held focus the slopes are 2 n_neuron k and 0 there; light off the axis and the phase at a
    focus (Gouy) change that.

    Parameters
    ----------
    instrument : Instrument
        Its accuracy bounds what is reached.
    reading : Reading
        Diameters (D,), wavenumbers and window.
    focusing : callable
        Foci of diameters, both µm: what follows the diameter, and what is held.
    threads : int
        Points traced at once.
    """
    k = reading.wavenumber
    weight = weights(reading.processing, k.size)
    reference = weight * np.exp(-2j * reading.n_neuron * np.outer(reading.diameter, k))

    def phasors(offset: float) -> NDArray[np.complex128]:
        moved = reading.diameter + offset
        fields = fields_at(instrument, moved, focusing(moved), threads)
        beat = (parts(fields).beat * reference).sum(axis=1)
        return np.stack([beat, fields.near[:, k.size // 2], fields.far[:, k.size // 2]])

    derivative = phase_derivative(phasors, min(STEP, float(reading.diameter.min()) / 4))
    beat, near, far = derivative.value
    return BeatSlopes(beat, near, far, derivative.error[0])
