"""The config: what a user may set, its defaults (the thesis) and its limits.

The models are the one source: `config/schema.json` and `docs/config.md` are generated from them,
`config/default.yaml` is tested against them.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

from pydantic import BeforeValidator, ConfigDict, Discriminator, Field, Tag

from octsim.config.archive import ArchiveConfig
from octsim.config.calibration import ActionPotential, Calibration, ExpansionConfig
from octsim.config.design import Design
from octsim.config.fields import (
    DiameterRange,
    FocusRange,
    FractionRange,
    Number,
    Position,
    PositiveLength,
    PositiveNumber,
    Section,
    Wavelength,
)
from octsim.config.fields import key as _key
from octsim.config.light import FibreMode, GaussianFill, PolarisationConfig
from octsim.config.light import Objective as Objective
from octsim.config.processing import Processing as Processing
from octsim.config.scene import RefractiveIndex as RefractiveIndex
from octsim.config.scene import SceneConfig as SceneConfig
from octsim.optics.band import wavenumbers
from octsim.schemes.table import COUNTED_RAYS, PRESETS, SCHEMES

if TYPE_CHECKING:
    from typing import TypeAlias

    import numpy as np
    from numpy.typing import NDArray

    SchemeName: TypeAlias = str
    PresetName: TypeAlias = str
else:  # a scheme is a row of the table, and nothing more to be listed here
    SchemeName, PresetName = Literal[tuple(SCHEMES)], Literal[tuple(PRESETS)]


class DetectorConfig(Section):
    """The fibre that collects the light."""

    core_diameter: PositiveLength = _key(
        "4.4 um", "of the fibre; R_det = core_diameter / (2 magnification)"
    )


class Tracing(Section):
    """How rays are placed and how far each is followed."""

    preset: PresetName | None = _key(
        None, "a named scheme and accuracy, for those that are not given beside it"
    )
    scheme: SchemeName = _key(
        COUNTED_RAYS.name, "the thesis's sunflower spiral, or each light path to a stated accuracy"
    )
    accuracy: Annotated[Number, Field(ge=1e-12, le=0.1)] = _key(
        1e-4, "of the scheme paths: largest error of the intensity over the largest intensity"
    )
    rays: Annotated[int, Field(ge=1, le=10_000_000)] = _key(3000, "at the objective")
    max_intersections: Annotated[int, Field(ge=1, le=30)] = _key(
        11, "meetings with the plane and the cylinder on one ray"
    )
    min_amplitude: Annotated[Number, Field(ge=0, lt=1)] = _key(
        0.0, "a fainter counted ray is dropped; relative to the launch amplitude"
    )


class Wavelengths(Section):
    """The band, in vacuum."""

    min: Wavelength = _key("650 nm", "shortest wavelength")
    max: Wavelength = _key("900 nm", "longest wavelength")


class Spectrum(Section):
    """The flat spectrum of the source and the samples taken of it."""

    wavelength: Wavelengths = Wavelengths()
    samples: Annotated[int, Field(ge=2, le=1_000_000)] = _key(
        1000, "wavenumbers, evenly spaced, both ends included"
    )

    def wavenumbers(self) -> "NDArray[np.float64]":
        """Return the wavenumbers 2π/λ, evenly spaced and increasing, shape (K,), 1/µm."""
        return wavenumbers(self.wavelength.min, self.wavelength.max, self.samples)


class FocusScan(Section):
    """Figure 6: one diameter, many foci."""

    diameter: PositiveLength = _key("2 um", "of the cylinder")
    focus: FocusRange = _key(
        {"start": "-1 um", "stop": "4 um", "num": 501},
        "height of the focus above the glass",
    )


class FocusLawConfig(Section):
    """Figure 7: the focus of greatest intensity for some diameters, and the line through them."""

    diameters: DiameterRange = _key(
        {"start": "0.8 um", "stop": "2.4 um", "num": 9}, "of the cylinder"
    )
    fraction: FractionRange = _key(
        {"start": 0.4, "stop": 0.8, "num": 41},
        "foci tried, as fractions of the diameter",
    )


_Lengths = TypeVar("_Lengths", float, "NDArray[np.float64]")


class FocusLine(Section):
    """A given focus law: focus = slope · diameter + intercept; slope 0 is a fixed focus."""

    slope: Annotated[Number, Field(ge=-1e6, le=1e6)]
    intercept: Position

    @classmethod
    def fitted(cls, law: Any) -> "FocusLine":
        """Return the line of a fitted law: a `focus_law` dataset."""
        return cls.model_construct(slope=float(law["slope"]), intercept=float(law["intercept"]))

    def at(self, diameter: _Lengths) -> _Lengths:
        """Return the focus for each diameter, both in µm."""
        return self.slope * diameter + self.intercept


def _focus_kind(value: object) -> str:
    return "line" if isinstance(value, Mapping | FocusLine) else "law"


class Sweep(Section):
    """Figures 8 to 12: the diameters whose spectra are made."""

    diameters: DiameterRange = _key(
        {"start": "1 um", "stop": "2 um", "num": 151}, "of the cylinder"
    )
    focus: Annotated[
        Annotated[Literal["law"], Tag("law")] | Annotated[FocusLine, Tag("line")],
        Discriminator(_focus_kind),
    ] = _key("law", "law (the fitted one), or {slope: 0.581, intercept: 69 nm}")


class Grid(Section):
    """Keys that are varied: each dotted key has a list of values or a range of them.

    A checked config holds them as lists, in the config's own units.
    """

    model_config = ConfigDict(
        extra="allow",
        json_schema_extra={
            "additionalProperties": {
                "description": "a dotted key of the config, and the values that it takes",
                "anyOf": [
                    {"type": "array", "minItems": 1},
                    {
                        "type": "object",
                        "properties": {
                            "start": {"type": ["number", "string"]},
                            "stop": {"type": ["number", "string"]},
                            "num": {"type": "integer", "minimum": 2},
                        },
                        "required": ["start", "stop", "num"],
                        "additionalProperties": False,
                    },
                ],
            }
        },
    )

    combine: Literal["product", "zip"] = _key(
        "product", "every value with every other, or first with first and so on"
    )

    @property
    def varied(self) -> Mapping[str, Any]:
        """Values of each varied key."""
        return self.model_extra or {}


class Cache(Section):
    """Where traced points are kept; no result depends on it."""

    file: Annotated[str, Field(min_length=1)] = _key(
        ".octsim/points", "folder for them, beside the run's results or one that several share"
    )
    gigabytes: Annotated[Number, Field(ge=0, le=1e6)] = _key(
        4.0, "its largest size; 0 keeps and reads nothing"
    )


class Budget(Section):
    """What a run may take by its estimate; raise it to confirm a larger one."""

    cpu_hours: PositiveNumber = _key(1.0, "processor time")
    disk_gigabytes: PositiveNumber = _key(20.0, "datasets of the run")


class Scatter(Section):
    """How a stage that takes long is scattered over several jobs; no result depends on it."""

    minutes: PositiveNumber = _key(5.0, "of processor time in a job, by the run's estimate")


_NO_RESULT = ("archive", "cache", "scatter")


FIXED = (
    "run", "calibration", "expansion", "action_potential", "design", "grid", "archive", "cache",
    "budget", "scatter",
)  # fmt: skip
"""Sections that a run has once: what no stage over the grid depends on."""


class Config(Section):
    """A whole run. Every value has the thesis's as its default."""

    run: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$", max_length=100)] = _key(
        "thesis", "name of the run: datasets and figures go to results/<run>/"
    )
    scene: SceneConfig = SceneConfig()
    objective: Objective = Objective()
    polarisation: PolarisationConfig = PolarisationConfig()
    detector: DetectorConfig = DetectorConfig()
    tracing: Tracing = Tracing()
    spectrum: Spectrum = Spectrum()
    focus_scan: FocusScan = FocusScan()
    focus_law: FocusLawConfig = FocusLawConfig()
    sweep: Sweep = Sweep()
    processing: Processing = Processing()
    calibration: Calibration = Calibration()
    expansion: ExpansionConfig = ExpansionConfig()
    action_potential: ActionPotential = ActionPotential()
    design: Design = Design()
    grid: Annotated[Grid, BeforeValidator(lambda given: {} if given is None else given)] = Grid()
    archive: ArchiveConfig = ArchiveConfig()
    cache: Cache = Cache()
    budget: Budget = Budget()
    scatter: Scatter = Scatter()

    @property
    def pupil(self) -> GaussianFill | FibreMode | Literal["uniform"]:
        """How light fills the pupil, of a plain config: as given, or the scheme's own way."""
        if self.objective.pupil is not None:
            return self.objective.pupil
        own = SCHEMES[self.tracing.scheme].mode_field_diameter
        return "uniform" if own is None else FibreMode.model_construct(fibre=own)

    def to_dict(self) -> dict[str, Any]:
        """Return the config as plain data that `load_config` reads back to the same bits."""
        return self.model_dump(mode="json")

    def to_record(self) -> dict[str, Any]:
        """Return what results can depend on, as plain data: what their datasets record."""
        return {k: part for k, part in self.to_dict().items() if k not in _NO_RESULT}
