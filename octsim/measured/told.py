"""What was understood of a lab's files, a line each; what is doubtful begins with `warning: `."""

from collections.abc import Iterator

import numpy as np

from octsim.config.measured import SUBTRACTED
from octsim.config.models import Config
from octsim.measured.axis import taken
from octsim.measured.full_scale import saturated
from octsim.measured.recording import Recording
from octsim.measured.setup import FIRST, Setup
from octsim.phase.estimators.one_fit import left_over_fringe

_DIM = 0.01
"""Of the source's largest power, below which a sample says next to nothing."""
_LEFT = 0.1
"""Of the fringe, left by the fit, from which the mean spectrum is said to be another."""
_SURE = 5.0
"""Standard errors by which a level is below none."""
_MOST = 1.05
"""Visibility above 1 by more than a fit's own error."""
_FAR = 0.25
"""Of an oscillation over the band, from which a fringe is elsewhere than at its nominal depth."""


def understood(config: Config, recording: Recording, setup: Setup) -> list[str]:
    """Return what was taken for what, and what it comes to."""
    return [*recording.understood, *_told(config, recording, setup), *_doubted(config, setup)]


def _told(config: Config, recording: Recording, setup: Setup) -> Iterator[str]:
    band, fringe = setup.band, setup.fringe
    whole = 2 * np.pi / setup.wavenumber
    yield (
        f"{setup.spectra} spectra of {setup.wavenumber.size} samples, {1e3 * whole.min():.6g} to "
        f"{1e3 * whole.max():.6g} nm, over {setup.time[-1]:.6g} s"
    )
    yield (
        f"fitted from {1e3 * band.wavelength.min():.6g} to {1e3 * band.wavelength.max():.6g} nm, "
        f"{band.sample.size} samples"
    )
    if setup.dark is not None:
        yield f"dark: {setup.dark.spectra} spectra, mean level {setup.dark.value.mean():.4g} counts"
    if config.measured.dark == SUBTRACTED:
        yield "dark: subtracted before"
    yield f"source: {_SOURCES[setup.source_from]}"
    full = "not known" if np.isinf(setup.full_scale) else f"{setup.full_scale:g} counts"
    count = int(
        (
            saturated(taken(np.asarray(recording.counts[:FIRST]), band.sample), setup.full_scale)
            > 0
        ).sum()
    )
    yield f"full scale: {full}; {count} of the first {min(FIRST, setup.spectra)} spectra reach it"
    per_count = setup.noise.per_count
    photons = f"{1 / per_count:.3g} photoelectrons a count" if per_count > 0 else "no shot noise"
    yield f"noise: {photons}, {np.sqrt(setup.noise.read_variance):.3g} counts without light"
    oscillations = setup.model.depth * np.ptp(band.wavenumber) / np.pi
    yield (
        f"fringe at {setup.model.depth:.5g} um, {oscillations:.3g} oscillations over the band; of "
        f"the mean spectrum at {setup.measured_depth:.5g} um, visibility "
        f"{float(fringe.visibility[0]):.3g}, {float(fringe.snr[0]):.3g} dB, residual "
        f"{float(fringe.residual[0]):.3g} counts, "
        f"{left_over_fringe(setup.design, setup.mean):.2g} of the fringe"
    )
    if config.measured.dispersion == "fit":
        yield "dispersion: a2 {:+.4g} rad, a3 {:+.4g} rad at the band's edge".format(
            *setup.dispersion
        )


_SOURCES = {
    "reference": "measured.reference", "config": "spectrum.source",
    "none": "none given, taken for flat",
}  # fmt: skip


def _doubted(config: Config, setup: Setup) -> Iterator[str]:
    if setup.source_from == "none":
        yield (
            "warning: measured.reference: not given, and spectrum.source is flat, so the source's "
            "own shape is taken for the sample's: phases and their changes can be far off; give "
            "the source's spectrum"
        )
    elif setup.source_from == "reference" and config.spectrum.source == "flat":
        yield (
            "warning: spectrum.source: flat, so a calibration is of another source than these "
            "spectra; give it the file that `octsim import --source source.csv` writes"
        )
    if not setup.noise.per_count and not setup.noise.read_variance:
        yield (
            "warning: measured.spectra: the spectra do not scatter, so the noise is not known, and "
            "neither are the errors of phases; give them as they were recorded"
        )
    if setup.reference is not None and setup.reference.spectra == 1:
        yield (
            "warning: measured.reference: one spectrum given, whose noise is not known and not in "
            "chain_error; give several"
        )
    if config.measured.dark is None:
        yield (
            "warning: measured.dark: not given, so the camera's level without light counts as "
            f"light; give spectra of a closed shutter, or {SUBTRACTED} if it was before"
        )
    yield from _wrong_levels(setup)
    apart = abs(setup.measured_depth - setup.model.depth)
    if apart * np.ptp(setup.band.wavenumber) / np.pi > _FAR:
        yield (
            f"warning: the mean spectrum's fringe is at {setup.measured_depth:.4g} um, not "
            f"at {setup.model.depth:.4g} um; check expansion.diameter, the neuron's index and the "
            "wavelengths"
        )
    if config.processing.sinusoid.weights == "equal" and setup.source is not None:
        dim = float((setup.source < _DIM).mean())
        yield (
            "warning: processing.sinusoid.weights: equal, though samples differ in brightness"
            f"{f' and {dim:.0%} hold hardly any light' if dim > _DIM else ''}; give shot, for "
            "phases that are known better"
        )


def _wrong_levels(setup: Setup) -> Iterator[str]:
    """Say if the mean spectrum is no fringe of the source on light of the source."""
    known = setup.source_from != "none"
    if known and (share := left_over_fringe(setup.design, setup.mean)) > _LEFT:
        yield (
            f"warning: the fit leaves {share:.0%} of the mean fringe, where octsim's own spectra "
            "leave a few %: wavelengths may be off or reversed, the dark or the source of other "
            "spectra, or another surface reflects"
        )
    error = np.sqrt(setup.variance / min(FIRST, setup.spectra))
    if setup.dark is not None:
        error = error + np.nan_to_num(setup.dark.error)
    below = setup.mean < -_SURE * error
    if below.any():
        at = int(np.argmin(setup.mean))
        yield (
            f"warning: measured.dark: above the mean spectrum at {below.sum()} samples, by up to "
            f"{-setup.mean[at]:.3g} counts at {1e3 * setup.band.wavelength[at]:.6g} nm; it may "
            "have been subtracted before, or be of another exposure"
        )
    if known and setup.source_from == "reference" and float(setup.fringe.visibility[0]) > _MOST:
        yield (
            f"warning: visibility {float(setup.fringe.visibility[0]):.3g}, and no light has more "
            "than 1; look whether the dark is that of these spectra, subtracted once"
        )
