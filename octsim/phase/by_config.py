"""Phases of a run's spectra and of measured ones, by the estimator that the config names."""

import warnings
from collections.abc import Callable
from operator import attrgetter
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import ConfigError, DatasetError, OctsimWarning
from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.config.source import FAINTEST
from octsim.config.units import format_length
from octsim.optics.source import MeasuredSource, Source
from octsim.optics.two_beams import predicted_phase_slope
from octsim.phase.cut_samples import are_cut
from octsim.phase.estimators import estimate, phases
from octsim.phase.estimators.estimate import Array, Estimate, Phases
from octsim.phase.estimators.likelihood import maximum_likelihood
from octsim.phase.estimators.visible import unusable
from octsim.phase.fringe_status import FringeStatus, doubts_of
from octsim.phase.lone_samples import lone
from octsim.phase.measured_spectra import Raw, even, read_raw

BEST = Processing.model_validate(
    {"estimator": "sinusoid", "depth": "peak", "sinusoid": {"depth": "fitted", "weights": "shot"}}
)
"""What measured spectra are processed by, unless something else is asked for."""


_OUTLYING = 1e6
_NEARLY_ALL = 0.99

EstimatorOf = Callable[[Array, Array], Phases]
"""From spectra (D, K) and their diameters (D,), µm, to phases; each spectrum by itself."""


def estimator_of(config: Config, foci: Array) -> EstimatorOf:
    """Make a run's ``processing.estimator``, which works on any of the sweep's spectra.

    Those that know a diameter and no phase give the depth of that diameter, and the phase that the
    thesis's prediction has for it: the slope of that is predicted_phase_slope · ∂d̂/∂d. Of fft,
    whose phases are its components', all is NaN, as it is without a focus.

    Parameters
    ----------
    config : Config
        The run, at one combination of its grid.
    foci : ndarray
        Foci of all of the sweep's diameters, µm; NaN where there is no law.
    """
    processing, k = config.processing, config.spectrum.wavenumbers()
    index = config.swept_group_index
    if processing.estimator == "fft" or np.isnan(foci).any():
        return lambda _, diameter: Phases(*np.full((2, diameter.size), np.nan))
    if processing.estimator != "maximum_likelihood":
        power = config.spectrum.power()
        return lambda spectra, diameter: phases(spectra, k, index * diameter, processing, power)
    # here, as a run of any other estimator needs no tracing any more
    from octsim.phase.modelled_spectra import model_of_sweep

    model = model_of_sweep(config, foci)
    predicted = predicted_phase_slope(config.swept_material, k[0], k[-1])

    def likeliest(spectra: Array, _: Array) -> Phases:
        found = maximum_likelihood(spectra, model, processing.read_noise)
        return Phases(predicted * found, index * found)

    return likeliest


def ideal_phases(config: Config, spectra: Array, diameter: Array, wavenumber: Array) -> Array:
    """Estimate the phases (D,) of ideal spectra cos(2ndk), (D, K).

    They are those of 1 − cos(2ndk), half a turn away: of opposite reflections, from whose phase a
    fringe's order is counted; NaN where they are not resolved. Maximum likelihood, whose model they
    are not, has the prediction's.
    """
    processing = config.processing
    if processing.estimator == "maximum_likelihood":
        slope = predicted_phase_slope(config.swept_material, wavenumber[0], wavenumber[-1])
        return slope * diameter
    depth, found = config.swept_group_index * diameter, np.full(diameter.size, np.nan)
    resolved = unusable(spectra, wavenumber, depth) != FringeStatus.NOT_RESOLVED
    power = config.spectrum.power()
    if resolved.any():
        opposite = 1 - spectra[resolved]
        found[resolved] = phases(
            opposite if power is None else opposite * power,
            wavenumber, depth[resolved], processing, power,
        ).phase  # fmt: skip
    return found


def phase_of(
    source: str | Path | xr.Dataset,
    processing: Processing | None = None,
    nominal_depth: float | None = None,
    reference: str | Path | xr.Dataset | Source | None = None,
    band: tuple[float, float] | None = None,
) -> Estimate:
    """Estimate the phases of measured spectra.

    Parameters
    ----------
    source : path or Dataset
        Spectra as `octsim.phase.measured_spectra.read_spectra` takes them.
    processing : Processing, optional
        Which estimator, with which options; else the best phase of `snakemake estimators`, a
        sinusoid whose depth is fitted from the highest peak on.
    nominal_depth : float, optional
        Optical depth n_neuron · diameter (µm) of all spectra, for ``depth: nominal``.
    reference : path, Dataset or Source, optional
        The source's own spectrum, without the dark: spectra, whose mean is taken, as of `source`,
        or what has a method ``power(wavenumber)``. The fit is shaped by it, and nothing is divided
        by it; without it the source is taken for flat.
    band : tuple of float, optional
        Shortest and longest wavelength, µm, of the samples that are used, as those of the
        calibration; else all are.

    Returns
    -------
    Estimate
        Phase at the middle of the band (rad, wrapped) and optical depth (µm) of each spectrum, and
        how well they are known; NaN where there is no fringe.

    Warns
    -----
    OctsimWarning
        If the status of a spectrum is other than visible: a line for each status, with its remedy.
        If samples stand alone (`octsim.phase.lone_samples.lone`).

    Raises
    ------
    ConfigError
        If the processing needs a nominal depth that is not given, or modelled spectra.
    FileError, DatasetError
        If the spectra can't be read or used, or the reference does not span their band.

    Examples
    --------
    >>> import numpy as np, octsim, xarray as xr
    >>> k = np.linspace(7, 9.7, 500)
    >>> spectra = xr.Dataset(
    ...     {"intensity": ("wavenumber", 2 + np.cos(2 * 1.9 * (k - k.mean()) + 0.3))},
    ...     {"wavenumber": ("wavenumber", k, {"units": "um-1"})},
    ... )
    >>> octsim.phase_of(spectra).phase.round(6).tolist()
    [0.3]
    """
    processing = BEST if processing is None else processing
    if processing.estimator == "maximum_likelihood":
        raise ConfigError(
            "processing.estimator: 'maximum_likelihood' given, which compares with modelled "
            "spectra; use octsim.phase.modelled_spectra.model_of_sweep and "
            "octsim.phase.estimators.likelihood.maximum_likelihood"
        )
    if processing.estimator != "fft" and processing.depth == "nominal" and nominal_depth is None:
        raise ConfigError(
            "processing.depth: 'nominal' given, but measured spectra have no diameter; give "
            "'peak' or a length, or pass nominal_depth"
        )
    raw = read_raw(source)
    if band is not None:
        raw = _within(raw, *band)
    intensity, k = even(*raw)  # which refuses what is not finite
    require_sensible(raw)
    cut = are_cut(np.asarray(raw.intensity, float))  # before they were interpolated
    nominal = np.full(intensity.shape[0], np.nan if nominal_depth is None else nominal_depth)
    power = None if reference is None else _power(reference, k)
    found = estimate(intensity, k, nominal, processing, cut, power)
    remedy = attrgetter("measured_remedy" if power is None else "lit_remedy")
    for doubt in (
        *doubts_of(found.status, "spectra", remedy),
        *_lone(raw, cut),
    ):
        warnings.warn(f"phase_of: {doubt}", OctsimWarning, stacklevel=2)
    return found


def _within(raw: Raw, shortest: float, longest: float) -> Raw:
    """Return the samples of spectra within a band, µm.

    Raises
    ------
    ConfigError
        If the spectra do not reach over it.
    """
    wavelength = 2 * np.pi / raw.wavenumber
    inside = (wavelength >= shortest) & (wavelength <= longest)
    spacing = np.abs(np.diff(wavelength)).max()
    if shortest < wavelength.min() - spacing or longest > wavelength.max() + spacing:
        raise ConfigError(
            f"band: {format_length(shortest)} to {format_length(longest)} given, but {raw.name} "
            f"has {format_length(float(wavelength.min()))} to "
            f"{format_length(float(wavelength.max()))}; give a band within that, in um"
        )
    return Raw(raw.wavenumber[inside], np.asarray(raw.intensity)[:, inside], raw.name)


def _power(reference: str | Path | xr.Dataset | Source, wavenumber: Array) -> Array:
    """Return the power at wavenumbers (K,) of a source that was measured, over its largest.

    Raises
    ------
    DatasetError
        If it can't be read, has no light, or does not span the wavenumbers.
    """
    if not isinstance(reference, str | Path | xr.Dataset):
        return reference.power(wavenumber)
    power, k = even(*(raw := read_raw(reference)))
    mean = power.mean(axis=0)
    if mean.max() <= 0 or mean.min() < -FAINTEST * mean.max():
        raise DatasetError(
            f"reference: {raw.name} has powers from {mean.min():.4g} to {mean.max():.4g}; give the "
            "source's spectrum with the dark subtracted, once"
        )
    wavelength = 2 * np.pi / k[::-1]
    rows = np.maximum(mean[::-1], 0.0)
    try:
        return MeasuredSource(tuple(wavelength.tolist()), tuple(rows.tolist())).power(wavenumber)
    except ValueError as error:
        raise DatasetError(f"reference: {error}; give one that spans the spectra") from None


def _lone(raw: Raw, cut: NDArray[np.bool_]) -> list[str]:
    """Say in a line which samples stand alone, of spectra (D,) that are not cut."""
    intensity = np.asarray(raw.intensity, float)
    marked = np.array([lone(one) for one in intensity]) & ~cut[:, np.newaxis]
    if not marked.any():
        return []
    spectrum, sample = np.argwhere(marked)[0]
    wavelength = 2e3 * np.pi / raw.wavenumber[sample]
    return [
        f"{marked.sum()} samples stand alone, the first {intensity[spectrum, sample]:.4g} in "
        f"spectrum {spectrum} at {wavelength:.6g} nm, and move the phase; mend them, or leave that "
        "wavelength out"
    ]


def require_sensible(raw: Raw) -> None:
    """Refuse spectra with values that no detector gives.

    Raises
    ------
    DatasetError
        If a value is 1e6 times above nearly all others of its spectrum.
    """
    size = np.abs(np.asarray(raw.intensity, float))
    usual = np.quantile(size, _NEARLY_ALL, axis=1, keepdims=True)
    bad = (size > _OUTLYING * usual) & (usual > 0)
    if bad.any():
        spectrum, sample = np.argwhere(bad)[0]
        raise DatasetError(
            f"{raw.name}: intensity of {raw.intensity[spectrum, sample]:.4g} in spectrum "
            f"{spectrum}, sample {sample}, and {bad.sum() - 1} more like it, where "
            f"{_NEARLY_ALL:.0%} of the spectrum are below {float(usual[spectrum, 0]):.4g}; mend "
            "them or leave them out"
        )
