"""Sections of the config for the way from a phase to nanometres, and its worked example."""

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Discriminator, Field, Tag

from octsim.config.fields import (
    Number,
    NumberTolerance,
    PositiveLength,
    Section,
    Tolerance,
    Wavelength,
    absent,
    as_tuple,
    key,
    number,
)
from octsim.config.processing import PhaseEstimator
from octsim.config.ranges import TableDiameters
from octsim.config.units import ANGLE, ATTENUATION, LENGTH, Angle, Length, parse
from octsim.schemes.table import FULL_WAVE, LIGHT_PATHS


def _tolerance(value: object) -> object:
    """Return a tolerance of some kind in the unit that it is kept in; of an index the number."""
    value = number(value)
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise ValueError(_KINDS)  # noqa: TRY004
    if not isinstance(value, str):
        if not (math.isfinite(value) and 0 <= value <= 1):
            raise ValueError("it should be from 0 to 1")
        return float(value)
    for quantity in (LENGTH, ANGLE, ATTENUATION):
        try:
            size = parse(quantity, value)
        except ValueError:
            continue
        if not 0 <= size <= 1e6:
            raise ValueError(f"it should be from 0 to 1000000 {quantity.unit}")
        return f"{size!r} {quantity.unit}"
    raise ValueError(_KINDS)


_KINDS = (
    "it should be a length or an angle with its unit, such as 50 nm or 1 deg, or of an index a "
    "plain number"
)
_OF_SCENE = r"^scene\."
"""Dotted keys of the scene, which octsim.config.scene_keys looks for in it."""


class Tolerances(Section):
    """How well the instrument and the neuron are known: one standard deviation of each.

    Any number of the scene can have one, by its dotted key.
    """

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[
        Annotated[str, Field(pattern=_OF_SCENE)],
        Annotated[float | str, BeforeValidator(_tolerance, json_schema_input_type=float | str)],
    ]

    diameter: Tolerance = key("20 nm", "of the neuron at rest; its focus is found with it")
    gap: Tolerance = key("2 nm", "between the glass and the neuron")
    glass: NumberTolerance = key(0.0005, "refractive index")
    water: NumberTolerance = key(0.001, "refractive index")
    neuron: NumberTolerance = key(0.002, "refractive index")
    focus: Tolerance = key("10 nm", "from the focus that the law gives")
    numerical_aperture: NumberTolerance = key(0.01, "of the objective")
    detector_radius: Tolerance = key(
        "2 nm", "R_det, of the fibre core's image at the focus; by rays"
    )
    fill: NumberTolerance = key(
        0.05, "width of what fills the pupil, relative to it; by scheme fullwave"
    )
    polarisation: Annotated[Angle, Field(ge=0, le=0.8)] = key(
        "5 deg",
        "direction of linear input, or else of the analyser; without either the light is linear "
        "by the sine of twice this; by scheme fullwave",
    )
    offset: Tolerance = key("50 nm", "of the neuron, across it, from the axis; by scheme fullwave")
    wavelength_min: Tolerance = key("0.1 nm", "of the spectrometer, at the shortest")
    wavelength_max: Tolerance = key("0.1 nm", "of the spectrometer, at the longest")

    @property
    def of_scene(self) -> Mapping[str, float | str]:
        """Those of the scene's numbers by their dotted keys, as they are kept."""
        return self.model_extra or {}

    @property
    def of(self) -> Mapping[str, float]:
        """Each by its name, or its dotted key: µm, rad, 1/µm or a number."""
        given: dict[str, Any] = dict(self)
        return {
            name: float(value.split()[0]) if isinstance(value, str) else value
            for name, value in given.items()
        }


class Calibration(Section):
    """From a phase to nanometres, at a fixed focus and gap."""

    diameters: TableDiameters | None = key(
        {"start": "1 um", "stop": "2 um", "num": 51},
        "of the neuron at rest; null is the sweep's range, 20 nm apart at most",
    )
    step: Annotated[Length, Field(ge=1e-6, le=1e-2)] = key(
        "0.1 nm", "of the diameter, to each side, over which the phase is differentiated"
    )
    estimator: PhaseEstimator = key(
        "sinusoid", "of the phase, one of processing.estimator, with the options of processing"
    )
    scheme: Annotated[Literal["fullwave", "paths"] | None, BeforeValidator(absent)] = key(
        None,
        f"how spectra are found, whatever the run's scheme: {FULL_WAVE.name}, Maxwell's equations, "
        f"or {LIGHT_PATHS.name}, rays; null is {FULL_WAVE.name} where it can",
    )
    tolerances: Tolerances = Tolerances()


Sample = Annotated[int, Field(ge=1, le=1_000_000_000)]


def _first_to_last(value: tuple[int, int]) -> tuple[int, int]:
    if value[0] > value[1]:
        raise ValueError("the last sample stands before the first")
    return value


def _some(value: tuple[object, ...]) -> tuple[object, ...]:
    # of those that are right: a wrong one is told of once
    if not value:
        raise ValueError("no samples are named")
    return value


Samples = Annotated[
    tuple[Sample, Sample], BeforeValidator(as_tuple), AfterValidator(_first_to_last)
]


class DriftReference(Section):
    """More samples that are at rest, for a line that is subtracted as drift."""

    reference: Annotated[tuple[Samples, ...], BeforeValidator(as_tuple), AfterValidator(_some)]


def _drift_kind(value: object) -> str:
    return "name" if isinstance(value, str) else "reference"


def _off(value: object) -> object:
    return "off" if value is False else value  # as YAML reads it


def _none(value: object) -> object:
    return "none" if value is None else value


def _rising(value: tuple[float, float]) -> tuple[float, float]:
    if not value[0] < value[1]:
        raise ValueError("the first wavelength should be below the second")
    return value


Band = Annotated[tuple[Wavelength, Wavelength], BeforeValidator(as_tuple), AfterValidator(_rising)]
"""A band of wavelengths in vacuum, from the shortest to the longest."""
DIAMETER = "diameter"
Fitted = Annotated[str, Field(pattern=r"^(diameter|gap|index|thickness|thickness_[2-9])$")]
"""A quantity of the neuron that may change: `octsim.studies.responses.quantities`."""


def _with_diameter(value: tuple[str, ...]) -> tuple[str, ...]:
    if DIAMETER not in value or len(set(value)) < len(value):
        raise ValueError("it should have diameter, and whatever else once")
    return value


class ExpansionConfig(Section):
    """A measured series of phases, for `snakemake expansion`."""

    series: Annotated[str, Field(min_length=1)] | None = key(
        None, "a CSV or netCDF file that holds time, phase and maybe phase_error"
    )
    diameter: PositiveLength = key("1.4 um", "of the neuron at rest")
    rest: Annotated[int, Field(ge=1, le=1_000_000)] = key(
        20, "samples at the start, whose mean phase is that of no expansion"
    )
    outliers: Annotated[Literal["off", "mark", "drop"], BeforeValidator(_off)] = key(
        "off", "samples that stand alone: kept and warned of, marked as well, or left out"
    )
    drift: Annotated[
        Annotated[Literal["none", "linear"], Tag("name")]
        | Annotated[DriftReference, Tag("reference")],
        Discriminator(_drift_kind),
        BeforeValidator(_none),
    ] = key(
        "none",
        "what is subtracted: the mean at rest, the line through the samples at rest, or that "
        "through more of them, {reference: [[first, last], ...]}, counted from 1",
    )

    slope: Literal["calibration", "match"] = key(
        "calibration",
        "of what: the neuron of this config, or, of measured spectra, the one that fits them best",
    )
    fit: Annotated[
        tuple[Fitted, ...], BeforeValidator(as_tuple), AfterValidator(_with_diameter)
    ] = key(
        [DIAMETER],
        "what changes: diameter, and maybe gap, index (of the neuron) and thickness (of its shell; "
        "thickness_2 of the second one); more than the diameter needs a phase in several bands",
    )
    bands: Annotated[tuple[Band, ...], BeforeValidator(as_tuple)] = key(
        [],
        "[shortest, longest] wavelength of each band that the series has a phase of, as phase_1, "
        "phase_2, ...; without any it has one phase, of the spectrum's band",
    )

    @property
    def several(self) -> bool:
        """Whether it is by responses: of phases in bands, or of more than the diameter."""
        return bool(self.bands) or self.fit != (DIAMETER,)

    @property
    def references(self) -> tuple[tuple[int, int], ...]:
        """Samples at rest besides those at the start, from first to last, counted from 1."""
        return self.drift.reference if isinstance(self.drift, DriftReference) else ()


class ActionPotential(Section):
    """The worked example: a neuron that fires, for `snakemake action_potential`."""

    diameter: PositiveLength = key("1.4 um", "of the neuron at rest")
    expansion: Annotated[Length, Field(ge=1e-6, le=1e-2)] = key("1 nm", "at its largest")
    photons: Annotated[Number, Field(ge=1, le=1e15)] = key(
        1e8, "detected in each spectrum, as a mean"
    )
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = key(1, "of the shot noise")
