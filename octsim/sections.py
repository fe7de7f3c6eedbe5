"""What the config's models are made of: a section, its keys, and numbers and lengths in them."""

from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

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


class Section(BaseModel):
    """A part of the config: frozen, with no room for keys that it does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, validate_default=True)


def key(default: object, description: str) -> Any:
    """Give the field of a key of the config: its default and what it means."""
    # typed Any: a default is written as a user would write it, "5 nm", and validated
    return Field(default, description=description)
