"""How far a setting is from its scheme's own limit, and from Maxwell's equations."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import ConfigError
from octsim.config.derive import by_waves, changed, reference
from octsim.config.models import Config, FocusLine
from octsim.config.scheme import scheme_of
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.phase.slopes import phase_slopes
from octsim.phase.transform import fourier_components, without_source
from octsim.studies.tradeoff.settings import CONVERGED_SAMPLES, FINER, Setting, is_of_the_trade

Array = NDArray[np.float64]
_FINEST = 1e-9
"""Accuracy of the solution of Maxwell's equations that errors are measured from."""


class Errors(NamedTuple):
    """How far one setting is from the converged reference of its scheme."""

    worst_intensity_error: float
    """Largest over the diameters of max |I − I_ref| / max I_ref over k."""
    median_intensity_error: float
    """Median over the diameters of the same."""
    beyond_accuracy: int
    """Number of diameters where that is above the accuracy that was asked for."""
    phase_slope_rms_error: float = np.nan
    """Over the diameters, mrad/nm."""
    phase_slope_largest_error: float = np.nan
    """Over the diameters, mrad/nm."""


class MaxwellErrors(NamedTuple):
    """How far one setting is from Maxwell's equations; NaN where that is not measured."""

    maxwell_spectrum_worst_error: float = np.nan
    """Largest over the diameters of the error of the spectrum's shape."""
    maxwell_spectrum_median_error: float = np.nan
    """Median over the diameters of the same."""
    maxwell_slope_rms_error: float = np.nan
    """Over the diameters, mrad/nm."""
    maxwell_slope_largest_error: float = np.nan
    """Over the diameters, mrad/nm."""
    maxwell_slope_bias: float = np.nan
    """Mean over the diameters, mrad/nm, with its sign."""


def maxwell(config: Config, accuracy: float = _FINEST) -> Config:
    """Return a config that solves Maxwell's equations to an accuracy.

    Raises
    ------
    ConfigError
        If they are not solved for its scene and instrument.
    """
    return changed(by_waves(config), {"tracing": {"preset": None, "accuracy": accuracy}})


def why_no_maxwell(config: Config) -> str:
    """Say why Maxwell's equations are not solved for a config; nothing where they are."""
    try:
        maxwell(config)
    except ConfigError as error:
        return str(error)
    return ""


def intensity_errors(intensity: Array, exact: Array) -> Array:
    """Return max |I − I_ref| / max I_ref of each spectrum, (D, K) to (D,); NaN where it is dark."""
    with np.errstate(divide="ignore", invalid="ignore"):
        errors: Array = np.abs(intensity - exact).max(axis=1) / exact.max(axis=1)
    return errors


def shape_errors(intensity: Array, exact: Array) -> Array:
    """Return the error of each spectrum's shape, (D, K) to (D,): of I over its mean.

    What an intensity of 1 is differs between the schemes, so that shapes alone are compared.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        shape, true = (one / one.mean(axis=1, keepdims=True) for one in (intensity, exact))
    return intensity_errors(shape, true)


def strongest_slopes(config: Config, intensity: Array) -> Array:
    """Return the phase slope of the strongest component (D,), mrad/nm, of spectra (D, K)."""
    bare = without_source(intensity, config.spectrum.power())
    components = fourier_components(bare, config.processing)
    diameters = config.sweep.diameters.values()
    return phase_slopes(diameters, np.abs(components), np.angle(components)).strongest


class ReferenceSweep:
    """Converged spectra and slopes of a run; each is made when it is first asked for.

    Parameters
    ----------
    config : Config
        The run.
    line : FocusLine
        Where its sweep is focused.
    threads : int
        To find light on.
    points : Points
        Where light that was found before is kept.
    converged : callable, optional
        Returns the converged config of one: of rays, unless given.
    """

    def __init__(
        self,
        config: Config,
        line: FocusLine,
        threads: int,
        points: Points,
        converged: Callable[[Config], Config] = reference,
    ) -> None:
        self._config, self._line, self._threads, self._points = config, line, threads, points
        self._converged = converged
        self._spectra: dict[tuple[int, int], Array] = {}

    def spectra(self, num: int, samples: int) -> Array:
        """Return the spectra (D, K) of some number of diameters and of wavenumbers."""
        if (num, samples) not in self._spectra:
            config = self._converged(self._sampled(num, samples))
            diameters = config.sweep.diameters.values()
            self._spectra[num, samples] = Instrument(config, self._points).spectra(
                diameters, self._line.at(diameters), self._threads
            )
        return self._spectra[num, samples]

    def slopes(self, setting: Setting) -> Array:
        """Return what a setting's slope would be, were the factor that it varies converged."""
        num, samples = setting.config.sweep.diameters.num, setting.config.spectrum.samples
        if setting.factor == "spectrum.samples":
            samples = CONVERGED_SAMPLES
        steps = 1
        if setting.factor == "sweep.diameters.num":
            finest = FINER * (self._config.sweep.diameters.num - 1)
            steps, num = finest // (num - 1), finest + 1
        converged = strongest_slopes(self._sampled(num, samples), self.spectra(num, samples))
        return converged[::steps]

    def _sampled(self, num: int, samples: int) -> Config:
        return changed(
            self._config,
            {"sweep": {"diameters": {"num": num}}, "spectrum": {"samples": samples}},
        )


def errors_of(setting: Setting, intensity: Array, exact: ReferenceSweep) -> Errors:
    """Return how far spectra (D, K) of a setting are from the limit of its scheme."""
    config = setting.config
    spectra = exact.spectra(config.sweep.diameters.num, config.spectrum.samples)
    off = intensity_errors(intensity, spectra[:: setting.every])
    asked = config.tracing.accuracy if scheme_of(config).controls_error else np.inf
    errors = Errors(float(off.max()), float(np.median(off)), int((off > asked).sum()))
    if setting.every > 1:
        return errors
    slope_off = strongest_slopes(config, intensity) - exact.slopes(setting)
    return errors._replace(
        phase_slope_rms_error=float(np.sqrt(np.mean(slope_off**2))),
        phase_slope_largest_error=float(np.abs(slope_off).max()),
    )


def maxwell_errors_of(
    setting: Setting, intensity: Array, exact: ReferenceSweep | None
) -> MaxwellErrors:
    """Return how far spectra (D, K) of a setting are from Maxwell's equations.

    Fewer diameters or wavenumbers say nothing of those, and have no such error.
    """
    if exact is None or not is_of_the_trade(setting):
        return MaxwellErrors()
    config = setting.config
    spectra = exact.spectra(config.sweep.diameters.num, config.spectrum.samples)
    off = shape_errors(intensity, spectra[:: setting.every])
    errors = MaxwellErrors(float(off.max()), float(np.median(off)))
    if setting.every > 1:
        return errors
    slope_off = strongest_slopes(config, intensity) - exact.slopes(setting)
    return errors._replace(
        maxwell_slope_rms_error=float(np.sqrt(np.mean(slope_off**2))),
        maxwell_slope_largest_error=float(np.abs(slope_off).max()),
        maxwell_slope_bias=float(slope_off.mean()),
    )
