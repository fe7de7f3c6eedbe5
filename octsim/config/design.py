"""The section of the config for the search for the best instrument (`snakemake design`)."""

from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, Field

from octsim.config.fields import (
    Number,
    PositiveNumber,
    Section,
    Wavelength,
    as_tuple,
    key,
)
from octsim.config.ranges import DiameterRange, FocusRange
from octsim.config.units import Length


def _different(values: tuple[Any, ...]) -> tuple[Any, ...]:
    twice = [value for place, value in enumerate(values) if value in values[:place]]
    if twice:
        first = twice[0]
        text = first.model_dump(mode="json") if isinstance(first, BaseModel) else f"{first:g}"
        raise ValueError(f"{text} stands twice")
    return values


class DesignBand(Section):
    """A band of wavelengths, in vacuum."""

    min: Wavelength
    max: Wavelength


_Numbers = Annotated[
    tuple[PositiveNumber, ...],
    Field(max_length=1000),
    BeforeValidator(as_tuple),
    AfterValidator(_different),
]


class Design(Section):
    """Which instrument knows an expansion best: what is tried, beside the configured one."""

    photons: Annotated[Number, Field(ge=1, le=1e15)] = key(
        1e6, "detected in each spectrum, as a mean"
    )
    expansion: Annotated[Length, Field(ge=1e-6, le=1e-1)] = key("1 nm", "that is to be measured")
    diameters: DiameterRange = key(
        {"start": "1 um", "stop": "2 um", "num": 3}, "of the neuron at rest"
    )
    fills: Annotated[_Numbers, Field(min_length=1)] = key(
        [0.3, 0.5, 0.7, 1.0, 10.0],
        "of the pupil, by a Gaussian: 1/e² radius of intensity over the pupil's; 10 is even light",
    )
    focus_offsets: FocusRange = key(
        {"start": "-0.8 um", "stop": "0.8 um", "num": 9}, "of the focus from sweep.focus"
    )
    apertures: _Numbers = key([0.8, 1.0], "numerical apertures, beside the objective's")
    bands: Annotated[
        tuple[DesignBand, ...],
        Field(max_length=100),
        BeforeValidator(as_tuple),
        AfterValidator(_different),
    ] = key(
        [{"min": "650 nm", "max": "800 nm"}, {"min": "600 nm", "max": "1000 nm"}],
        "wavelengths, beside the spectrum's",
    )
