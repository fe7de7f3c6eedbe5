"""The config's section on the scene: media, and the layers and cylinders that are made of them."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, PlainSerializer

from octsim.base.remembered import remembered
from octsim.config.dispersion import MediumIndex, material_of
from octsim.config.fields import Position, PositiveLength, Section, listed
from octsim.config.fields import key as _key
from octsim.config.units import Angle, Attenuation, Length, format_length, parse_length
from octsim.optics.materials import Material

_NAME = r"^[A-Za-z][A-Za-z0-9_-]*$"
Medium = Annotated[str, Field(pattern=_NAME, max_length=100)]
"""Name of a medium."""
Gap = Annotated[Length, Field(ge=0, le=1e6)]
SWEPT = "swept"


class RefractiveIndex(Section):
    """Refractive indices of the media, by their names; other names are free, and must be used."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[Medium, MediumIndex]

    glass: MediumIndex = _key(
        1.52, "slide, and immersion oil where objective.immersion is not given"
    )
    water: MediumIndex = _key(1.33, "around the neuron")
    neuron: MediumIndex = _key(
        1.39,
        "the cylinder; each is a number, {cauchy: [A, B, C]}, {sellmeier: {B: [...], C: [...]}}, "
        "{table: file.csv}, or the name of a material that octsim has",
    )

    @property
    def given(self) -> Mapping[str, Any]:
        """What is given for each medium, by its name."""
        return _by_name(self)

    @property
    def of(self) -> Mapping[str, Material]:
        """Material of each medium by its name."""
        return _materials(self)


class AttenuationConfig(Section):
    """Attenuation of media: of intensity, base e, by absorption and scattering."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[Medium, Annotated[Attenuation, Field(ge=0, le=1e6)]]

    @property
    def of(self) -> Mapping[str, float]:
        """Attenuation of each medium that is named, 1/µm."""
        return _by_name(self)


def _thickness(value: object) -> object:
    if value is None or value == SWEPT:
        return value
    try:
        thickness = parse_length(value)
    except ValueError as error:
        raise ValueError(f"{error}; or 'swept'") from None
    if not 1e-6 <= thickness <= 1e6:
        raise ValueError("it should be from 0.000001 um to 1000000 um")
    return thickness


def _written(value: object) -> object:
    return format_length(value) if isinstance(value, float) else value


class Layer(Section):
    """A layer of the scene: a medium, and how thick it is."""

    medium: Medium
    thickness: Annotated[
        float | Literal["swept"] | None,
        BeforeValidator(_thickness, json_schema_input_type=str | None),
        PlainSerializer(_written, return_type=str | None),
    ] = _key(None, "of a layer between two others")


def _layer(value: object) -> object:
    return Layer(medium=value) if isinstance(value, str) else value


def _entry(layer: Layer) -> object:
    return layer.medium if layer.thickness is None else layer.model_dump(mode="json")


class Shell(Section):
    """A shell of a cylinder."""

    medium: Medium
    thickness: PositiveLength


def _layered(value: tuple[Layer, ...]) -> tuple[Layer, ...]:
    if len(value) < 2:
        raise ValueError("it should name two or more, from below")
    return value


Tilt = Annotated[Angle, Field(ge=-1.5, le=1.5)]
Turn = Annotated[Angle, Field(ge=-6.3, le=6.3)]


class CylinderConfig(Section):
    """A cylinder of the scene; all lengths are of its outermost surface."""

    medium: Medium
    diameter: PositiveLength | None = _key(None, "null is what a sweep varies")
    x: Position = _key("0 um", "where its axis is above the x axis")
    gap: Gap | None = _key(None, "below it, to its layer's lower plane; null is scene.gap")
    azimuth: Turn = _key("0 deg", "angle from the y axis to its axis, positive from +y to −x")
    elevation: Tilt = _key("0 deg", "angle of its axis above the horizontal")
    shells: Annotated[tuple[Shell, ...], BeforeValidator(listed)] = _key(
        (), "{medium, thickness} each, outside in"
    )


class SceneConfig(Section):
    """What the light meets: cylinders and plates between layers; the thesis's neuron on glass."""

    refractive_index: RefractiveIndex = RefractiveIndex()
    attenuation: AttenuationConfig = _key(
        AttenuationConfig(), "of intensity, base e, as {neuron: 100 /cm}"
    )
    gap: Gap = _key("5 nm", "water between the glass and the neuron")
    layers: Annotated[
        tuple[
            Annotated[
                Layer,
                BeforeValidator(_layer, json_schema_input_type=Medium | Layer),
                PlainSerializer(_entry, return_type=Any),
            ],
            ...,
        ],
        BeforeValidator(listed),
        AfterValidator(_layered),
    ] = _key(
        ["glass", "water"],
        "from below, the first ends at z = 0; one between two others as {medium, thickness}; so "
        "is the first, where objective.immersion is given",
    )
    cylinders: Annotated[
        tuple[CylinderConfig, ...], Field(max_length=100), BeforeValidator(listed)
    ] = _key(
        [{"medium": "neuron"}],
        "{medium, diameter, x, gap, azimuth, elevation, shells} each, all but the first optional",
    )

    @property
    def host(self) -> int:
        """Which layer the cylinders lie in (`host_of`)."""
        return host_of(self.layers)

    @property
    def floor(self) -> float:
        """Height of the lower plane of the cylinders' layer, µm."""
        below = (layer.thickness for layer in self.layers[1 : self.host])
        return sum(thick for thick in below if isinstance(thick, float))

    def gap_of(self, cylinder: CylinderConfig) -> float:
        """Return the gap below a cylinder, µm."""
        return self.gap if cylinder.gap is None else cylinder.gap

    @property
    def swept_gap(self) -> float:
        """Gap below the cylinder that is swept, µm; of a swept layer what one would have."""
        return next((self.gap_of(c) for c in self.cylinders if c.diameter is None), self.gap)

    @property
    def swept_gap_key(self) -> str:
        """Dotted key of that gap."""
        own = (
            f"scene.cylinders.{place}.gap"
            for place, cylinder in enumerate(self.cylinders)
            if cylinder.diameter is None and cylinder.gap is not None
        )
        return next(own, "scene.gap")

    @property
    def swept(self) -> tuple[str, ...]:
        """Dotted keys of what has no size of its own; of a scene that is possible just one."""
        return _swept(self.layers, self.cylinders)

    @property
    def media(self) -> Mapping[str, str]:
        """Names of the media that the scene is made of, by the dotted keys that name them."""
        return _media(self.layers, self.cylinders)

    @property
    def objective_medium(self) -> str:
        """Medium that the objective lies in: of the lowest layer."""
        return self.layers[0].medium

    @property
    def host_medium(self) -> str:
        """Medium around the cylinders."""
        return self.layers[self.host].medium

    @property
    def swept_medium(self) -> str:
        """Medium of what is swept: the n_neuron of the formulas is its index, or group index."""
        section, place = self.swept[0].rsplit(".", 1)
        parts = self.cylinders if section == "scene.cylinders" else self.layers
        return parts[int(place)].medium

    @property
    def objective_material(self) -> Material:
        """What is around the objective."""
        return self.refractive_index.of[self.objective_medium]

    @property
    def host_material(self) -> Material:
        """What is around the cylinders."""
        return self.refractive_index.of[self.host_medium]

    @property
    def swept_material(self) -> Material:
        """What is swept is of this."""
        return self.refractive_index.of[self.swept_medium]


@remembered
def _materials(indices: RefractiveIndex) -> Mapping[str, Material]:
    return MappingProxyType({name: material_of(index) for name, index in indices})


@remembered
def _by_name(of_media: Section) -> Mapping[str, Any]:
    return MappingProxyType(dict(of_media))


@remembered
def host_of(layers: tuple[Layer, ...]) -> int:
    """Return which layer cylinders lie in: the last of water, or without one the last of all."""
    water = [place for place, layer in enumerate(layers) if layer.medium == "water"]
    return max(water) if water and max(water) > 0 else len(layers) - 1


@remembered
def _swept(layers: tuple[Layer, ...], cylinders: tuple[CylinderConfig, ...]) -> tuple[str, ...]:
    bodies = (
        f"scene.cylinders.{place}"
        for place, cylinder in enumerate(cylinders)
        if cylinder.diameter is None
    )
    plates = (
        f"scene.layers.{place}" for place, layer in enumerate(layers) if layer.thickness == SWEPT
    )
    return (*bodies, *plates)


@remembered
def _media(layers: tuple[Layer, ...], cylinders: tuple[CylinderConfig, ...]) -> Mapping[str, str]:
    found = {f"scene.layers.{place}": layer.medium for place, layer in enumerate(layers)}
    for place, cylinder in enumerate(cylinders):
        found[f"scene.cylinders.{place}.medium"] = cylinder.medium
        for depth, shell in enumerate(cylinder.shells):
            found[f"scene.cylinders.{place}.shells.{depth}.medium"] = shell.medium
    return MappingProxyType(found)


@remembered
def is_dispersive(scene: SceneConfig) -> bool:
    """Return whether anything in a scene has an index that depends on the wavenumber."""
    of = scene.refractive_index.of
    return any(of[medium].dispersive for medium in scene.media.values())
