"""Ranges of the config: evenly spaced, by a number or a step of values, or listed one by one."""

import math
from collections.abc import Mapping
from contextlib import suppress
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    RootModel,
    Tag,
    model_validator,
)

from octsim.base.errors import ConfigError
from octsim.config.fields import Number, Position, PositiveLength, Section, as_tuple, number
from octsim.config.units import LENGTH, format_length, parse_length

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

DECIMALS = 12
"""Of a micrometre, to which evenly spaced values are rounded: an attometre."""
_WHOLE = 1e-6
"""How far from a whole number of steps a range may be."""
_MOST = 1_000_000


def evenly(start: float, stop: float, num: int) -> "NDArray[np.float64]":
    """Return evenly spaced values, shape (num,), both ends included.

    They are rounded far below a femtometre: a value that two ranges share has the same bits.
    """
    import numpy as np  # here, as reading a config takes half as long without

    return np.round(np.linspace(start, stop, num), DECIMALS)


def counted(start: float, stop: float, step: float, unit: str) -> int:
    """Return how many values, in some unit, there are in steps from `start` to `stop`, included.

    Raises
    ------
    ValueError
        If they are not a whole number of steps apart.
    """
    if not 0 < step <= stop - start:
        raise ValueError("its step should be above 0, and at most stop − start")
    steps = (stop - start) / step
    if abs(steps - round(steps)) > _WHOLE:
        below = start + step * math.floor(steps)
        raise ValueError(
            f"its step does not lead from start to stop; let it stop at {below:.9g} {unit}".rstrip()
            + f" or {below + step:.9g} {unit}".rstrip()
        )
    if steps > _MOST:
        raise ValueError(f"its step makes more than {_MOST} values; give a larger one")
    return round(steps) + 1


def _numbers(given: Mapping[str, Any], *keys: str) -> tuple[list[float], str] | None:
    """Return what stands under some keys, all lengths or all plain numbers, and their unit."""
    values = [given.get(key) for key in keys]
    for read, unit in ((parse_length, LENGTH.unit), (_plain, "")):
        with suppress(TypeError, ValueError):
            return [read(value) for value in values], unit
    return None


def _plain(value: object) -> float:
    value = number(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError
    return float(value)


def _with_step(schema: dict[str, Any]) -> None:
    """Say in a range's JSON Schema that a step may stand in the place of a number."""
    step = {"description": "between neighbours, in the place of num", "title": "Step"}
    kind = schema["properties"]["start"]["type"]
    schema["properties"]["step"] = {**step, "type": kind}
    schema["required"] = ["start", "stop"]
    schema["oneOf"] = [{"required": ["num"]}, {"required": ["step"]}]


class Range(Section):
    """Evenly spaced values, both ends included; start is below stop.

    It is given with a ``num`` of values, or with the ``step`` between them.
    """

    model_config = ConfigDict(json_schema_extra=_with_step)

    start: float
    stop: float
    num: Annotated[int, Field(ge=2, le=_MOST)]

    @model_validator(mode="before")
    @classmethod
    def _of_steps(cls, given: Any) -> Any:
        if not isinstance(given, Mapping) or "step" not in given:
            return given
        if "num" in given:
            raise ValueError("it has num and step; give one of them")
        rest = {key: value for key, value in given.items() if key != "step"}
        found = _numbers(given, "start", "stop", "step")
        if found is not None:
            (start, stop, step), unit = found
            return {**rest, "num": counted(start, stop, step, unit)}
        if _numbers(given, "start", "stop") is None:
            return {**rest, "num": 2}  # what is wrong with the ends is said of them
        raise ValueError(
            "its step should be of the kind of its ends, as {start: 1 um, stop: 2 um, step: 10 nm}"
        )

    @property
    def largest_step(self) -> float:
        """Distance of neighbours."""
        return (self.stop - self.start) / (self.num - 1)

    def values(self) -> "NDArray[np.float64]":
        """Return the values, shape (num,), in µm where they are lengths."""
        return evenly(self.start, self.stop, self.num)


class FocusRange(Range):
    """Evenly spaced heights of the focus."""

    start: Position
    stop: Position


class DiameterRange(Range):
    """Evenly spaced diameters."""

    start: PositiveLength
    stop: PositiveLength


class TableRange(DiameterRange):
    """Evenly spaced diameters, enough to interpolate between."""

    num: Annotated[int, Field(ge=8, le=_MOST)]


class FractionRange(Range):
    """Evenly spaced fractions of a diameter, enough to fit a Gaussian plus a constant over."""

    start: Annotated[Number, Field(ge=-1e6, le=1e6)]
    stop: Annotated[Number, Field(ge=-1e6, le=1e6)]
    num: Annotated[int, Field(ge=4, le=_MOST)]


class DiameterList(RootModel[tuple[PositiveLength, ...]]):
    """Diameters listed one by one, increasing; they need not be evenly spaced."""

    model_config = ConfigDict(
        frozen=True, json_schema_extra=lambda schema: schema.update(minItems=2)
    )
    fewest: ClassVar[int] = 2
    root: Annotated[tuple[PositiveLength, ...], BeforeValidator(as_tuple)]

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        if not self.fewest <= self.num <= _MOST:
            raise ValueError(f"it should list {self.fewest} to {_MOST} diameters, not {self.num}")
        for low, high in pairwise(self.root):
            if not low < high:
                raise ValueError(
                    f"{format_length(high)} stands after {format_length(low)}; list each once, "
                    "from the smallest to the largest"
                )
        return self

    @property
    def start(self) -> float:
        """The smallest, µm."""
        return self.root[0]

    @property
    def stop(self) -> float:
        """The largest, µm."""
        return self.root[-1]

    @property
    def num(self) -> int:
        """How many."""
        return len(self.root)

    @property
    def largest_step(self) -> float:
        """Largest distance of neighbours, µm."""
        return max(high - low for low, high in pairwise(self.root))

    def values(self) -> "NDArray[np.float64]":
        """Return them, shape (num,), in µm."""
        import numpy as np  # here, as reading a config takes half as long without

        return np.array(self.root)


class TableList(DiameterList):
    """Diameters listed one by one, enough to interpolate between."""

    model_config = ConfigDict(json_schema_extra=lambda schema: schema.update(minItems=8))
    fewest: ClassVar[int] = 8


def _kind(value: object) -> str:
    return "list" if isinstance(value, list | tuple | DiameterList) else "range"


Diameters = Annotated[
    Annotated[DiameterRange, Tag("range")] | Annotated[DiameterList, Tag("list")],
    Discriminator(_kind),
]
"""Diameters: evenly spaced, or listed."""
TableDiameters = Annotated[
    Annotated[TableRange, Tag("range")] | Annotated[TableList, Tag("list")],
    Discriminator(_kind),
]
"""Diameters, enough to interpolate between: evenly spaced, or listed."""


def even(diameters: DiameterRange | DiameterList, work: str) -> DiameterRange:
    """Return a sweep's diameters as the range that they are.

    Raises
    ------
    ConfigError
        If they are listed: some work needs neighbours that are equally far apart.
    """
    if isinstance(diameters, DiameterRange):
        return diameters
    raise ConfigError(
        f"sweep.diameters: a list given, but {work} needs evenly spaced ones; give "
        "{start: ..., stop: ..., num: ...}, or step in the place of num"
    )
