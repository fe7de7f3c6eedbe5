"""What is there without the sample: the dark level, and the source's own spectrum."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import ConfigError
from octsim.config.measured import Measured
from octsim.measured.axis import Axis
from octsim.measured.open import opened_recording

Array = NDArray[np.float64]
BRIGHT = 0.05
"""Of the largest mean count, from which a sample of the spectra is bright."""
_BLOCK = 4096  # spectra
_SURE = 5.0
"""Standard errors by which light stands out from the dark."""


class Mean(NamedTuple):
    """The mean of spectra of one kind, in counts."""

    value: Array
    """(K,)."""
    noise: Array
    """Standard deviation of one spectrum, (K,); NaN of a single one."""
    spectra: int
    """How many there are."""

    @property
    def error(self) -> Array:
        """Standard error of the mean, (K,); NaN of a single spectrum."""
        found: Array = self.noise / np.sqrt(self.spectra)
        return found


def mean_of(key: str, file: str, at: str | None, samples: int, axis: Axis) -> Mean:
    """Return the mean over the spectra of a file, at the samples of a band.

    Parameters
    ----------
    key : str
        Of the config, that names the file.
    file : str
    at : str or None
        Name inside the file, of one with several arrays.
    samples : int
        That the sample's spectra have.
    axis : Axis

    Raises
    ------
    OctsimError
        If it can't be read, or has another number of samples.
    """
    total, count = np.zeros((2, axis.sample.size)), 0
    with opened_recording(file, at, samples=samples) as found:
        if found.counts.shape[1] != samples:
            raise ConfigError(
                f"{key}: {found.name} has {found.counts.shape[1]} samples in a spectrum, and "
                f"measured.spectra has {samples}; give one of the same spectrometer"
            )
        first = np.asarray(found.counts[0:1], float)[0, axis.sample]
        for begin in range(0, found.counts.shape[0], _BLOCK):
            # about the first one, so that squares of large counts keep their digits
            block = np.asarray(found.counts[begin : begin + _BLOCK], float)[:, axis.sample] - first
            total += block.sum(axis=0), (block**2).sum(axis=0)
            count += len(block)
    mean, squares = total / count
    if not np.isfinite(mean).all():
        raise ConfigError(f"{key}: {file} holds values that are no numbers; leave these out")
    spread = np.sqrt(np.maximum(squares - mean**2, 0) * count / max(count - 1, 1))
    return Mean(first + mean, spread if count > 1 else np.full_like(spread, np.nan), count)


def without_sample(asked: Measured, samples: int, axis: Axis) -> tuple[Mean | None, Mean | None]:
    """Return what was recorded without light, and of the source alone; None of what was not given.

    Parameters
    ----------
    asked : Measured
    samples : int
        That the sample's spectra have.
    axis : Axis

    Raises
    ------
    OctsimError
        If one can't be read, or is the sample's own spectra.
    """
    found: list[Mean | None] = []
    for key, place in (("dark", asked.dark_place), ("reference", asked.reference)):
        if place is None:
            found.append(None)
            continue
        file, at = asked.file_and_name(place)
        if asked.spectra and Path(file).resolve() == Path(asked.spectra).resolve():
            _require_another_name(key, file, at, asked.at)
        found.append(mean_of(f"measured.{key}", file, at, samples, axis))
    return found[0], found[1]


def _require_another_name(key: str, file: str, at: str | None, spectra: str | None) -> None:
    """Refuse a dark or a reference that is the sample's spectra, the first of which it would be."""
    if at is None:
        raise ConfigError(
            f"measured.{key}: {file} given, which is measured.spectra too; give a file of its "
            f"own, as of what was recorded without the sample, or {{at: /raw/{key}}}"
        )
    if spectra is None:
        raise ConfigError(
            f"measured.{key}: {at} of the file of spectra given, and measured.at does not say "
            "where in it the spectra are; give both names"
        )
    if at.strip("/") == spectra.strip("/"):
        raise ConfigError(
            f"measured.{key}: {at} of the file of spectra given, which is measured.at too; give "
            "the name of what was recorded without the sample"
        )


def source_by(reference: Mean, dark: Mean | None, mean: Array, axis: Axis) -> tuple[Array, Array]:
    """Return the source's power, over its largest, from its own spectra, and its error, (K,) each.

    Parameters
    ----------
    reference : Mean
        Of the source alone, raw.
    dark : Mean or None
        That is subtracted.
    mean : ndarray, shape (K,)
        Of the sample's spectra, without the dark: where they are bright the source must be.
    axis : Axis

    Raises
    ------
    ConfigError
        If it has no light, or none where the sample's spectra have some.
    """
    net, largest = lit(reference, dark)
    errors = [np.nan_to_num(one.error) for one in (reference, dark) if one]
    error = np.sqrt(sum(one**2 for one in errors))
    unlit = (net <= _SURE * error) & (mean > BRIGHT * mean.max())
    if unlit.any():
        at = int(unlit.argmax())
        raise ConfigError(
            f"measured.reference: has no light at {1e3 * axis.wavelength[at]:.6g} nm and "
            f"{unlit.sum() - 1} other samples, where the spectra do; give the source of these "
            "spectra, in the same band"
        )
    return np.maximum(net, 0) / largest, error / largest


def lit(reference: Mean, dark: Mean | None) -> tuple[Array, float]:
    """Return the source's counts without the dark, (K,), and the largest of them.

    Raises
    ------
    ConfigError
        If none is above the dark.
    """
    net = reference.value - (dark.value if dark else 0.0)
    largest = float(net.max())
    if not largest > 0:
        raise ConfigError(
            "measured.reference: no light is left of it without the dark; give the source's own "
            "spectrum, raw as the others are"
        )
    return net, largest
