"""The config: what a user may set, its defaults (the thesis) and its limits.

The models are the one source: `config/schema.json` and `docs/config.md` are generated from them,
`config/default.yaml` is tested against them.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
)

from octsim.units import Length


def _number(value: object) -> object:
    # YAML 1.1 reads 1e-6 (no dot) as text; what is plainly a number in that notation is one.
    if isinstance(value, str) and ("e" in value or "E" in value):
        try:
            return float(value)
        except ValueError:
            return value
    return value


Number = Annotated[float, BeforeValidator(_number), Field(allow_inf_nan=False)]
PositiveLength = Annotated[Length, Field(ge=1e-6, le=1e6)]  # 1 pm to 1 m
Position = Annotated[Length, Field(ge=-1e6, le=1e6)]
Wavelength = Annotated[Length, Field(ge=1e-3, le=1e3)]  # 1 nm to 1 mm
PositiveNumber = Annotated[Number, Field(ge=1e-6, le=1e6)]
Index = Annotated[Number, Field(ge=1, le=10)]


class Section(BaseModel):
    """A part of the config: frozen, with no room for keys that it does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, validate_default=True)


class Range(Section):
    """Evenly spaced values, both ends included; start is below stop."""

    start: float
    stop: float
    num: Annotated[int, Field(ge=2, le=1_000_000)]

    def values(self) -> NDArray[np.float64]:
        """Give the values, shape (num,), in µm where they are lengths."""
        return np.linspace(self.start, self.stop, self.num)


class FocusRange(Range):
    """Evenly spaced heights of the focus."""

    start: Position
    stop: Position


class DiameterRange(Range):
    """Evenly spaced diameters."""

    start: PositiveLength
    stop: PositiveLength


class FractionRange(Range):
    """Evenly spaced fractions of a diameter, enough to fit a Gaussian plus a constant over."""

    start: Annotated[Number, Field(ge=-1e6, le=1e6)]
    stop: Annotated[Number, Field(ge=-1e6, le=1e6)]
    num: Annotated[int, Field(ge=4, le=1_000_000)]


def _key(default: object, description: str) -> Any:
    # typed Any: a default is written as a user would write it, "5 nm", and validated
    return Field(default, description=description)


class RefractiveIndex(Section):
    """Refractive indices of the three media."""

    glass: Index = _key(1.52, "slide and immersion oil")
    water: Index = _key(1.33, "around the neuron")
    neuron: Index = _key(1.39, "the cylinder")


class SceneConfig(Section):
    """What the light meets: a cylinder over a glass slide, in water."""

    refractive_index: RefractiveIndex = RefractiveIndex()
    gap: Annotated[Length, Field(ge=0, le=1e6)] = _key(
        "5 nm", "water between the glass and the neuron"
    )


class Objective(Section):
    """The objective lens, an ideal thin one."""

    numerical_aperture: PositiveNumber = _key(1.2, "below the index of glass")
    focus_distance: PositiveLength = _key(
        "300 um", "from the objective plane to the focus; beyond every focus"
    )
    magnification: PositiveNumber = _key(20.0, "object to fibre")


class DetectorConfig(Section):
    """The fibre that collects the light."""

    core_diameter: PositiveLength = _key(
        "4.4 um", "of the fibre; R_det = core_diameter / (2 magnification)"
    )


PRESETS: Mapping[str, Mapping[str, Any]] = {
    "draft": {"scheme": "paths", "accuracy": 3e-2},
    "standard": {"scheme": "paths", "accuracy": 1e-4},
    "reference": {"scheme": "paths", "accuracy": 1e-8},
}
"""Points of the trade of cost for accuracy: `snakemake tradeoff` measures them."""


class Tracing(Section):
    """How rays are placed and how far each is followed."""

    preset: Literal["draft", "standard", "reference"] | None = _key(
        None, "a named scheme and accuracy, for those that are not given beside it"
    )
    scheme: Literal["vogel", "paths"] = _key(
        "vogel", "the thesis's sunflower spiral, or each light path to a stated accuracy"
    )
    accuracy: Annotated[Number, Field(ge=1e-12, le=0.1)] = _key(
        1e-4, "of the scheme paths: largest error of the intensity over the largest intensity"
    )
    rays: Annotated[int, Field(ge=1, le=10_000_000)] = _key(3000, "at the objective")
    max_intersections: Annotated[int, Field(ge=1, le=30)] = _key(
        11, "meetings with the plane and the cylinder on one ray"
    )
    min_amplitude: Annotated[Number, Field(ge=0, lt=1)] = _key(
        0.0, "a fainter ray is dropped; relative to the launch amplitude; of the scheme vogel"
    )


class Wavelengths(Section):
    """The band, in vacuum."""

    min: Wavelength = _key("650 nm", "shortest wavelength")
    max: Wavelength = _key("900 nm", "longest wavelength")


class Spectrum(Section):
    """The flat spectrum of the source and the samples taken of it."""

    wavelength: Wavelengths = Wavelengths()
    samples: Annotated[int, Field(ge=2, le=1_000_000)] = _key(
        1000, "wavenumbers, evenly spaced, both ends included"
    )


class FocusScan(Section):
    """Figure 6: one diameter, many foci."""

    diameter: PositiveLength = _key("2 um", "of the cylinder")
    focus: FocusRange = _key(
        {"start": "-1 um", "stop": "4 um", "num": 501},
        "height of the focus above the glass",
    )


class FocusLawConfig(Section):
    """Figure 7: the focus of greatest intensity for some diameters, and the line through them."""

    diameters: DiameterRange = _key(
        {"start": "0.8 um", "stop": "2.4 um", "num": 9}, "of the cylinder"
    )
    fraction: FractionRange = _key(
        {"start": 0.4, "stop": 0.8, "num": 41},
        "foci tried, as fractions of the diameter",
    )


class FocusLine(Section):
    """A given focus law: focus = slope · diameter + intercept; slope 0 is a fixed focus."""

    slope: Annotated[Number, Field(ge=-1e6, le=1e6)]
    intercept: Position

    @classmethod
    def fitted(cls, law: Any) -> "FocusLine":
        """Give the line of a fitted law: a `focus_law` dataset."""
        return cls.model_construct(slope=float(law["slope"]), intercept=float(law["intercept"]))

    def at(self, diameter: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give the focus for each diameter, both in µm."""
        return self.slope * diameter + self.intercept


def _focus_kind(value: object) -> str:
    return "line" if isinstance(value, Mapping | FocusLine) else "law"


class Sweep(Section):
    """Figures 8 to 12: the diameters whose spectra are made."""

    diameters: DiameterRange = _key(
        {"start": "1 um", "stop": "2 um", "num": 151}, "of the cylinder"
    )
    focus: Annotated[
        Annotated[Literal["law"], Tag("law")] | Annotated[FocusLine, Tag("line")],
        Discriminator(_focus_kind),
    ] = _key("law", "law (the fitted one), or {slope: 0.581, intercept: 69 nm}")


Window = Literal[
    "barthann", "bartlett", "blackman", "blackmanharris", "bohman", "boxcar", "cosine",
    "flattop", "hamming", "hann", "lanczos", "nuttall", "parzen", "taylor", "triang", "tukey",
]  # fmt: skip


def _window(value: object) -> object:
    # YAML and JSON know lists; a tuple can't be changed
    return tuple(value) if isinstance(value, list) else value


def _is_made(value: tuple[str | float, ...]) -> tuple[str | float, ...]:
    # here, as it takes half a second to import and few windows have parameters
    from scipy.signal import get_window

    try:
        if np.isfinite(get_window(value, 64, fftbins=False)).all():
            return value
    except (ValueError, TypeError, ArithmeticError) as error:
        raise ValueError(f"scipy.signal has no such window: {error}") from None
    raise ValueError("scipy.signal makes that window of values that are not finite")


ParametricWindow = Annotated[
    tuple[str | float, ...], BeforeValidator(_window), AfterValidator(_is_made)
]


def _depth_kind(value: object) -> str:
    # a length has digits
    return "name" if isinstance(value, str) and value.isalpha() else "length"


def _window_kind(value: object) -> str:
    return "parametric" if isinstance(value, list | tuple) else "plain"


Degree = Annotated[int, Field(ge=0, le=8)]


class Sinusoid(Section):
    """The least-squares sinusoid: I = offset(k) + amplitude(k) · cos(2 z (k − k_mid) + phase)."""

    offset_degree: Degree = _key(1, "of the polynomial below the oscillation")
    amplitude_degree: Degree = _key(1, "of the polynomial that its amplitude is")
    depth: Literal["held", "fitted"] = _key(
        "held", "held at processing.depth, or fitted from there by variable projection"
    )
    weights: Literal["shot", "equal"] = _key(
        "shot", "of a sample: one over its fitted intensity (and read noise), or the same for all"
    )
    envelope: Literal["each", "common"] = _key(
        "each", "polynomials of each spectrum, or of the mean of a series at one diameter"
    )


class Hilbert(Section):
    """The phase of the analytic signal: Fourier transform, band, inverse transform."""

    band: Annotated[Number, Field(gt=0, le=1)] = _key(
        0.5, "half width of the band of depths that is kept, over the depth"
    )


class Esprit(Section):
    """ESPRIT: the spectrum as a sum of exponentials, one of them the oscillation."""

    poles: Annotated[int, Field(ge=3, le=15)] = _key(
        3, "number of exponentials; 3 are a real offset and the oscillation's two"
    )


class Processing(Section):
    """From a spectrum to a phase."""

    estimator: Literal[
        "fft", "zero_padded", "sinusoid", "hilbert", "esprit", "fringe", "maximum_likelihood"
    ] = _key("fft", "of the phase, or of the diameter; fft is the thesis's Fourier transform")
    centre: Literal["midpoint", "mean", "weighted", "polynomial"] = _key(
        "midpoint",
        "what is subtracted before the window: (max + min)/2, the mean, the mean weighted by the "
        "window, or a polynomial fitted with these weights",
    )
    centre_degree: Degree = _key(1, "of the polynomial, where that is the centre")
    window: Annotated[
        Annotated[Window, Tag("plain")] | Annotated[ParametricWindow, Tag("parametric")],
        Discriminator(_window_kind),
    ] = _key(
        "hamming",
        "a symmetric window of scipy.signal.windows; with its parameters as [kaiser, 8.6]",
    )
    depth: Annotated[
        Annotated[Literal["nominal", "peak"], Tag("name")]
        | Annotated[PositiveLength, Tag("length")],
        Discriminator(_depth_kind),
    ] = _key(
        "nominal",
        "optical depth z at which the phase is looked for, by all but fft: n_neuron · diameter, "
        "the highest peak of each spectrum's zero-padded transform, or a length",
    )
    read_noise: Annotated[Number, Field(ge=0, le=1e12)] = _key(
        0.0, "standard deviation of a dark sample, where spectra are counts of photons"
    )
    sinusoid: Sinusoid = Sinusoid()
    hilbert: Hilbert = Hilbert()
    esprit: Esprit = Esprit()


class Config(Section):
    """A whole run. Every value has the thesis's as its default."""

    run: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$", max_length=100)] = _key(
        "thesis", "name of the run: datasets and figures go to results/<run>/"
    )
    scene: SceneConfig = SceneConfig()
    objective: Objective = Objective()
    detector: DetectorConfig = DetectorConfig()
    tracing: Tracing = Tracing()
    spectrum: Spectrum = Spectrum()
    focus_scan: FocusScan = FocusScan()
    focus_law: FocusLawConfig = FocusLawConfig()
    sweep: Sweep = Sweep()
    processing: Processing = Processing()

    def to_dict(self) -> dict[str, Any]:
        """Give the config as plain data that `load_config` reads back to the same bits."""
        return self.model_dump(mode="json")
