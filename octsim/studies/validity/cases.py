"""The instruments that are compared: the configured one, and one quantity varied at a time."""

from collections.abc import Iterator
from typing import Any, NamedTuple

from octsim.base.errors import ConfigError
from octsim.config.derive import by_light_paths, changed, counting_rays, nested
from octsim.config.maxwell import beyond_maxwell, by_maxwell
from octsim.config.models import Config

AS_CONFIGURED = "as configured"
SCHEMES = ("vogel", "paths")
"""Of rays, in the dataset's order."""
_PUPILS: tuple[tuple[str, Any], ...] = (
    ("uniform", "uniform"), ("Gaussian 2", {"gaussian": 2.0}), ("Gaussian 1", {"gaussian": 1.0}),
    ("Gaussian 0.5", {"gaussian": 0.5}), ("Gaussian 0.3", {"gaussian": 0.3}),
    ("fibre 5 um", {"fibre": "5 um"}),
)  # fmt: skip
_APERTURES = (0.5, 0.8, 1.0, 1.1, 1.2, 1.3)
_CONTRASTS = (0.01, 0.03, 0.06, 0.1, 0.2)
_GAPS = (0, 5, 20, 50, 100, 200, 500)


class Case(NamedTuple):
    """One instrument by each scheme."""

    quantity: str
    """What is varied; `AS_CONFIGURED` of the first."""
    value: str
    """What it is."""
    rays: tuple[Config, ...]
    """By each of `SCHEMES`."""
    exact: Config
    """By Maxwell's equations."""

    @property
    def name(self) -> str:
        """What tells it from the others."""
        return f"{self.quantity} {self.value}".strip()


def cases(config: Config) -> list[Case]:
    """Return the cases about a plain config, those left out that no scheme of waves can do.

    Raises
    ------
    ConfigError
        If the config itself is one of those.
    """
    if reason := beyond_maxwell(config):
        raise ConfigError(f"{reason}, for validity")
    found = [_case(AS_CONFIGURED, "", config)]
    for quantity, value, overlay in _varied(config):
        try:
            other = changed(by_maxwell(config), overlay)
        except ConfigError:  # as an aperture above the index of glass
            continue
        if not beyond_maxwell(other):
            found.append(_case(quantity, value, other))
    return found


def _case(quantity: str, value: str, config: Config) -> Case:
    return Case(
        quantity, value, (counting_rays(config), by_light_paths(config)), by_maxwell(config)
    )


def _varied(config: Config) -> Iterator[tuple[str, str, dict[str, Any]]]:
    scene = config.scene
    for name, pupil in _PUPILS:
        yield "pupil", name, nested("objective.pupil", pupil)
    for aperture in _APERTURES:
        yield "NA", f"{aperture:g}", nested("objective.numerical_aperture", aperture)
    medium = scene.swept_medium
    for contrast in _CONTRASTS:
        index = round(config.host_index + contrast, 6)
        yield "index", f"{index:g}", nested(f"scene.refractive_index.{medium}", index)
    for gap in _GAPS:
        yield "gap", f"{gap} nm", nested(scene.swept_gap_key, f"{gap} nm")
