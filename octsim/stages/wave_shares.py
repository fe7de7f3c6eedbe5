"""What the parts of a field have in a spectrum: the exact counterparts of light paths."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from octsim.schemes.fullwave.series import over_band
from octsim.schemes.light import TERMS, Waves
from octsim.stages.ray_shares import SAMPLES

NAMES = (*(name.replace("_", " ") for name in TERMS), "rest")
"""The parts, as they stand among the paths."""


def wave_shares(waves: Waves, first: float, step: float) -> dict[str, NDArray[Any]]:
    r"""Return what each part of a field has in one spectrum, by the variable's name; all (P,).

    Both polarisations count the same: an amplitude is that of their mean intensity, a phase that of
    their mean field. The optical path is the mean slope of the phase over the wavenumber,

    .. math:: \Lambda = \arg\Bigl(\sum E^*(k)\, E(k + \Delta k)\Bigr) / \Delta k

    Parameters
    ----------
    waves : Waves
        The field.
    first, step : float
        First of `SAMPLES` wavenumbers and their spacing, 1/µm.
    """
    k = first + step * np.arange(SAMPLES, dtype=np.float64)
    rest = waves.values - waves.terms.sum(axis=0)
    parts = over_band(waves, np.concatenate((waves.terms, rest[np.newaxis])), k)
    whole = over_band(waves, waves.values, k)
    intensity = float((np.abs(whole) ** 2).sum())
    taken = (parts.conj() * whole).real.sum(axis=(1, 2))
    middle = parts[..., SAMPLES // 2]
    turn = (parts[..., :-1].conj() * parts[..., 1:]).sum(axis=(1, 2))
    # of the field without the phase that was taken out, so that no turn is as large as a half
    slow = turn * np.exp(-1j * step * waves.optical_path_length)
    there = np.abs(parts).max(axis=(1, 2)) > 0
    return {
        "field_amplitude": np.sqrt((np.abs(middle) ** 2).mean(axis=1)),
        "field_phase": np.where(there, np.angle(middle.mean(axis=1)), np.nan),
        "mean_optical_path_length": np.where(
            there, waves.optical_path_length + np.angle(slow) / step, np.nan
        ),
        "share": taken / intensity if intensity > 0 else np.zeros(len(parts)),
        "path_rays": np.zeros(len(parts), np.int64),
    }
