"""The table of schemes: how the light of a point is found. A scheme is a row here and a module.

A scheme's module has the functions ``tracer`` and ``field``; `Scheme` says what they take
and return. Modules are imported when they are first used, so that neither a digest of sources nor a
process that needs one scheme depends on the others.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from importlib import import_module
from typing import TYPE_CHECKING, Any

from octsim.schemes.cost import (
    Additions,
    PointCost,
    of_paths,
    of_rays,
    of_waves,
    times_of_paths,
    times_of_waves,
)

if TYPE_CHECKING:
    # the config reads this table, and needs no compiler for it
    import numpy as np
    from numpy.typing import NDArray

    from octsim.schemes.light import Field, Found, LightAt, Optics, Options


class Ability(Enum):
    """What not every scheme can do of what a config can ask for; its value is a scheme that can't.

    Every scheme does the thesis's: a cylinder on the optical axis, a gap above a slide.
    """

    PUPIL = "does not weigh the pupil"
    APLANATIC = "has no apodisation"
    POLARISATION = "has light of one kind, the thesis's unpolarised one"
    ATTENUATION = "has no attenuation"
    ATTENUATION_AROUND = "has no attenuation around the cylinder"
    LAYERS = "has two layers, of two media"
    NO_CYLINDER = "needs a cylinder"
    PLATES = "has no plates without a cylinder"
    CYLINDERS = "has one cylinder"
    OFF_AXIS = "has the cylinder on the optical axis"
    AZIMUTH = "has the cylinder along y"
    CROSSED = "has parallel cylinders"
    ELEVATION = "has the cylinder level"
    SHELLS = "has a cylinder without shells"
    DISPERSION = "has constant indices"
    ZERNIKE = "has no aberrations"
    ODD_ALONG = "needs an aberration that is even along the cylinder"
    FOCAL_SHIFT = "has one focus for all wavelengths"
    FALLOFF = "does not weigh by a falloff"
    FIBRE_FALLOFF = "does not weigh by a falloff without an edge that depends on the wavenumber"
    WAIST = "has rays that meet in the focus"
    REFERENCE = "has no reference arm"
    UNMIRRORED = "needs a plane through the optical axis in which the cylinders are mirrored"


@dataclass(frozen=True)
class Scheme:
    """One way to find the light of a point."""

    name: str
    """As in ``tracing.scheme``."""
    module: str
    """Where its functions are."""
    options: tuple[str, ...]
    """Keys of the section ``tracing`` that its light depends on, besides the instrument's."""
    effort: str
    """The one of them that decides what a point takes."""
    cost: Callable[[Options, float], PointCost]
    """Returns what a point of a diameter (µm) takes, typically; the same on all machines."""
    times: Callable[[Additions], float] = lambda _: 1.0
    """Returns how many times as long it takes for what a scene has beside the thesis's."""
    light: str = "rays"
    """What its light is: rays, each with its field, or waves, a field without any."""
    counts_rays: bool = False
    """Whether its light is a number of rays, each of which is counted."""
    controls_error: bool = False
    """Whether it reaches ``tracing.accuracy``, in one band, or says that it does not."""
    by_wavenumber: float = 10.0
    """How many times as long a point takes whose light's way depends on the wavenumber."""
    steepest: float = math.inf
    """Numerical aperture over the water's index above which it can miss light."""
    honours: frozenset[Ability] = frozenset()
    """What it can do beyond the thesis's instrument."""
    mode_field_diameter: float | None = None
    """Of the fibre whose mode fills the pupil where a config gives none, µm; else it is even."""
    presets: Mapping[str, Mapping[str, float]] = dataclasses.field(default_factory=dict)
    """Options that a name stands for."""

    instrument: tuple[str, ...] = (
        "scene", "objective", "beam", "detector", "tracing.max_intersections",
    )  # fmt: skip
    """Dotted keys of the instrument that its light depends on."""

    @property
    def keys(self) -> tuple[str, ...]:
        """Dotted keys of the config that its light depends on."""
        # an accuracy is one in a band; rays that are counted serve any
        band = ("spectrum.wavelength",) if self.controls_error else ()
        own = (f"tracing.{name}" for name in self.options)
        return (*self.instrument, "tracing.scheme", *own, *band)

    @property
    def summing_keys(self) -> tuple[str, ...]:
        """Dotted keys, besides the spectrum's, that its field over the wavenumbers depends on."""
        accuracy = ("tracing.accuracy",) if self.controls_error else ()
        # rays of polarised light are found as such; waves are found for all of it
        return (*accuracy, "interferometer", *(("polarisation",) if self.light == "waves" else ()))

    def chosen(self, tracing: object) -> Options:
        """Return the values that a section ``tracing`` has for the scheme's options."""
        return {name: getattr(tracing, name) for name in self.options}

    def tracer(self, optics: Optics, options: Options) -> LightAt:
        """Return the function of scene and focus (µm) that finds the light of a point."""
        found: LightAt = self._functions.tracer(optics, options)
        return found

    def field(
        self, light: Found, wavenumber: NDArray[np.float64], optics: Optics, options: Options
    ) -> Field:
        """Return the field of some light at evenly spaced wavenumbers (K,), 1/µm."""
        found: Field = self._functions.field(light, wavenumber, optics, options)
        return found

    def rate_name(self, options: Options) -> str:
        """Name the points that take about the same."""
        return f"{self.name} {options[self.effort]}"

    @property
    def _functions(self) -> Any:
        return import_module(self.module)


_OF_BOTH = frozenset(
    {
        Ability.PUPIL, Ability.APLANATIC, Ability.POLARISATION, Ability.ATTENUATION,
        Ability.DISPERSION, Ability.ZERNIKE, Ability.FOCAL_SHIFT, Ability.REFERENCE,
        Ability.PLATES,
    }
)  # fmt: skip
_OF_RAYS = _OF_BOTH | {
    Ability.ATTENUATION_AROUND, Ability.FALLOFF, Ability.LAYERS, Ability.CYLINDERS,
    Ability.OFF_AXIS, Ability.AZIMUTH, Ability.ELEVATION, Ability.SHELLS, Ability.NO_CYLINDER,
    Ability.CROSSED,
}  # fmt: skip

COUNTED_RAYS = Scheme(
    name="vogel",
    module="octsim.schemes.vogel",
    options=("rays", "min_amplitude"),
    effort="rays",
    cost=of_rays,
    counts_rays=True,
    by_wavenumber=100.0,
    honours=_OF_RAYS
    | {Ability.ODD_ALONG, Ability.FIBRE_FALLOFF, Ability.WAIST, Ability.UNMIRRORED},
)
"""The thesis's: a sunflower spiral of rays, each followed through the whole tree."""

LIGHT_PATHS = Scheme(
    name="paths",
    module="octsim.schemes.paths.scheme",
    options=("accuracy",),
    effort="accuracy",
    cost=of_paths,
    times=times_of_paths,
    controls_error=True,
    honours=_OF_RAYS,
    steepest=0.92,
    presets={
        "draft": {"accuracy": 3e-2}, "standard": {"accuracy": 1e-4}, "reference": {"accuracy": 1e-8}
    },
)  # fmt: skip
"""Each light path integrated over the aperture, to a stated accuracy."""

FULL_WAVE = Scheme(
    name="fullwave",
    module="octsim.schemes.fullwave.scheme",
    options=("accuracy",),
    effort="accuracy",
    cost=of_waves,
    times=times_of_waves,
    light="waves",
    controls_error=True,
    honours=_OF_BOTH
    | {Ability.OFF_AXIS, Ability.AZIMUTH, Ability.SHELLS, Ability.LAYERS, Ability.CYLINDERS},
    mode_field_diameter=5.0,
    instrument=(
        "scene", "objective.numerical_aperture", "objective.magnification", "objective.pupil",
        "objective.apodisation", "objective.immersion", "objective.zernike",
        "objective.focal_shift",
    ),
    presets={"exact": {"accuracy": 1e-4}},
)  # fmt: skip
"""Maxwell's equations solved in partial waves about the cylinder, to a stated accuracy."""

SCHEMES: Mapping[str, Scheme] = {row.name: row for row in (COUNTED_RAYS, LIGHT_PATHS, FULL_WAVE)}
"""Every scheme by its name; the first is the thesis's."""
PRESETS: Mapping[str, Mapping[str, Any]] = {
    name: {"scheme": row.name, **options}
    for row in SCHEMES.values()
    for name, options in row.presets.items()
}
"""Points of the trade of cost for accuracy, each a scheme and its options."""
UNIT_OF_INTENSITY: Mapping[str, str] = {
    "rays": "all light in phase",
    "waves": "a mirror in the focus",
}
"""What an intensity of 1 is, by the kind of light: they are not the same instrument."""
