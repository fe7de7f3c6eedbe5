"""What is found out of a recording before its phases are: axis, levels, depth, noise, fit."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import ConfigError
from octsim.config.derive import calibrating
from octsim.config.measured import Dispersion
from octsim.config.models import Config
from octsim.config.source import source_of
from octsim.measured.axis import Axis, axis_of, seconds_of, taken, within
from octsim.measured.background import Mean, source_by, without_sample
from octsim.measured.chain_error import reference_error
from octsim.measured.dispersion import fitted, phase_over
from octsim.measured.full_scale import full_scale_of, saturated
from octsim.measured.noise import Transfer, transfer
from octsim.measured.recording import Recording
from octsim.phase.estimators import estimate
from octsim.phase.estimators.estimate import Estimate
from octsim.phase.estimators.judged import reference as fitted_depth
from octsim.phase.estimators.one_fit import (
    Design,
    Model,
    design_of,
    residuals,
    still_part,
    unturned,
)
from octsim.phase.measured_spectra import resampled
from octsim.phase.transform import without_source

Array = NDArray[np.float64]
FIRST = 512
"""Spectra at the start, whose mean tells depth, weights and noise."""


class Setup(NamedTuple):
    """All that the phases of a recording are found by."""

    wavenumber: Array
    """Of all samples, rising, (S,), 1/µm."""
    order: NDArray[np.int64]
    """Which sample of the recording each is, (S,)."""
    band: Axis
    """Samples that are fitted, (K,)."""
    time: Array
    """(T,), s."""
    dark: Mean | None
    reference: Mean | None
    source: Array | None
    """Power of the source in the band, (K,); None of a flat one."""
    source_from: str
    """reference, config or none."""
    mean: Array
    """Of the first spectra, without the dark, (K,)."""
    full_scale: float
    """Counts; infinite where it is not known."""
    model: Model
    design: Design
    noise: Transfer
    variance: Array
    """Of each sample's counts, (K,)."""
    fringe: Estimate
    """Of the mean spectrum, (1,)."""
    measured_depth: float
    """At which a fringe fits the mean spectrum best, µm; NaN without one."""
    dispersion: tuple[float, float]
    """a2 and a3, rad."""
    chain_error: float
    """Relative error of changes of the phase, by what is before it."""

    @property
    def spectra(self) -> int:
        """How many there are."""
        return self.time.size

    def net(self, block: NDArray[np.generic]) -> Array:
        """Return the band of spectra as they are recorded, (T, S) to (T, K), without the dark."""
        # a copy in any case, whatever the block is of
        counts = taken(block, self.band.sample).astype(np.float64)
        if self.dark is not None:
            counts -= self.dark.value
        return counts


def setup_of(config: Config, recording: Recording) -> Setup:
    """Return what the phases of a recording are found by.

    Raises
    ------
    OctsimError
        If something is missing or does not fit; in a line that says what to do.
    """
    asked = config.measured
    k = axis_of(recording, asked.axis)
    time, band = seconds_of(recording, asked.rate), within(k, config.spectrum.wavelength)
    dark, reference = without_sample(asked, k.size, band)
    full, net = _first(recording, band, dark, asked.full_scale)
    mean = net.mean(axis=0)
    source, source_error, known_from = _source(config, reference, dark, mean, band)
    processing = calibrating(config)
    nominal = _nominal(config)
    even = np.linspace(band.wavenumber[0], band.wavenumber[-1], band.wavenumber.size)
    on_even = None if source is None else resampled(source[np.newaxis], band.wavenumber, even)[0]
    mean_even = resampled(mean[np.newaxis], band.wavenumber, even)
    dispersion = _dispersion(asked.dispersion, mean_even, even, on_even)
    held = nominal
    if not np.isfinite(held):
        peak = estimate(mean_even, even, np.array([nominal]), processing, source=on_even).depth[0]
        held = peak if np.isfinite(peak) else config.swept_group_index * config.expansion.diameter
    model = Model(
        band.wavenumber, float(held), processing.sinusoid, source,
        phase_over(band.wavenumber, *dispersion) if any(dispersion) else None,
        asked.reference_depth,
    )  # fmt: skip
    design = design_of(model, mean, processing.read_noise**2)
    noise = transfer(mean, _variance(design, net))
    if processing.sinusoid.weights == "shot":
        design = design_of(model, mean, noise.read_noise**2)
    bare = mean - still_part(design, mean)
    if model.turned is not None:
        bare = bare + unturned(design, model.turned, mean)
    alone = resampled(bare[np.newaxis], band.wavenumber, even)
    fringe, free = (
        estimate(alone, even, np.array([nominal]), one, source=on_even)
        for one in (processing, fitted_depth(processing))
    )
    order = np.argsort(k)
    return Setup(
        k[order], order, band, time, dark, reference, source, known_from, mean, full, model,
        design, noise, noise.variance(mean), fringe, float(free.depth[0]), dispersion,
        reference_error(model, design, mean, source_error, noise.read_noise**2),
    )  # fmt: skip


def _first(
    recording: Recording, band: Axis, dark: Mean | None, given: float | None
) -> tuple[float, Array]:
    """Return the camera's full scale, and the first spectra that are not full, without the dark."""
    if not recording.counts.shape[0]:
        raise ConfigError(
            f"measured.spectra: {recording.name} holds wavelengths alone; give the file of spectra"
        )
    first = taken(np.asarray(recording.counts[:FIRST]), band.sample)
    full = full_scale_of(first, given)
    whole = saturated(first, full) == 0
    if not whole.any():
        raise ConfigError(
            f"measured.spectra: all of the first {len(first)} spectra have samples at "
            f"{full:g} counts, where the camera is full; expose for less, or give "
            "measured.full_scale"
        )
    net = first[whole].astype(float) - (dark.value if dark else 0.0)
    if not np.isfinite(net).all():
        at = int(np.argwhere(~np.isfinite(net))[0][0])
        raise ConfigError(
            f"measured.spectra: spectrum {at} of {recording.name} holds values that are no "
            "numbers; leave it out"
        )
    return full, net


def _nominal(config: Config) -> float:
    """Return the optical depth at which the fringe is by the config, µm; NaN where its peak is."""
    asked = config.processing.depth
    if asked == "peak":
        return np.nan
    of_diameter = config.swept_group_index * config.expansion.diameter
    return asked if isinstance(asked, float) else of_diameter


def _source(
    config: Config, reference: Mean | None, dark: Mean | None, mean: Array, band: Axis
) -> tuple[Array | None, Array, str]:
    """Return the source's power in the band, its error, and where it is from."""
    exact = np.zeros(band.sample.size)
    if reference is not None:
        return *source_by(reference, dark, mean, band), "reference"
    given = source_of(config.spectrum.source)
    if given is None:
        return None, exact, "none"
    return given.power(band.wavenumber), exact, "config"


def _dispersion(
    asked: Dispersion | str, mean: Array, wavenumber: Array, source: Array | None
) -> tuple[float, float]:
    if isinstance(asked, Dispersion):
        return asked.a2, asked.a3
    bare = without_source(mean, source)[0] if source is not None else mean[0] - mean[0].mean()
    return fitted(bare, wavenumber)


def _variance(design: Design, net: Array) -> Array:
    """Return the variance of each sample, (K,), by what fits leave of spectra, one after the other.

    What the model does not have is the same in all of them, and goes with the difference of two.
    """
    left, used = residuals(design, net), design.columns.shape[1]
    samples = net.shape[1]
    share = samples / max(samples - used, 1)
    if len(left) < 3:  # one or two spectra: what is left of each tells
        return np.asarray((left**2).mean(axis=0) * share)
    return np.asarray((np.diff(left, axis=0) ** 2).mean(axis=0) / 2 * share)
