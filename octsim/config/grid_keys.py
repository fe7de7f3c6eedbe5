"""Keys of a grid: which may be varied, also those that a config has only where they are given."""

from octsim.base.errors import ConfigError
from octsim.config.effects import zernike_number
from octsim.config.known_keys import known_keys
from octsim.config.models import FIXED, Config
from octsim.config.nearest import nearest_key

_ZERNIKE = "objective.zernike."
_ATTENUATION = "scene.attenuation."
_INDEX = "scene.refractive_index."


def plain_key(key: str) -> str:
    """Return a key as a checked config has it: Zernike terms by their numbers.

    Raises
    ------
    ConfigError
        If there is no such term.
    """
    if not key.startswith(_ZERNIKE):
        return key
    try:
        return f"{_ZERNIKE}{zernike_number(key.removeprefix(_ZERNIKE))}"
    except ValueError as error:
        raise ConfigError(f"grid.{key}: {error}") from None


def require_varied(config: Config, key: str) -> None:
    """Refuse a key that can't be varied.

    Raises
    ------
    ConfigError
        If it is unknown, or a run has one.
    """
    media = config.scene.refractive_index.given
    attenuated = key.startswith(_ATTENUATION) and key.removeprefix(_ATTENUATION) in media
    if attenuated or key.startswith(_ZERNIKE):
        return  # absent, either is zero
    for section in (_ATTENUATION, _INDEX):
        name = key.removeprefix(section)
        if key.startswith(section) and "." not in name and name not in media:
            raise ConfigError(
                f"grid.{key}: no medium is called {name}; give {_INDEX}{name} in the config first, "
                f"or name one of {', '.join(media)}"
            )
    if key not in set(known_keys(config)):
        raise ConfigError(
            f"grid.{key}: unknown key; write it with dots, as in detector.core_diameter: [...]; "
            f"the nearest known one is {nearest_key(key)}"
        )
    if key.split(".")[0] in FIXED:
        raise ConfigError(f"grid.{key}: can't be varied; a run has one")
