"""A lab's own spectra in octsim's form, each with its phase (`snakemake measured`)."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from enum import IntEnum
from operator import attrgetter
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import ConfigError
from octsim.config.grid import without_grid
from octsim.config.models import Config
from octsim.config.units import format_length
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.measured.axis import axis_of, samples_of, taken
from octsim.measured.full_scale import saturated
from octsim.measured.open import opened_recording
from octsim.measured.recording import RawForm, Recording
from octsim.measured.setup import Setup, setup_of
from octsim.measured.told import understood
from octsim.phase.estimators.one_fit import fitted
from octsim.phase.fringe_status import WITH_PHASE, FringeStatus, doubts_of

Array = NDArray[np.float64]


class BandStatus(IntEnum):
    """Whether a sample is in the band that is looked at."""

    IN_THE_BAND = 0
    OUTSIDE = 1


_BLOCK_BYTES = 8e6
"""Of counts as floats, that are worked on at a time: what fast memory holds, and few gigabytes."""


_FAINT = 0.2
"""Standard error of a phase, rad, above which a fringe is not told from noise."""


@contextmanager
def opened(config: Config) -> Iterator[Recording]:
    """Open the recording that a config names, with the axis of the file that it names.

    Raises
    ------
    ConfigError
        If it names none.
    """
    asked = config.measured
    if asked.spectra is None:
        raise ConfigError(
            "measured.spectra: not given; name the file that holds a spectrometer's spectra"
        )
    raw = None if asked.raw is None else RawForm(**dict(asked.raw))
    axis = samples_of(asked.axis)
    samples = None if axis is None else axis.values.size
    with opened_recording(asked.spectra, asked.at, raw, samples, asked.x) as recording:
        yield recording if axis is None else recording._replace(axis=axis)


def own_band(config: Config) -> dict[str, dict[str, str]]:
    """Return all that the spectrometer of a config sees, as the band of a config's spectrum."""
    with opened(config) as recording:
        k = axis_of(recording, config.measured.axis)
    ends = (2 * np.pi / float(one) for one in (k.max(), k.min()))
    return {"wavelength": dict(zip(("min", "max"), map(format_length, ends), strict=True))}


@Streamed
def measured(config: Config) -> Stream:
    """Read a lab's raw spectra, and estimate the phase of each.

    Parameters
    ----------
    config : Config
        Its section ``measured``; phases are by ``calibration.estimator`` with the options of
        ``processing``, in ``spectrum.wavelength``, at the depth of ``expansion.diameter``.

    Returns
    -------
    Dataset
        counts (time, wavenumber) as they were recorded; fringe_phase, fringe_phase_error,
        visibility, snr, fit_residual, saturated_samples and spectrum_status (time); source_power,
        dark_level and sample_variance (wavenumber), NaN outside of the band, as band_status says;
        and what was understood, as the attribute of that name.

    Raises
    ------
    OctsimError
        If a file can't be read or does not fit the others; in one line.
    """
    config = without_grid(config, "measured")
    if config.calibration.estimator != "sinusoid":
        raise ConfigError(
            f"calibration.estimator: {config.calibration.estimator} given, but measured spectra "
            "are fitted by the sinusoid, at their own wavelengths; give sinusoid"
        )
    if config.processing.sinusoid.depth == "fitted":
        raise ConfigError(
            "processing.sinusoid.depth: fitted given, but a series of spectra is fitted at one "
            "depth; give held"
        )
    with opened(config) as recording:
        setup = setup_of(config, recording)
        lines = understood(config, recording, setup)

    def own(_: Config) -> Mapping[str, Coordinate]:
        return {
            "time": ("time", setup.time),
            "wavenumber": ("wavenumber", setup.wavenumber),
            "wavelength": ("wavenumber", 2 * np.pi / setup.wavenumber),
        }

    layout = Layout(
        "measured", config, "Measured spectra, and the phase of each", own, "time",
        further={"understood": "\n".join(lines)},
    )  # fmt: skip
    return Stream(layout, _parts(config, layout, setup))


def _parts(config: Config, layout: Layout, setup: Setup) -> Iterator[Part]:
    at = layout.combinations[0]
    together = max(1, int(_BLOCK_BYTES / (8 * setup.order.size)))
    with opened(config) as recording:
        for first in range(0, setup.spectra, together):
            raw = np.asarray(recording.counts[first : first + together])
            variables = {
                "counts": (("time", "wavenumber"), native(taken(raw, setup.order))),
                **_phases(setup, raw),
            }
            if first == 0:
                variables |= _once(setup)
            yield Part(at, first, len(raw), variables)


def native(counts: NDArray[Any]) -> NDArray[Any]:
    """Return counts in this machine's order of bytes, row by row."""
    return np.ascontiguousarray(counts, counts.dtype.newbyteorder("="))


def _phases(setup: Setup, raw: NDArray[Any]) -> dict[str, Any]:
    """Return what is found of each spectrum."""
    net = setup.net(raw)
    found = fitted(setup.design, net, setup.variance)
    full = saturated(taken(raw, setup.band.sample), setup.full_scale)
    own = int(setup.fringe.status[0])
    status = np.where(full > 0, FringeStatus.SATURATED, own)
    status = np.where(np.isfinite(net).all(axis=1), status, FringeStatus.NO_SPECTRUM)
    status = np.where((net <= 0).all(axis=1), FringeStatus.NO_LIGHT, status)
    # the amplitude is within five standard errors of none
    faint = np.isin(status, WITH_PHASE) & (found.phase_error > _FAINT)
    status = np.where(faint, FringeStatus.NO_FRINGE, status)
    known = np.isin(status, WITH_PHASE)
    values = {
        "fringe_phase": found.phase, "fringe_phase_error": found.phase_error,
        "visibility": found.visibility, "snr": found.snr, "fit_residual": found.residual,
    }  # fmt: skip
    return {
        **{name: ("time", np.where(known, one, np.nan)) for name, one in values.items()},
        "saturated_samples": ("time", full),
        "spectrum_status": ("time", *flags(FringeStatus, status)),
    }


def _once(setup: Setup) -> dict[str, Any]:
    """Return what is of all spectra."""
    inside = np.searchsorted(setup.wavenumber, setup.band.wavenumber)
    status = np.full(setup.order.size, BandStatus.OUTSIDE)
    status[inside] = BandStatus.IN_THE_BAND

    def everywhere(values: Array) -> tuple[str, Array]:
        whole = np.full(setup.order.size, np.nan)
        whole[inside] = values
        return "wavenumber", whole

    flat = np.ones(setup.band.wavenumber.size)
    dark = np.zeros_like(flat) if setup.dark is None else setup.dark.value
    return {
        "source_power": everywhere(flat if setup.source is None else setup.source),
        "dark_level": everywhere(dark),
        "sample_variance": everywhere(setup.variance),
        "band_status": ("wavenumber", *flags(BandStatus, status)),
        "full_scale": setup.full_scale,
        "fringe_depth": setup.model.depth,
        "measured_depth": setup.measured_depth,
        "dark_noise": float(np.sqrt(setup.noise.read_variance)),
        "variance_per_count": setup.noise.per_count,
        "chain_error": setup.chain_error,
        "dispersion_a2": setup.dispersion[0],
        "dispersion_a3": setup.dispersion[1],
    }


def summary(found: xr.Dataset) -> str:
    """Return in one line what the spectra come to."""
    status = found["spectrum_status"].values
    known = np.isin(status, WITH_PHASE)
    error = found["fringe_phase_error"].values[known]
    return (
        f"{status.size} spectra of {found.sizes['wavenumber']} samples, {known.sum()} with a "
        f"phase, known to {1e3 * float(np.median(error)) if known.any() else np.nan:.3g} mrad each"
    )


def doubts(found: xr.Dataset) -> list[str]:
    """Say, a line each, what of the spectra may not be as it seems, and what to do."""
    return [
        *(line.removeprefix("warning: ") for line in str(found.attrs["understood"]).splitlines()
          if line.startswith("warning: ")),
        *doubts_of(found["spectrum_status"].values, "spectra", _remedy_of(found)),
    ]  # fmt: skip


def _remedy_of(found: xr.Dataset) -> Callable[[FringeStatus], str]:
    """Return what says what to do about a status of these spectra."""
    if "measured.reference: not given" in str(found.attrs["understood"]):
        return attrgetter("measured_remedy")
    return attrgetter("lit_remedy")
