"""From a user's overlay to a checked config, or to one clear line for each problem."""

import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from octsim.base.errors import ConfigError, OctsimWarning
from octsim.config.checks import impossible
from octsim.config.grid import remarks
from octsim.config.grid_values import expanded
from octsim.config.messages import explain
from octsim.config.models import Config
from octsim.config.overlays import merge, preset, read_overlay


def load_config(*overlays: str | Path | Mapping[str, Any]) -> Config:
    """Lay overlays over the thesis's config and check the result.

    Parameters
    ----------
    *overlays : path or mapping
        YAML or JSON files, or what they would hold; a later one wins. Mappings merge deeply,
        everything else replaces.

    Returns
    -------
    Config
        The whole config, frozen; lengths in µm.

    Raises
    ------
    ConfigError
        If a file can't be read, a key is unknown, or a value has the wrong type, lacks its unit or
        is impossible. Its text has one line for each problem: key path, what was given, what to do.

    Warns
    -----
    OctsimWarning
        If the diameter step is so large that the unwrapped phase is ambiguous.

    Examples
    --------
    >>> load_config({"scene": {"gap": "20 nm"}}).scene.gap
    0.02
    """
    given: dict[str, Any] = {}
    for overlay in overlays:
        given = merge(
            given, overlay if isinstance(overlay, Mapping) else read_overlay(Path(overlay))
        )
    try:
        config = Config.model_validate(merge(merge(Config().to_dict(), preset(given)), given))
    except ValidationError as error:
        raise ConfigError("\n".join(dict.fromkeys(map(explain, error.errors())))) from None
    if config.grid.varied:
        config = expanded(config)
    elif problems := list(impossible(config)):
        raise ConfigError("\n".join(problems))
    for remark in remarks(config):
        warnings.warn(remark, OctsimWarning, stacklevel=2)
    return config
