"""Materials: what refracts and absorbs light, wherever in a scene it is."""

from dataclasses import dataclass
from typing import Protocol


class Material(Protocol):
    """What has a complex refractive index at each wavenumber."""

    def index(self, wavenumber: float) -> complex:
        """Return n + iκ at a wavenumber, 1/µm in vacuum; κ > 0 absorbs."""
        ...


@dataclass(frozen=True)
class Constant:
    """A material of one real refractive index at all wavenumbers."""

    n: float

    def index(self, wavenumber: float) -> complex:  # noqa: ARG002
        """Return n, whatever the wavenumber."""
        return complex(self.n)
