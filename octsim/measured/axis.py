"""Which wavenumber each sample of a spectrometer is of."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import ConfigError, DatasetError
from octsim.config.measured import AxisFile, AxisPolynomial
from octsim.config.models import Wavelengths
from octsim.config.units import find_unit, format_length
from octsim.measured.open import opened_recording
from octsim.measured.recording import Recording, Values
from octsim.phase.measured_spectra import FEWEST, LONGEST, SHORTEST, wavenumbers_of

Array = NDArray[np.float64]
GivenAxis = AxisFile | AxisPolynomial | None


class Axis(NamedTuple):
    """The samples of a band, by rising wavenumber."""

    wavenumber: Array
    """(K,), 1/µm."""
    sample: NDArray[np.int64]
    """Which of the recording's samples each is, (K,)."""

    @property
    def wavelength(self) -> Array:
        """µm, (K,)."""
        found: Array = 2 * np.pi / self.wavenumber
        return found


def samples_of(given: GivenAxis) -> Values | None:
    """Return what a config's file says of each sample; None where it names none.

    Raises
    ------
    OctsimError
        If the file can't be read, or holds other than a column of numbers.
    """
    if not isinstance(given, AxisFile):
        return None
    name, file = next((key, one) for key, one in given if one is not None)
    with opened_recording(file) as found:
        if found.axis is not None:
            return found.axis._replace(name=name)
        numbers = np.asarray(found.counts[:], float).ravel()
        if numbers.size < FEWEST:
            raise DatasetError(
                f"measured.axis.{name}: {file} holds {numbers.size} numbers; give one for each "
                "sample"
            )
        return Values(numbers, name, "nm" if name == "wavelength" else "1/um")


def axis_of(recording: Recording, given: GivenAxis) -> Array:
    """Return the wavenumbers (K,), 1/µm, of a recording's samples, in their order.

    Parameters
    ----------
    recording : Recording
        With the axis of the file that ``measured.axis`` names, if it names one.
    given : AxisFile, AxisPolynomial or None
        ``measured.axis``.

    Raises
    ------
    OctsimError
        If there is none, it has another length, or is none of a spectrometer.
    """
    samples = recording.counts.shape[1]
    if isinstance(given, AxisPolynomial):
        nm = np.polynomial.Polynomial(given.polynomial)(np.arange(samples, dtype=float))
        values = Values(nm, "wavelength", "nm")
    elif recording.axis is not None:
        values = recording.axis
    else:
        raise ConfigError(
            f"measured.axis: not given, and {recording.name} has none; give {{wavelength: "
            "calib.csv}, or {polynomial: [c0, c1, c2, c3]} over pixels"
        )
    key = "measured.axis" if given is not None else recording.name
    if values.values.size != samples:
        raise ConfigError(
            f"{key}: has {values.values.size} samples, but {recording.name} has {samples} in a "
            "spectrum; give the axis of this spectrometer"
        )
    k = wavenumbers_of(values.values, values.name, values.unit, key)
    require_axis(k, key)
    return k


def require_axis(wavenumber: Array, name: str) -> None:
    """Refuse what is no axis of a spectrometer.

    Raises
    ------
    DatasetError
        If it has too few samples, is not positive, turns, or is of other wavelengths.
    """
    if wavenumber.size < FEWEST:
        raise DatasetError(f"{name}: {wavenumber.size} samples given; give {FEWEST} or more")
    if not (np.isfinite(wavenumber).all() and (wavenumber > 0).all()):
        raise DatasetError(f"{name}: a wavelength or wavenumber is not a positive number; mend it")
    steps = np.diff(wavenumber) * np.sign(wavenumber[-1] - wavenumber[0])
    if not (steps > 0).all():
        at = 1 + int(np.argmax(steps <= 0))
        raise DatasetError(
            f"{name}: the wavelengths turn at sample {at}, {2e3 * np.pi / wavenumber[at]:.6g} nm; "
            "give each sample one, rising or falling"
        )
    longest, shortest = (2 * np.pi / float(one) for one in (wavenumber.min(), wavenumber.max()))
    if longest > LONGEST or shortest < SHORTEST:
        raise DatasetError(
            f"{name}: wavelengths from {shortest:.3g} to {longest:.3g} um given, not those of a "
            "spectrometer; look at their unit"
        )


def within(wavenumber: Array, band: Wavelengths) -> Axis:
    """Return the samples within a band, by rising wavenumber.

    Raises
    ------
    ConfigError
        If the band is beyond the samples by more than one, or holds too few.
    """
    order = np.argsort(wavenumber)
    k = wavenumber[order]
    low, high = 2 * np.pi / band.max, 2 * np.pi / band.min
    margin = np.diff(k)
    if low < k[0] - margin[0] or high > k[-1] + margin[-1]:
        first, last = (format_length(round(2 * np.pi / float(one), 6)) for one in (k[-1], k[0]))
        raise ConfigError(
            f"spectrum.wavelength: {format_length(band.min)} to {format_length(band.max)} given, "
            f"but the spectrometer sees {first} to {last}; give a band within that, which the "
            "calibration has too"
        )
    inside = (k >= low) & (k <= high)
    if inside.sum() < FEWEST:
        raise ConfigError(
            f"spectrum.wavelength: {inside.sum()} samples of the spectrometer are within "
            f"{format_length(band.min)} to {format_length(band.max)}, and {FEWEST} are needed; "
            "give a wider band"
        )
    return Axis(k[inside], order[inside])


def taken(block: NDArray[Any], samples: NDArray[np.int64]) -> NDArray[Any]:
    """Return some samples of spectra (T, S), (T, K): by a slice where they stand one by one."""
    step = int(samples[1] - samples[0])
    if abs(step) == 1 and (np.diff(samples) == step).all():
        end = int(samples[-1]) + step
        return block[:, slice(int(samples[0]), end if end >= 0 else None, step)]
    return block[:, samples]


def seconds_of(recording: Recording, rate: float | None) -> Array:
    """Return the time of each spectrum, (T,), s.

    Raises
    ------
    OctsimError
        If neither a rate (Hz) nor the recording says it, or times do not rise.
    """
    count = recording.counts.shape[0]
    if rate is not None:
        return np.asarray(np.arange(count) / rate)
    if recording.time is None:
        raise ConfigError(
            f"measured.rate: not given, and {recording.name} has no times; give it, as 20 kHz"
        )
    unit = _seconds(recording.time.unit)
    if unit is None:
        raise DatasetError(
            f"{recording.name}: times have the unit {recording.time.unit!r}; give measured.rate"
        )
    time: Array = recording.time.values * unit
    late = np.diff(time) <= 0
    if late.any() or not np.isfinite(time).all():
        at = 1 + int(late.argmax())
        raise DatasetError(
            f"{recording.name}: the time does not rise at spectrum {at}; give measured.rate, or "
            "sort the spectra"
        )
    since: Array = time - time[0]
    return since


def _seconds(unit: str) -> float | None:
    found = find_unit(unit)
    return float(found.size) if found is not None and found.dimension == "time" else None
