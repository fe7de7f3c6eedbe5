"""The config: what a user may set, its defaults (the thesis) and its limits.

The models are the one source: `config/default.yaml`'s values, `config/schema.json` and the
reference in the docs are generated from them or tested against them.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag

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
PositiveLength = Annotated[Length, Field(gt=0)]
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

    start: Length
    stop: Length


class DiameterRange(Range):
    """Evenly spaced diameters."""

    start: PositiveLength
    stop: PositiveLength


class FractionRange(Range):
    """Evenly spaced fractions of a diameter, enough to fit a Gaussian plus a constant over."""

    start: Number
    stop: Number
    num: Annotated[int, Field(ge=4, le=1_000_000)]


class RefractiveIndex(Section):
    """Refractive indices of the three media."""

    glass: Index = Field(1.52, description="slide and immersion oil")
    water: Index = Field(1.33, description="around the neuron")
    neuron: Index = Field(1.39, description="the cylinder")


class SceneConfig(Section):
    """What the light meets: a cylinder over a glass slide, in water."""

    refractive_index: RefractiveIndex = RefractiveIndex()
    gap: Annotated[Length, Field(ge=0)] = Field(
        "5 nm", description="water between the glass and the neuron"
    )


class Objective(Section):
    """The objective lens, an ideal thin one."""

    numerical_aperture: Annotated[Number, Field(gt=0)] = Field(
        1.2, description="below the index of glass"
    )
    focus_distance: PositiveLength = Field(
        "300 um", description="from the objective plane to the focus; beyond every focus"
    )
    magnification: Annotated[Number, Field(gt=0)] = Field(20.0, description="object to fibre")


class DetectorConfig(Section):
    """The fibre that collects the light."""

    core_diameter: PositiveLength = Field(
        "4.4 um", description="of the fibre; R_det = core_diameter / (2 magnification)"
    )


class Tracing(Section):
    """How rays are placed and how far each is followed."""

    scheme: Literal["vogel"] = Field("vogel", description="the thesis's sunflower spiral")
    rays: Annotated[int, Field(ge=1, le=10_000_000)] = Field(3000, description="at the objective")
    max_intersections: Annotated[int, Field(ge=1, le=30)] = Field(
        11, description="meetings with the plane and the cylinder on one ray"
    )
    min_amplitude: Annotated[Number, Field(ge=0, lt=1)] = Field(
        0.0, description="a fainter ray is dropped; relative to the launch amplitude"
    )


class Wavelengths(Section):
    """The band, in vacuum."""

    min: PositiveLength = Field("650 nm", description="shortest wavelength")
    max: PositiveLength = Field("900 nm", description="longest wavelength")


class Spectrum(Section):
    """The flat spectrum of the source and the samples taken of it."""

    wavelength: Wavelengths = Wavelengths()
    samples: Annotated[int, Field(ge=2, le=1_000_000)] = Field(
        1000, description="wavenumbers, evenly spaced, both ends included"
    )


class FocusScan(Section):
    """Figure 6: one diameter, many foci."""

    diameter: PositiveLength = Field("2 um", description="of the cylinder")
    focus: FocusRange = Field(
        {"start": "-1 um", "stop": "4 um", "num": 501},
        description="height of the focus above the glass",
    )


class FocusLawConfig(Section):
    """Figure 7: the focus of greatest intensity for some diameters, and the line through them."""

    diameters: DiameterRange = Field(
        {"start": "0.8 um", "stop": "2.4 um", "num": 9}, description="of the cylinder"
    )
    fraction: FractionRange = Field(
        {"start": 0.4, "stop": 0.8, "num": 41},
        description="foci tried, as fractions of the diameter",
    )


class FocusLine(Section):
    """A given focus law: focus = slope · diameter + intercept; slope 0 is a fixed focus."""

    slope: Number
    intercept: Length


def _focus_kind(value: object) -> str:
    return "line" if isinstance(value, Mapping | FocusLine) else "law"


class Sweep(Section):
    """Figures 8 to 12: the diameters whose spectra are made."""

    diameters: DiameterRange = Field(
        {"start": "1 um", "stop": "2 um", "num": 151}, description="of the cylinder"
    )
    focus: Annotated[
        Annotated[Literal["law"], Tag("law")] | Annotated[FocusLine, Tag("line")],
        Discriminator(_focus_kind),
    ] = Field(
        "law", description="law (the fitted one), or {slope: 0.581, intercept: 69 nm}"
    )


Window = Literal[
    "barthann", "bartlett", "blackman", "blackmanharris", "bohman", "boxcar", "cosine",
    "flattop", "hamming", "hann", "lanczos", "nuttall", "parzen", "taylor", "triang", "tukey",
]  # fmt: skip


class Processing(Section):
    """From a spectrum to a phase."""

    estimator: Literal["fft"] = Field("fft", description="the thesis's Fourier transform")
    centre: Literal["midpoint", "mean"] = Field(
        "midpoint", description="what is subtracted before the window: (max + min)/2, or the mean"
    )
    window: Window = Field("hamming", description="a symmetric window of scipy.signal.windows")


class Config(Section):
    """A whole run. Every value has the thesis's as its default."""

    run: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$", max_length=100)] = Field(
        "thesis", description="name of the run: datasets and figures go to results/<run>/"
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
