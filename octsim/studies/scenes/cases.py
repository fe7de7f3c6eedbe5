"""The scenes that are compared: the configured one, and one thing in it varied at a time."""

from collections.abc import Iterator, Mapping
from enum import IntEnum
from typing import Any, NamedTuple

from octsim.base.errors import ConfigError
from octsim.config.checks import impossible
from octsim.config.derive import by_light_paths, by_waves, counting_rays, merge, validated
from octsim.config.following import fitted_diameters
from octsim.config.models import Config
from octsim.config.ranges import DiameterRange
from octsim.studies.effects.overlays import Overlay, cover, neighbour, of_cylinder, shell

AS_CONFIGURED = "as configured"
SCHEMES = ("vogel", "paths", "fullwave")
"""In the dataset's order."""
_BY: Mapping[str, Any] = {"vogel": counting_rays, "paths": by_light_paths, "fullwave": by_waves}
_MYELIN, _MEMBRANE, _OF_SHELL = 1.44, 1.46, 100
_THICKNESSES = (10, 20, 50, 100, 200, 300)  # nm
_INDICES = (1.40, 1.42, 1.44, 1.46, 1.48)
_MEMBRANES = (3, 5, 8)  # nm
_NEIGHBOURS = (0, 20, 50, 100, 200, 500, 1000, 2000)  # nm
_ELEVATIONS = (0.5, 1.0, 2.0, 5.0)  # deg
_COVERS = (3, 5, 10, 20)  # µm
_NEIGHBOUR, _COVER = "neighbour beside at", "cover glass at"
_HIGHEST = 10
"""Height of a cover glass, µm, above which Maxwell's equations take many seconds a point."""


class CaseStatus(IntEnum):
    """Whether a case is measured by a scheme, and why not."""

    MEASURED = 0
    NOT_BY_THIS_SCHEME = 1
    """The scheme can't do this scene; another of the dataset's may."""
    TOO_LONG = 2
    """The scheme can, in seconds to minutes a point: a run of the scene itself does it."""


class ChangeStatus(IntEnum):
    """Whether a change from the configured scene is known."""

    MEASURED = 0
    NOT_MEASURED = 1
    """The scene, or the configured one, is not measured by the scheme; case_status says why."""
    NO_FRINGE = 2
    """Its spectrum, or that of the configured scene, has no fringe."""


class Case(NamedTuple):
    """One scene, by each scheme that can do it."""

    quantity: str
    """What is varied; `AS_CONFIGURED` of the first."""
    value: float
    """How much of it there is; 0 is none, or of an index that of what is around."""
    unit: str
    by: tuple[Config | None, ...]
    """By each of `SCHEMES`; None where that is not measured."""
    long: bool = False
    """Whether Maxwell's equations take too long for it."""

    @property
    def name(self) -> str:
        """What tells it from the others."""
        if self.quantity == AS_CONFIGURED:
            return self.quantity
        return f"{self.quantity} {self.value:g} {self.unit}".strip()


def cases(config: Config) -> list[Case]:
    """Return the scenes about a plain config that are possible.

    Raises
    ------
    ConfigError
        If nothing in the config's scene is a cylinder that is swept.
    """
    if of_cylinder()(config) is None:
        raise ConfigError(
            "scene.cylinders: nothing in it is swept, but scenes varies what is around a cylinder "
            "that is; leave the diameter of one out"
        )
    near = _of_the_sweep(config)
    first = _case(near, AS_CONFIGURED, 0.0, "", {})
    varied = (_case(near, *one) for one in _varied(near))
    return [first, *(case for case in varied if any(case.by))]


def _of_the_sweep(config: Config) -> Config:
    """Return a config, not checked, that has no diameters but the sweep's: what is beside fits."""
    ends = config.sweep.diameters
    law = DiameterRange.model_construct(
        start=ends.start, stop=ends.stop, num=fitted_diameters(config).num
    )
    return config.model_copy(
        update={
            "focus_law": config.focus_law.model_copy(update={"diameters": law}),
            "focus_scan": config.focus_scan.model_copy(update={"diameter": ends.start}),
        }
    )


def _case(config: Config, quantity: str, value: float, unit: str, overlay: Overlay) -> Case:
    long = quantity == _COVER and value > _HIGHEST
    by = [_possible(by(config), overlay) for by in _BY.values()]
    if long:
        by[SCHEMES.index("fullwave")] = None
    return Case(quantity, value, unit, tuple(by), long)


def _possible(config: Config, overlay: Overlay) -> Config | None:
    """Return a config with an overlay, if it and its scheme can be so."""
    try:
        other = validated(merge(config.to_dict(), overlay))
    except ConfigError:
        return None
    return None if any(impossible(other)) else other


def _varied(config: Config) -> Iterator[tuple[str, float, str, Overlay]]:
    for quantity, index, thicknesses in (
        ("myelin of n 1.44,", _MYELIN, _THICKNESSES),
        ("membrane of n 1.46,", _MEMBRANE, _MEMBRANES),
    ):
        for thickness in thicknesses:
            laid = shell("sheath", index, f"{thickness} nm")(config)
            yield from _laid(quantity, thickness, "nm", laid)
    for index in _INDICES:
        laid = shell("sheath", index, f"{_OF_SHELL} nm")(config)
        yield from _laid(f"shell of {_OF_SHELL} nm, n", index, "", laid)
    for beside in _NEIGHBOURS:
        yield from _laid(_NEIGHBOUR, beside, "nm", neighbour(1e-3 * beside)(config))
    for degrees in _ELEVATIONS:
        laid = of_cylinder(elevation=f"{degrees} deg")(config)
        yield from _laid("elevation", degrees, "°", laid)
    for height in _COVERS:
        yield from _laid(_COVER, height, "µm", cover(f"{height} um")(config))


def _laid(
    quantity: str, value: float, unit: str, overlay: Overlay | None
) -> Iterator[tuple[str, float, str, Overlay]]:
    if overlay is not None:
        yield quantity, value, unit, overlay
