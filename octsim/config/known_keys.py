"""The dotted path of every key that a config has."""

from collections.abc import Iterator, Mapping

from pydantic import BaseModel

from octsim.config.archive import Creator
from octsim.config.effects import FocalShiftConfig, ReferenceArmConfig
from octsim.config.models import Config, FocusLine, Grid
from octsim.config.scene import Layer


def known_keys(model: type[BaseModel] | BaseModel = Config, prefix: str = "") -> Iterator[str]:
    """Return the dotted path of every key of the config, sections before what they hold."""
    model = model() if isinstance(model, type) else model
    # of a grid, what is varied stands under keys of their own
    free = () if isinstance(model, Grid) else model.model_extra or ()
    for name in (*type(model).model_fields, *free):
        yield prefix + name
        value = getattr(model, name)
        for place, part in enumerate(value if isinstance(value, tuple) else ()):
            if isinstance(part, BaseModel):
                yield f"{prefix}{name}.{place}"
                if isinstance(part, Layer) and part.thickness is None:
                    continue  # it is written as its name alone
                yield from known_keys(part, f"{prefix}{name}.{place}.")
        if isinstance(value, BaseModel):
            yield from known_keys(value, f"{prefix}{name}.")
    if isinstance(model, Config):
        yield from (f"sweep.focus.{name}" for name in FocusLine.model_fields)
        yield from (f"archive.creators.{name}" for name in Creator.model_fields)
        yield from ("objective.pupil.gaussian", "objective.pupil.fibre")
        yield from _of_section("objective.focal_shift", model.objective.focal_shift)
        yield from _of_section("interferometer.reference", model.interferometer.reference)


_OPTIONAL_SECTIONS: Mapping[str, type[BaseModel]] = {
    "objective.focal_shift": FocalShiftConfig, "interferometer.reference": ReferenceArmConfig,
}  # fmt: skip


def _of_section(key: str, given: BaseModel | None) -> Iterator[str]:
    """Return the keys of a section that is not there by default, if it is not given."""
    if given is None:
        yield from (f"{key}.{name}" for name in _OPTIONAL_SECTIONS[key].model_fields)


def of_any_entry(key: str) -> str:
    """Return a key without the places of lists in it."""
    return ".".join(part for part in key.split(".") if not part.isdigit())
