"""What the config's sections are made of: numbers and lengths with their limits."""

from collections.abc import Mapping, Sequence
from datetime import date
from typing import Annotated, Any

import yaml
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from octsim.config.units import Length

_PLAIN = {str, int, float, bool, type(None)}


def number(value: object) -> object:
    """Return the number that text as 1e-6 plainly is; YAML 1.1 reads it as text, without a dot."""
    if isinstance(value, str) and ("e" in value or "E" in value):
        try:
            return float(value)
        except ValueError:
            return value
    return value


def as_tuple(value: object) -> object:
    """Return a list as a tuple: YAML and JSON know lists, but a tuple can't be changed."""
    return tuple(value) if isinstance(value, list) else value


def listed(value: object) -> object:
    """Return a list as a tuple; of anything else say that it is none."""
    plain = plain_data(value)
    if not isinstance(plain, list | tuple):
        raise ValueError("it should be a list")  # noqa: TRY004
    return tuple(plain)


def plain_data(value: Any) -> Any:
    """Return lists and numbers in the place of arrays, other sequences and numpy's numbers."""
    if type(value) in _PLAIN:  # most are, and to ask for a mapping takes ten times as long
        return value
    if isinstance(value, Mapping):
        return {key: plain_data(part) for key, part in value.items()}
    if isinstance(value, BaseModel):
        return value
    if isinstance(value, str | bytes | int | float) and not hasattr(value, "dtype"):
        return value
    if hasattr(value, "__array__"):
        import numpy as np  # here, as reading a config takes half as long without

        return np.asarray(value).tolist()
    if isinstance(value, Sequence):
        return [plain_data(part) for part in value]
    return value


def absent(value: object) -> object:
    """Return None for ``none``, which is what stands for it in text."""
    return None if value == "none" else value


def as_text(value: Any) -> str:
    """Write a value of the config as a user would."""
    if isinstance(value, Mapping | list | tuple | bool) or value is None:
        text: str = yaml.safe_dump(_plain(value), default_flow_style=True, width=10_000)
        return text.removesuffix("...\n").strip()
    return str(value)


def _plain(value: Any) -> Any:
    """Return what YAML can write, with numbers where they are keys as text."""
    if isinstance(value, Mapping):
        numbers = {key: int(key) for key in value if isinstance(key, str) and key.isdecimal()}
        return {numbers.get(key, key): _plain(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    return value if isinstance(value, str | int | float | date) or value is None else str(value)


Number = Annotated[float, BeforeValidator(number), Field(allow_inf_nan=False)]
PositiveLength = Annotated[Length, Field(ge=1e-6, le=1e6)]  # 1 pm to 1 m
Position = Annotated[Length, Field(ge=-1e6, le=1e6)]
Wavelength = Annotated[Length, Field(ge=1e-3, le=1e3)]  # 1 nm to 1 mm
PositiveNumber = Annotated[Number, Field(ge=1e-6, le=1e6)]
Tolerance = Annotated[Length, Field(ge=0, le=1e6)]
NumberTolerance = Annotated[Number, Field(ge=0, le=1)]
Index = Annotated[Number, Field(ge=1, le=10)]


class Section(BaseModel):
    """A part of the config: frozen, with no room for keys that it does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, validate_default=True)


def key(default: object, description: str) -> Any:
    """Declare a key: its default, written as a user would write it ("5 nm"), and its meaning."""
    # typed Any: the default is validated
    return Field(default, description=description)
