"""The scheme of a config: its row of the table, its options, and the keys that light depends on."""

from collections.abc import Mapping
from typing import Any

from octsim.config.models import Config
from octsim.schemes.table import SCHEMES, Scheme


def scheme_of(config: Config) -> Scheme:
    """Return the scheme that a plain config names."""
    return SCHEMES[config.tracing.scheme]


def options_of(config: Config) -> Mapping[str, Any]:
    """Return the values of the scheme's own options."""
    return scheme_of(config).chosen(config.tracing)


def light_keys(config: Config) -> tuple[str, ...]:
    """Return the dotted keys that the light of a point of a plain config depends on."""
    return scheme_of(config).keys
