"""The part of the config that says how a spectrum becomes a phase."""

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag

from octsim.config.fields import Number, PositiveLength, Section, as_tuple, key

Window = Literal[
    "barthann", "bartlett", "blackman", "blackmanharris", "bohman", "boxcar", "cosine",
    "flattop", "hamming", "hann", "lanczos", "nuttall", "parzen", "taylor", "triang", "tukey",
]  # fmt: skip


def _is_made(value: tuple[str | float, ...]) -> tuple[str | float, ...]:
    # here, as it takes half a second to import and few windows have parameters
    import numpy as np
    from scipy.signal import get_window

    try:
        if np.isfinite(get_window(value, 64, fftbins=False)).all():
            return value
    except (ValueError, TypeError, ArithmeticError, IndexError) as error:
        raise ValueError(f"scipy.signal has no such window: {error}") from None
    raise ValueError("scipy.signal makes that window of values that are not finite")


ParametricWindow = Annotated[
    tuple[str | float, ...],
    Field(max_length=10),
    BeforeValidator(as_tuple),
    AfterValidator(_is_made),
]


def _depth_kind(value: object) -> str:
    # a length has digits
    return "name" if isinstance(value, str) and value.isalpha() else "length"


def _window_kind(value: object) -> str:
    return "parametric" if isinstance(value, list | tuple) else "plain"


Degree = Annotated[int, Field(ge=0, le=8)]


class Sinusoid(Section):
    """The least-squares sinusoid: I = offset(k) + amplitude(k) · cos(2 z (k − k_mid) + phase)."""

    offset_degree: Degree = key(1, "of the polynomial below the oscillation")
    amplitude_degree: Degree = key(1, "of the polynomial that its amplitude is")
    depth: Literal["held", "fitted"] = key(
        "held", "held at processing.depth, or fitted from there by variable projection"
    )
    weights: Literal["equal", "shot"] = key(
        "equal", "of a sample: the same for all, or one over its fitted intensity (and read noise)"
    )
    envelope: Literal["each", "common"] = key(
        "each", "polynomials of each spectrum, or of the mean of a series at one diameter"
    )


class Hilbert(Section):
    """The phase of the analytic signal: Fourier transform, band, inverse transform."""

    band: Annotated[Number, Field(ge=0.1, le=1)] = key(
        0.5, "half width of the band of depths that is kept, over the depth"
    )


class Esprit(Section):
    """ESPRIT: the spectrum as a sum of exponentials, one of them the oscillation."""

    poles: Annotated[int, Field(ge=3, le=15)] = key(
        3, "number of exponentials; 3 are a real offset and the oscillation's two"
    )


PhaseEstimator = Literal["fft", "zero_padded", "sinusoid", "hilbert", "esprit", "fringe"]
"""Those that need spectra alone."""


class Processing(Section):
    """From a spectrum to a phase."""

    estimator: Literal[PhaseEstimator, "maximum_likelihood"] = key(
        "fft", "of the phase, or of the diameter; fft is the thesis's Fourier transform"
    )
    centre: Literal["midpoint", "mean", "weighted", "polynomial"] = key(
        "midpoint",
        "what is subtracted before the window: (max + min)/2, the mean, the mean weighted by the "
        "window, or a polynomial fitted with these weights",
    )
    centre_degree: Degree = key(1, "of the polynomial, where that is the centre")
    window: Annotated[
        Annotated[Window, Tag("plain")] | Annotated[ParametricWindow, Tag("parametric")],
        Discriminator(_window_kind),
    ] = key(
        "hamming",
        "a symmetric window of scipy.signal.windows; with its parameters as [kaiser, 8.6]",
    )
    depth: Annotated[
        Annotated[Literal["nominal", "peak"], Tag("name")]
        | Annotated[PositiveLength, Tag("length")],
        Discriminator(_depth_kind),
    ] = key(
        "nominal",
        "optical depth z at which the phase is looked for, by all but fft: n_neuron · diameter, "
        "the highest peak of each spectrum's zero-padded transform, or a length",
    )
    read_noise: Annotated[Number, Field(ge=0, le=1e12)] = key(
        0.0, "standard deviation of a dark sample, where spectra are counts of photons"
    )
    sinusoid: Sinusoid = Sinusoid()
    hilbert: Hilbert = Hilbert()
    esprit: Esprit = Esprit()


OPTIONS: Mapping[str, tuple[str, ...]] = {
    "fft": (),
    "zero_padded": ("depth",),
    "sinusoid": ("depth", "read_noise", *(f"sinusoid.{name}" for name in Sinusoid.model_fields)),
    "hilbert": ("depth", "hilbert.band"),
    "esprit": ("depth", "esprit.poles"),
    "fringe": ("depth",),
    "maximum_likelihood": ("read_noise",),
}
"""What each estimator reads besides the centre and the window, which the Fourier transform has."""


def options_read(processing: Processing) -> set[str]:
    """Return the options, of those that not every processing reads, that one reads."""
    read = set(OPTIONS[processing.estimator])
    if processing.estimator == "sinusoid" and processing.sinusoid.weights == "equal":
        read.discard("read_noise")
    if processing.centre == "polynomial":
        read.add("centre_degree")
    return read
