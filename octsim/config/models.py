"""The config: what a user may set, its defaults (the thesis) and its limits.

The models are the one source: `config/schema.json` and `docs/config.md` are generated from them,
`config/default.yaml` is tested against them.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

from pydantic import BeforeValidator, ConfigDict, Discriminator, Field, Tag, model_validator

from octsim.config.archive import ArchiveConfig
from octsim.config.calibration import ActionPotential, Calibration, ExpansionConfig
from octsim.config.design import Design
from octsim.config.effects import BeamConfig, DetectorConfig, Interferometer
from octsim.config.fields import (
    Number,
    Position,
    PositiveLength,
    Section,
)
from octsim.config.fields import key as _key
from octsim.config.light import FibreMode, GaussianFill, PolarisationConfig
from octsim.config.light import Objective as Objective
from octsim.config.measured import Measured as Measured
from octsim.config.pixels import with_lab_pixels
from octsim.config.processing import Processing as Processing
from octsim.config.ranges import Diameters, FocusRange, FractionRange
from octsim.config.resources import Budget, Scatter
from octsim.config.resources import Cache as Cache
from octsim.config.responses import Responses
from octsim.config.scene import RefractiveIndex as RefractiveIndex
from octsim.config.scene import SceneConfig as SceneConfig
from octsim.config.scene import is_dispersive
from octsim.config.spectrum import Spectrum as Spectrum
from octsim.config.spectrum import Wavelengths as Wavelengths
from octsim.optics.materials import Material, group_index
from octsim.schemes.table import COUNTED_RAYS, PRESETS, SCHEMES

if TYPE_CHECKING:
    from typing import TypeAlias

    import numpy as np
    from numpy.typing import NDArray

    SchemeName: TypeAlias = str
    PresetName: TypeAlias = str
else:  # a scheme is a row of the table, and nothing more to be listed here
    SchemeName, PresetName = Literal[tuple(SCHEMES)], Literal[tuple(PRESETS)]


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
    max_intersections: Annotated[int, Field(ge=1, le=60)] = _key(
        11, "meetings with planes and cylinders on one ray"
    )
    min_amplitude: Annotated[Number, Field(ge=0, lt=1)] = _key(
        0.0, "a fainter counted ray is dropped; relative to the launch amplitude"
    )


class FocusScan(Section):
    """Figure 6: one diameter, many foci."""

    diameter: PositiveLength | None = _key("2 um", "of the cylinder; null is the sweep's middle")
    focus: FocusRange | None = _key(
        {"start": "-1 um", "stop": "4 um", "num": 501},
        "height of the focus above the glass; null is from -0.5 to 2 diameters",
    )


class FocusLawConfig(Section):
    """Figure 7: the focus of greatest intensity for some diameters, and the line through them."""

    diameters: Diameters | None = _key(
        {"start": "0.8 um", "stop": "2.4 um", "num": 9},
        "of the cylinder; null is the sweep's range, 9 or more that are 0.2 um apart at most",
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

    diameters: Diameters = _key({"start": "1 um", "stop": "2 um", "num": 151}, "of the cylinder")
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


_NO_RESULT = ("archive", "cache", "scatter")


FIXED = (
    "run", "calibration", "measured", "expansion", "action_potential", "responses", "design",
    "grid", "archive", "cache", "budget", "scatter",
)  # fmt: skip
"""Sections that a run has once: what no stage over the grid depends on."""


class Config(Section):
    """A whole run. Every value has the thesis's as its default.

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config({"objective": {"numerical_aperture": 0.8}})
    >>> config.objective.numerical_aperture, config.scene.gap
    (0.8, 0.005)
    """

    # an editor that reads the schema shows what the config is, not how Python reads it
    model_config = ConfigDict(
        json_schema_extra=lambda schema: schema.update(
            description=str(schema["description"]).partition("\n")[0]
        )
    )

    run: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$", max_length=100)] = _key(
        "thesis", "name of the run: datasets and figures go to results/<run>/"
    )
    scene: SceneConfig = SceneConfig()
    objective: Objective = Objective()
    beam: BeamConfig = BeamConfig()
    polarisation: PolarisationConfig = PolarisationConfig()
    detector: DetectorConfig = DetectorConfig()
    interferometer: Interferometer = Interferometer()
    tracing: Tracing = Tracing()
    spectrum: Spectrum = Spectrum()
    focus_scan: FocusScan = FocusScan()
    focus_law: FocusLawConfig = FocusLawConfig()
    sweep: Sweep = Sweep()
    processing: Processing = Processing()
    calibration: Calibration = Calibration()
    measured: Measured = Measured()
    expansion: ExpansionConfig = ExpansionConfig()
    action_potential: ActionPotential = ActionPotential()
    responses: Responses = Responses()
    design: Design = Design()
    grid: Annotated[Grid, BeforeValidator(lambda given: {} if given is None else given)] = Grid()
    archive: ArchiveConfig = ArchiveConfig()
    cache: Cache = Cache()
    budget: Budget = Budget()
    scatter: Scatter = Scatter()

    @model_validator(mode="before")
    @classmethod
    def _lab_pixels(cls, data: Any) -> Any:
        return with_lab_pixels(data)

    def __repr__(self) -> str:
        from octsim.config.resolved_text import differing  # here, as that is of configs

        return f"octsim.load_config({differing(self) or ''})"

    __str__ = __repr__

    @property
    def pupil(self) -> GaussianFill | FibreMode | Literal["uniform"]:
        """How light fills the pupil, of a plain config: as given, or the scheme's own way."""
        if self.objective.pupil is not None:
            return self.objective.pupil
        own = SCHEMES[self.tracing.scheme].mode_field_diameter
        return "uniform" if own is None else FibreMode.model_construct(fibre=own)

    @property
    def media(self) -> Mapping[str, str]:
        """Names of the media of scene and immersion, by the dotted keys that name them."""
        immersion = self.objective.immersion
        own = {} if immersion is None else {"objective.immersion": immersion}
        return {**self.scene.media, **own}

    @property
    def objective_material(self) -> Material:
        """What is around the objective."""
        return self.scene.objective_material

    @property
    def host_material(self) -> Material:
        """What is around the cylinders."""
        return self.scene.host_material

    @property
    def swept_material(self) -> Material:
        """What is swept is of this."""
        return self.scene.swept_material

    @property
    def objective_index(self) -> float:
        """Refractive index around the objective, in the middle of the band."""
        return self._index_of(self.objective_material)

    @property
    def host_index(self) -> float:
        """Refractive index around the cylinders, in the middle of the band."""
        return self._index_of(self.host_material)

    @property
    def swept_index(self) -> float:
        """Refractive index of what is swept, in the middle of the band."""
        return self._index_of(self.swept_material)

    @property
    def swept_group_index(self) -> float:
        """Group index of what is swept, in the middle of the band: of optical depths."""
        return group_index(self.swept_material, self.spectrum.middle)

    @property
    def dispersive(self) -> bool:
        """Whether anything in the scene has an index that depends on the wavenumber."""
        return is_dispersive(self.scene)

    def _index_of(self, material: Material) -> float:
        return material.index(self.spectrum.middle).real

    def to_dict(self) -> dict[str, Any]:
        """Return the config as plain data that `load_config` reads back to the same bits."""
        return self.model_dump(mode="json")

    def to_record(self) -> dict[str, Any]:
        """Return what results can depend on, as plain data: what their datasets record."""
        return {k: part for k, part in self.to_dict().items() if k not in _NO_RESULT}
