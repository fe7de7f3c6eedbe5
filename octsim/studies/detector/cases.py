"""The detectors that are compared: each falloff at each radius of the fibre core's image."""

from collections.abc import Iterator
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from octsim.base.errors import ConfigError
from octsim.config.abilities import asked_of_scheme
from octsim.config.derive import by_light_paths, changed, counting_rays
from octsim.config.models import Config
from octsim.instrument.build import detector_of
from octsim.schemes.table import LIGHT_PATHS, Ability

FALLOFFS = ("parabolic", "top_hat", "cosine", "gaussian", "fibre")
"""In the dataset's order."""
RADII = (0.05, 0.07, 0.1, 0.14, 0.2, 0.28, 0.4)
"""R_det, µm; the run's own is among them too."""
_SAME = 1e-6  # µm, by which two radii differ at least
_BEYOND = {
    Ability.POLARISATION, Ability.ATTENUATION, Ability.ATTENUATION_AROUND, Ability.DISPERSION,
    Ability.FOCAL_SHIFT, Ability.WAIST,
}  # fmt: skip


class LimitStatus(IntEnum):
    """Whether it is known what counted rays come to as they become more."""

    KNOWN = 0
    """By scheme paths."""
    BEYOND_PATHS = 1
    """Scheme paths can't do the falloff, or something else of the instrument."""


class JumpStatus(IntEnum):
    """Whether it is known how the phase moves as rays enter or leave the detector."""

    KNOWN = 0
    NO_FRINGE = 1
    """The spectrum has no fringe, before or after."""


class Case(NamedTuple):
    """One detector."""

    falloff: str
    radius: float
    """R_det, µm; the Gaussian has 1/e of amplitude there, the fibre's core its image's edge."""
    counted: Config
    """With counted rays."""
    limit: Config | None
    """With light paths; None where they can't do it."""

    @property
    def status(self) -> LimitStatus:
        """Whether its limit is known."""
        return LimitStatus.BEYOND_PATHS if self.limit is None else LimitStatus.KNOWN


def own_radius(config: Config) -> float:
    """Return the radius R_det of a plain config, µm; of a Gaussian that is given, its w."""
    mode = config.detector.mode_field_diameter
    if config.detector.falloff == "gaussian" and mode is not None:
        return mode / (2 * config.objective.magnification)
    return detector_of(config).radius


def radii_of(config: Config) -> list[float]:
    """Return the radii R_det that are compared, increasing, µm: the run's own is one of them."""
    own = own_radius(config)
    return sorted([*(radius for radius in RADII if abs(radius - own) > _SAME), own])


def cases(config: Config) -> list[Case]:
    """Return the detectors of a plain config, radius after radius for each falloff.

    Raises
    ------
    ConfigError
        If rays differ from wavelength to wavelength, or are other than the thesis's in what they
        carry: they are found once here, and collected by every detector.
    """
    base = counting_rays(config)
    for asked in asked_of_scheme(base):
        if asked.ability in _BEYOND:
            raise ConfigError(
                f"{asked.key}: {asked.given} given, but detector.nc is of the thesis's light, by "
                "rays that are the same at all wavelengths; leave it out"
            )
    return list(_cases(base))


def _cases(base: Config) -> Iterator[Case]:
    for falloff in FALLOFFS:
        for radius in radii_of(base):
            core = np.round(2 * radius * base.objective.magnification, 9)
            fibre = {"core_diameter": f"{core} um", "mode_field_diameter": None}
            counted = changed(base, {"detector": {**fibre, "falloff": falloff}})
            asked = {one.ability for one in asked_of_scheme(counted)}
            able = asked <= LIGHT_PATHS.honours
            yield Case(falloff, radius, counted, by_light_paths(counted) if able else None)
