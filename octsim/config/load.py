"""From a user's overlay to a checked config, or to one clear line for each problem."""

import re
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from octsim.base.errors import ConfigError, OctsimWarning, one_line
from octsim.config.bounds import bounded, require_bounded
from octsim.config.checks import plain_remarks, require_possible
from octsim.config.derive import merge, overlaid, validated
from octsim.config.fields import plain_data
from octsim.config.grid_values import expanded
from octsim.config.handed import Handed, hand, handed
from octsim.config.models import Config
from octsim.config.overlay_file import read_overlay as read_overlay
from octsim.config.study_checks import wrong_for_studies
from octsim.config.unread import asked_for, unread, unread_scene

_AFTER_COMMA = re.compile(r"[0-9]+( ?[^\W\d]\S*)?")


def require_points(given: Any, prefix: str = "") -> None:
    """Refuse what YAML makes of a decimal comma in braces: 1 for a key, and 39 as the next key.

    Raises
    ------
    ConfigError
        If there is one.
    """
    before: tuple[Any, Any] | None = None
    if isinstance(given, list):
        given = dict(enumerate(given))
    for key, value in given.items() if isinstance(given, Mapping) else ():
        if before and value is None and _AFTER_COMMA.fullmatch(str(key)):
            name, whole = before
            if isinstance(whole, int) and not isinstance(whole, bool):
                raise ConfigError(
                    f"{prefix}{name}: {whole},{key} given; write it with a point, as {whole}.{key}"
                )
        require_points(value, f"{prefix}{key}.")
        before = key, value


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
        If something is possible but likely not meant, such as a diameter step that is so large that
        the unwrapped phase is ambiguous, or a key that is given and not read.

    Examples
    --------
    >>> import octsim
    >>> octsim.load_config({"scene": {"gap": "20 nm"}}).scene.gap
    0.02
    """
    config, said = load_and_tell(*overlays)
    for remark in said:
        warnings.warn(remark, OctsimWarning, stacklevel=2)
    return config


def load_and_tell(*overlays: str | Path | Mapping[str, Any]) -> tuple[Config, list[str]]:
    """Return the config as `load_config` does, and what that warns of, a line each."""
    try:
        return _loaded(overlays)
    except ConfigError as error:
        raise ConfigError(*bounded(str(error).splitlines())) from None


def load_checked(overlay: Mapping[str, Any]) -> Config:
    """Return the config of a run's job, whose combinations the workflow has looked at before.

    Raises
    ------
    ConfigError
        If a key or a value is wrong.
    """
    given = plain_data(overlay)
    if given.get("grid") and (found := handed(given)):
        return validated(found.config)
    config = validated(overlaid(Config().to_dict(), given))
    return expanded(config, whole=False)[0] if config.grid.varied else config


def _loaded(overlays: Iterable[str | Path | Mapping[str, Any]]) -> tuple[Config, list[str]]:
    given: dict[str, Any] = {}
    asked: dict[str, Any] = {}
    for overlay in overlays:
        if isinstance(overlay, Mapping):
            require_bounded(overlay)
        own = plain_data(overlay if isinstance(overlay, Mapping) else read_overlay(Path(overlay)))
        require_points(own)
        asked |= asked_for(own, given)
        given = merge(given, own)
    if given.get("grid") and (found := handed(given)):
        return validated(found.config), found.said
    config = validated(overlaid(Config().to_dict(), given))
    if config.grid.varied:
        config, said = expanded(config)
    else:
        require_possible(config)
        said = plain_remarks(config)
    # here alone: studies of other scenes leave out what these do not have
    if wrong := bounded(wrong_for_studies(config)):
        raise ConfigError(*wrong)
    said = [*said, *unread(config, asked), *unread_scene(config, asked)]
    said = list(map(one_line, said))
    if config.grid.varied:
        hand(given, Handed(config.to_dict(), said))
    return config, said
