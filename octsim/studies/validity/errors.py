"""What is compared of a diameter's spectra: slopes, phase, visibility and shape."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.processing import Processing
from octsim.instrument.instrument import Instrument
from octsim.phase.derivatives import wrapped
from octsim.phase.estimators.sinusoid import fit_sinusoid
from octsim.phase.estimators.visible import fringe_at
from octsim.phase.fringe_status import WITH_PHASE, FringeStatus
from octsim.phase.hiding_error import hiding_error
from octsim.phase.local_slopes import local_slope
from octsim.schemes.light import AccuracyStatus

Array = NDArray[np.float64]
FOCUS_MODES = ("follows", "held")
"""Whether the focus moves with the diameter by the law, or stays where it is."""
ESTIMATORS = ("fft", "sinusoid")


class Window(NamedTuple):
    """Three diameters, each at two foci, µm."""

    diameter: Array
    """(3,), the middle one is what a slope is of."""
    foci: Array
    """(2, 3), by `FOCUS_MODES`; the middle ones are the same."""


class Seen(NamedTuple):
    """What a scheme sees at a diameter."""

    slope: Array
    """By `FOCUS_MODES` and `ESTIMATORS`, (2, 2), mrad/nm."""
    phase: float
    """At the middle of the band, of the sinusoid, rad."""
    visibility: float
    """Its amplitude over its offset there."""
    shape: Array
    """Spectrum over its mean, (K,)."""
    error: float
    """The largest of the spectra's estimated errors."""
    fringe: FringeStatus
    """Whether the middle one's spectrum has a fringe; all of the above but the shape is NaN where
    not."""
    status: AccuracyStatus
    """Of the spectrum that is farthest from as asked."""


def by_estimator(processing: Processing, estimator: str) -> Processing:
    """Return a processing with another estimator, at the nominal depth of each diameter."""
    update = {"estimator": estimator, "depth": "nominal"}
    return processing.model_copy(update=update)


def seen(instrument: Instrument, window: Window) -> Seen:
    """Return what an instrument sees in a window of diameters."""
    k, power = instrument.wavenumber, instrument.power
    processing = instrument.config.processing
    index = instrument.config.swept_group_index
    points = {
        (diameter, focus): instrument.spectrum(diameter, focus)
        # the foci of a diameter one after the other: they share what is kept of it
        for diameter, foci in zip(window.diameter.tolist(), window.foci.T.tolist(), strict=True)
        for focus in foci
    }
    series = [
        np.stack([points[at].intensity for at in zip(window.diameter.tolist(), foci, strict=True)])
        for foci in window.foci.tolist()
    ]
    middle, depth = series[0][1:2], index * window.diameter[1:2]
    worst = max(points.values(), key=lambda point: point.status)
    error = max(point.error for point in points.values())
    hiding = hiding_error(np.array([error]), np.array([worst.status]))
    fringe = FringeStatus(int(fringe_at(middle, k, depth, hiding, power).status[0]))
    if fringe not in WITH_PHASE:
        shape = middle[0] / middle[0].mean()
        return Seen(np.full((2, 2), np.nan), np.nan, np.nan, shape, error, fringe, worst.status)
    slope = [
        [
            local_slope(spectra, k, window.diameter, index, by_estimator(processing, name), power)
            for name in ESTIMATORS
        ]
        for spectra in series
    ]
    ((_, fit),) = fit_sinusoid(middle, k, depth, by_estimator(processing, "sinusoid"), power)
    return Seen(
        np.array(slope), float(fit.phase[0]), float(np.abs(fit.amplitude[0, 0]) / fit.offset[0, 0]),
        middle[0] / middle[0].mean(), error, fringe, worst.status,
    )  # fmt: skip


def differences(rays: Seen, exact: Seen) -> dict[str, Array]:
    """Return how far rays are off: of the slope, the visibility and the shape relative errors."""
    return {
        "ray_phase_slope": rays.slope,
        "ray_slope_error": rays.slope / exact.slope - 1,
        "ray_phase_error": np.asarray(wrapped(np.asarray(rays.phase - exact.phase))),
        "ray_visibility_error": np.asarray(rays.visibility / exact.visibility - 1),
        "ray_spectrum_error": np.sqrt(((rays.shape - exact.shape) ** 2).mean()),
    }
