"""What the catalog says of a dataset and of a figure: a row of it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from octsim.base.named import named
from octsim.config.models import Config
from octsim.schemes.table import COUNTED_RAYS

if TYPE_CHECKING:
    import xarray as xr

LIGHT = "(light)"
"""Stands for the keys that the light of a point depends on, which are the scheme's to say."""
RAYS = "(rays)"
"""Stands for the keys that light depends on by rays, for a scheme that has none."""
SUMMING = "(summing)"
"""Stands for the keys of the scheme that a sum over the wavenumbers depends on."""


COUNTED = COUNTED_RAYS.keys
"""Keys that a number of rays depends on."""


@dataclass(frozen=True)
class Figure:
    """A figure that is drawn from datasets."""

    name: str
    draw: str
    """The function that draws it, ``"module:function"``; it takes the datasets in their order."""
    caption: str
    """What it shows."""
    of: tuple[str, ...] = ()
    """Datasets that it is drawn from, as far as a run has them; without any named, the one whose
    row it stands in."""
    without: tuple[str, ...] = ()
    """Variables that it does not need, and that may be large."""
    over_grid: bool = False
    """Whether it shows datasets over a grid; the others show those of a plain config."""


@dataclass(frozen=True)
class Stage:
    """A dataset, in ``<name>.nc``."""

    name: str
    make: str
    """The function that makes it, ``"module:function"``. It takes the config and the datasets that
    this one comes after, those by keyword that it has a parameter of the name for; and of the
    keywords threads, points, share and prepare what it names."""
    message: str
    """What making it is, in a few words."""
    reads: tuple[str, ...] = ()
    """Dotted keys of the config that it reads itself, or what stands for some."""
    after: tuple[str, ...] = ()
    """Datasets that it is made from."""
    job: str = ""
    """The job that makes it, with others of the same name; its own, unless it says so."""
    points: Callable[[Config], tuple[int, int]] | None = None
    """Of a stage that traces, and so may take long and is scattered then: returns how many rows its
    blocks are cut from, and how many points each has."""
    light: str = ""
    """Of a dataset that a run has for schemes of one kind of light only: that kind."""
    sums: bool = True
    """Whether a stage that traces sums its light to intensities, or keeps it."""
    per_sample: tuple[float, float] = (0.0, 0.0)
    """Of one that works on the sweep's spectra: processor time (s) and bytes of each sample."""
    beside: bool = False
    """Whether it is beside a run, of a single config, and made when it is asked for."""
    plates: bool = False
    """Whether one beside a run is of scenes without a cylinder too."""
    summary: str = ""
    """The function that says in one line what the dataset comes to, if there is one."""
    doubts: str = ""
    """The function that says, a line each, where it is not what one would want."""
    figures: tuple[Figure, ...] = ()

    def serves(self, config: Config) -> bool:
        """Return whether it has anything to say of a config's scene."""
        return self.plates or not self.beside or bool(config.scene.cylinders)

    @property
    def rule(self) -> str:
        """Name of the job that makes it."""
        return self.job or self.name

    @property
    def traces(self) -> bool:
        """Whether it traces points of a sweep."""
        return self.points is not None

    @property
    def needs_light(self) -> bool:
        """Whether it looks for light itself."""
        return self.traces or any(key.startswith((LIGHT, RAYS, "tracing")) for key in self.reads)

    @property
    def counts_rays(self) -> bool:
        """Whether it counts rays, whatever the run's scheme is."""
        return set(COUNTED) <= set(self.reads)

    @property
    def module(self) -> str:
        """Module that makes it."""
        return self.make.partition(":")[0]

    def doubts_of(self, dataset: "xr.Dataset") -> list[str]:
        """Return, a line each, where its dataset is not what one would want."""
        return list(named(self.doubts)(dataset)) if self.doubts else []
