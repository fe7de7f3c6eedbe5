"""What no single key can tell: configs that are impossible, and those that are likely not meant."""

import itertools
import math
from collections.abc import Iterator
from typing import Any, get_args

from pydantic import BaseModel

from octsim.base.errors import ConfigError
from octsim.base.remembered import remembered
from octsim.config.abilities import beyond_scheme
from octsim.config.bounds import bounded
from octsim.config.following import fitted_diameters, scan_foci
from octsim.config.immersion import impossible_immersion
from octsim.config.likely import light_remarks
from octsim.config.models import Config, FocusLine
from octsim.config.ranges import DECIMALS, Range
from octsim.config.scene_checks import diameters_of, impossible_scene, least_index, scene_remarks
from octsim.config.source import unlit
from octsim.config.tree import impossible_tree
from octsim.config.units import format_length
from octsim.optics.two_beams import aliasing_step
from octsim.schemes.cost import MOST_WAVENUMBERS, MOST_WAVES, partial_waves, wavenumbers
from octsim.schemes.table import COUNTED_RAYS, SCHEMES

# The two below are measured: `snakemake stability` compares the tracer with one of 50 digits, and
# within them, but for single rays at an edge, no phase is off by more than 1e-9 rad.
LARGEST_DIAMETER = 1e4
"""Diameter (µm) above which the last digit of the axis's height moves the phase by 1e-9 rad."""
LARGEST_GAP = 1e7
"""Gap, in diameters, above which the last digit of a height turns the cylinder's normal."""
_FINEST = 10 * 10.0**-DECIMALS


@remembered
def _ranges(model: BaseModel) -> list[tuple[str, Range]]:
    """Return the ranges of a section and of those in it, by their keys."""
    found: list[tuple[str, Range]] = []
    for name in type(model).model_fields:
        value = getattr(model, name)
        if isinstance(value, Range):
            found.append((name, value))
        elif isinstance(value, BaseModel):
            found += [(f"{name}.{key}", span) for key, span in _ranges(value)]
    return found


def _may_hold_ranges(kind: Any) -> bool:
    """Return whether a section, or a part of one, of a type can be a range or have one."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        fields = kind.model_fields.values()
        return issubclass(kind, Range) or any(_may_hold_ranges(one.annotation) for one in fields)
    return any(map(_may_hold_ranges, get_args(kind)))


_WITH_RANGES = tuple(
    name for name, field in Config.model_fields.items() if _may_hold_ranges(field.annotation)
)


@remembered
def _wrong_ranges(section: BaseModel) -> tuple[tuple[str, str], ...]:
    """Return the keys of a section's ranges that are none, and what is said of each."""
    found = []
    for key, span in _ranges(section):
        if not span.start < span.stop:
            given = span.model_dump(mode="json")
            said = f"{given['start']} given; it must be below"
            found.append((f"{key}.start", f"{said} {{}}.{key}.stop = {given['stop']}"))
        step = (span.stop - span.start) / (span.num - 1)
        if 0 < step < _FINEST:
            said = f"{span.num} given; its values would be {step:.2g} apart, but are rounded to"
            found.append((f"{key}.num", f"{said} 1e-{DECIMALS}; give fewer, or a wider range"))
    return tuple(found)


def highest_focus(config: Config) -> tuple[str, float]:
    """Return the key that asks for the highest focus known before a run, and that focus in µm."""
    fitted = fitted_diameters(config)
    # corners suffice: a product of two ranges is greatest at one
    corners = itertools.product(
        (fitted.start, fitted.stop),
        (config.focus_law.fraction.start, config.focus_law.fraction.stop),
    )
    foci = {
        "focus_scan.focus.stop": scan_foci(config).stop,
        "focus_law.fraction.stop": max(map(math.prod, corners)),
    }
    if isinstance(config.sweep.focus, FocusLine):
        line, diameters = config.sweep.focus, config.sweep.diameters
        ends = (diameters.start, diameters.stop)
        foci["sweep.focus"] = max(map(line.at, ends))
    return max(foci.items(), key=lambda item: item[1])


def impossible(config: Config) -> Iterator[str]:
    """Return what is impossible though each key alone is fine, a line each."""
    if of_scene := list(impossible_scene(config)):
        yield from of_scene
    else:
        yield from beyond_scheme(config)
        yield from impossible_tree(config)
        yield from _below_objective(config)
        yield from impossible_immersion(config)
    band = config.spectrum.wavelength
    if not band.min < band.max:
        yield (
            f"spectrum.wavelength.min: {format_length(band.min)} given; it must be below "
            f"spectrum.wavelength.max = {format_length(band.max)}"
        )
    else:
        yield from unlit(config.spectrum.source, config.spectrum.wavelength)
    for place, tried in enumerate(config.design.bands):
        if not tried.min < tried.max:
            yield (
                f"design.bands.{place}.min: {format_length(tried.min)} given; it must be below "
                f"design.bands.{place}.max = {format_length(tried.max)}"
            )
    processing = config.processing
    if processing.estimator == "sinusoid" and processing.sinusoid.envelope == "common":
        yield (
            "processing.sinusoid.envelope: 'common' given, which is for a series at one diameter; "
            "a sweep needs 'each'"
        )
    for section in _WITH_RANGES:
        for key, said in _wrong_ranges(getattr(config, section)):
            yield f"{section}.{key}: {said.format(section)}"
    key, focus = highest_focus(config)
    distance = config.objective.focus_distance
    by = ""
    if (shift := config.objective.focal_shift) and shift.moves:
        most = shift.formula.highest(*sorted((band.min, band.max)))
        by, focus = f", of which objective.focal_shift is {most:.6g} um", focus + most
    if not distance > focus:
        yield (
            f"objective.focus_distance: {format_length(distance)} given; it must exceed every "
            f"focus, and {key} asks for one at {focus:.10g} um{by} (the objective lies in "
            f"{config.scene.objective_medium})"
        )


def _below_objective(config: Config) -> Iterator[str]:
    aperture, scene = config.objective.numerical_aperture, config.scene
    medium, index = scene.objective_medium, least_index(config, scene.objective_medium)
    if not aperture < index:
        yield (
            f"objective.numerical_aperture: {aperture} given; it must be below the index of "
            f"{medium}, scene.refractive_index.{medium} = {index}"
        )
    host, host_index = scene.host_medium, least_index(config, scene.host_medium)
    scheme = SCHEMES[config.tracing.scheme]
    if scheme.light == "waves" and not aperture < host_index:
        rays = " or ".join(name for name, other in SCHEMES.items() if other.light == "rays")
        yield (
            f"objective.numerical_aperture: {aperture} given, but tracing.scheme: {scheme.name} "
            f"has no light that decays in {host}; give one below scene.refractive_index.{host} = "
            f"{host_index}, or tracing.scheme: {rays}"
        )


def require_possible(config: Config) -> None:
    """Refuse a config that is impossible.

    Raises
    ------
    ConfigError
        If it is; one line for each problem.
    """
    if problems := bounded(impossible(config)):
        raise ConfigError(*problems)


def _steep_remarks(config: Config) -> Iterator[str]:
    aperture, water = config.objective.numerical_aperture, config.host_index
    scheme = SCHEMES[config.tracing.scheme]
    if scheme.steepest * water < aperture:
        yield (
            f"tracing.scheme: {scheme.name!r} with a numerical aperture of {aperture}, above "
            f"{scheme.steepest} of the index of water, {water}: light near grazing incidence can "
            f"be missed, and the error with it; compare with {COUNTED_RAYS.name!r}"
        )


def _budget_remarks(config: Config) -> Iterator[str]:
    """Say where scheme fullwave will stop at its budget."""
    tracing, scene = config.tracing, config.scene
    if SCHEMES[tracing.scheme].light != "waves":
        return
    band = config.spectrum.wavelength
    k_min, k_max = 2 * math.pi / band.max, 2 * math.pi / band.min
    digits = -math.log10(tracing.accuracy)
    diameters = diameters_of(config)
    key, largest = max(diameters.items(), key=lambda item: item[1])
    swept, host = config.swept_index, config.host_index
    size = k_max * max(swept, host) * largest / 2
    reach = swept * largest + host * scene.swept_gap
    waves = partial_waves(size, digits)
    nodes = wavenumbers(reach, k_max - k_min, digits)
    instead = "so spectra will say budget_spent; give less, or a tracing.scheme of rays"
    if waves > MOST_WAVES:
        yield (
            f"{key}: {format_length(largest)} takes some {waves:.0f} partial waves by "
            f"tracing.scheme: {tracing.scheme}, which has at most {MOST_WAVES}, {instead}"
        )
    elif nodes > MOST_WAVENUMBERS:
        key, length = max(
            (("scene.gap", scene.swept_gap), (key, largest)), key=lambda item: item[1]
        )
        yield (
            f"{key}: {format_length(length)} takes some {nodes:.0f} wavenumbers by "
            f"tracing.scheme: {tracing.scheme}, which has at most {MOST_WAVENUMBERS}, {instead}"
        )


def rounding_remarks(config: Config) -> list[str]:
    """Say, a line each, where rounding can move the phase by more than 1e-9 rad."""
    said = []
    diameters = diameters_of(config)
    key, largest = max(diameters.items(), key=lambda item: item[1])
    if largest > LARGEST_DIAMETER:
        said.append(
            f"{key}: {format_length(largest)} is above {format_length(LARGEST_DIAMETER)}, so "
            "rounding of the cylinder's height can move the phase by more than 1e-9 rad"
        )
    gap = config.scene.swept_gap
    key, smallest = min(diameters.items(), key=lambda item: item[1])
    if gap > LARGEST_GAP * smallest:
        said.append(
            f"scene.gap: {format_length(gap)} is above {LARGEST_GAP:g} times {key} = "
            f"{format_length(smallest)}, so rounding of heights can move the phase by more than "
            "1e-9 rad"
        )
    aperture, water = config.objective.numerical_aperture, config.host_index
    if water < aperture:
        said.append(
            f"objective.numerical_aperture: {aperture} is above the index of water, {water}, so "
            "some rays are close to the critical angle, where rounding can move the phase by more "
            "than 1e-9 rad"
        )
    return said


def plain_remarks(config: Config) -> list[str]:
    """Return what is possible but likely not meant, a line each, of a config without a grid."""
    said = [*_steep_remarks(config), *_budget_remarks(config), *scene_remarks(config)]
    said += light_remarks(config)
    band, diameters = config.spectrum.wavelength, config.sweep.diameters
    k_min, k_max = 2 * math.pi / band.max, 2 * math.pi / band.min
    step = diameters.largest_step
    largest = aliasing_step(config.swept_material, k_min, k_max)
    if step > largest:
        said.append(
            f"sweep.diameters: a step of {step:.6g} um is above π/(n_neuron (k_min + k_max)) = "
            f"{largest:.6g} um, so the unwrapped phase is ambiguous and its slope can be wrong; "
            "raise sweep.diameters.num"
        )
    # of cos(2ndk) over the band, per µm
    oscillations = config.swept_group_index * (k_max - k_min) / math.pi
    if oscillations * diameters.start < 1:
        said.append(
            f"sweep.diameters.start: {format_length(diameters.start)} is less than one oscillation "
            f"of the spectrum, {1 / oscillations:.3g} um, so its phase means little; raise it or "
            "widen spectrum.wavelength"
        )
    needed = math.ceil(2 * oscillations * diameters.stop) + 1
    if config.spectrum.samples < needed:
        said.append(
            f"spectrum.samples: {config.spectrum.samples} do not resolve the oscillations of the "
            f"largest diameter; give {needed} or more"
        )
    fitted = fitted_diameters(config)
    beyond = diameters.start < fitted.start or diameters.stop > fitted.stop
    if config.sweep.focus == "law" and beyond:
        said.append(
            f"sweep.diameters: from {format_length(diameters.start)} to "
            f"{format_length(diameters.stop)} is beyond the diameters that the focus law is fitted "
            f"to, {format_length(fitted.start)} to {format_length(fitted.stop)}; widen "
            "focus_law.diameters"
        )
    return said + rounding_remarks(config)
