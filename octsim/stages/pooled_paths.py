"""Light paths of all combinations of a grid, by one code each, whatever their scenes' surfaces."""

import hashlib

import numpy as np
import xarray as xr

from octsim.config.following import scan_diameter
from octsim.config.models import Config
from octsim.instrument.build import scene_of
from octsim.tracing.light_paths import names_of_paths

_TAKEN = 2**62
"""From here on are codes of paths whose own stands for another path in another combination."""


class PathPool:
    """The light paths that were met, by name; each has the code that it was first met with."""

    def __init__(self) -> None:
        self._codes: dict[str, int] = {}
        self._names: dict[int, str] = {}

    def pooled(self, config: Config, part: xr.Dataset) -> xr.Dataset:
        """Return rays of a plain config with the pool's codes of their paths."""
        found, row = np.unique(part["path_code"].values, return_inverse=True)
        scene = scene_of(config, scan_diameter(config))
        names = names_of_paths(scene, config.spectrum.middle, found.tolist())
        codes = [self._code(name, code) for name, code in zip(names, found.tolist(), strict=True)]
        pooled = np.array(codes, np.int64)[row]
        return part.assign(path_code=(part["path_code"].dims, pooled, part["path_code"].attrs))

    def name(self, code: int) -> str:
        """Return the name of a path by its code in the pool."""
        return self._names[code]

    def _code(self, name: str, code: int) -> int:
        if name in self._codes:
            return self._codes[name]
        if code in self._names:
            digest = hashlib.sha256(name.encode()).digest()
            code = _TAKEN + int.from_bytes(digest[:7])
        self._codes[name], self._names[code] = code, name
        return code
