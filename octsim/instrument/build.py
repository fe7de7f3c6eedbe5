"""A config as optics: its scene, its objective and its detector. It becomes that nowhere else."""

from __future__ import annotations

from collections import Counter
from itertools import accumulate
from math import pi
from typing import TYPE_CHECKING

import octsim.optics.shipped_materials  # noqa: F401  what a name in a config stands for
from octsim.config.following import scan_diameter
from octsim.config.immersion import aberration_terms
from octsim.optics.detector import Detector, fibre_detector
from octsim.optics.effects import Effects, ReferenceArm, Waist
from octsim.optics.falloff import (
    Cosine,
    Falloff,
    FibreFalloff,
    GaussianFalloff,
    Parabolic,
    TopHat,
)
from octsim.optics.layered import Body, Layer, layered, plates
from octsim.optics.polarisation import LEFT, RIGHT, Polarisation, linear
from octsim.optics.pupil import FibrePupil, GaussianPupil, Pupil, UniformPupil
from octsim.optics.scene import Region, Scene
from octsim.optics.zernike import Aberration
from octsim.schemes.light import Optics

if TYPE_CHECKING:
    # what light is traced through follows from values of the config, not from how it is read
    from octsim.config.models import Config, SceneConfig


def detector_of(config: Config) -> Detector:
    """Return the objective as a receiver, and the fibre."""
    objective = config.objective
    return fibre_detector(
        objective.numerical_aperture, config.objective_index,
        objective.focus_distance, objective.magnification, config.detector.core_diameter,
    )  # fmt: skip


def scene_of(config: Config, diameter: float) -> Scene:
    """Return the scene of a config: layers, and the cylinders in one of them.

    Parameters
    ----------
    config : Config
        A plain one.
    diameter : float
        Of the cylinder, or thickness of the plate that is swept, µm.
    """
    scene = config.scene
    if not scene.cylinders:
        return _plates(scene, diameter)

    def region(medium: str) -> Region:
        taken = scene.attenuation.of.get(medium, 0.0)
        return Region(medium, scene.refractive_index.of[medium], taken)

    layers = [
        Layer(
            region(layer.medium), *([thick] if isinstance(thick := layer.thickness, float) else [])
        )
        for layer in scene.layers
    ]
    bodies = [
        Body(
            (*(region(shell.medium) for shell in cylinder.shells), region(cylinder.medium)),
            tuple(shell.thickness for shell in cylinder.shells),
            diameter if cylinder.diameter is None else cylinder.diameter,
            scene.gap_of(cylinder), cylinder.x, cylinder.azimuth, cylinder.elevation,
        )
        for cylinder in scene.cylinders
    ]  # fmt: skip
    return layered(layers, scene.host, bodies)


def _plates(scene: SceneConfig, thickness: float) -> Scene:
    """Return the layers of a scene; those of one medium that follow each other are one."""
    inner = (
        layer.thickness if isinstance(layer.thickness, float) else thickness
        for layer in scene.layers[1:-1]
    )
    named: Counter[str] = Counter()
    regions: list[Region] = []
    heights: list[float] = []
    last = None
    for layer, height in zip(scene.layers, (None, *accumulate(inner, initial=0.0)), strict=True):
        medium = layer.medium
        if medium == last:
            continue
        last = medium
        named[medium] += 1
        # regions are told apart by their names
        name = medium if named[medium] == 1 else f"{medium} {named[medium]}"
        taken = scene.attenuation.of.get(medium, 0.0)
        regions.append(Region(name, scene.refractive_index.of[medium], taken))
        if height is not None:
            heights.append(height)
    return plates(regions, heights)


def surface_names(config: Config) -> tuple[str, ...]:
    """Return the short names of the scene's surfaces, of which those of light paths are made."""
    return scene_of(config, scan_diameter(config)).surface_names


def pupil_of(config: Config) -> Pupil:
    """Return the pupil: the one that a config gives, or its scheme's own."""
    match config.pupil:
        case object(gaussian=fill):
            return GaussianPupil(fill)
        case object(fibre=mode_field_diameter):
            return FibrePupil(mode_field_diameter, config.objective.magnification)
        case _:
            return UniformPupil()


def polarisation_of(config: Config) -> Polarisation:
    """Return the polarisation that goes in and is detected; unpolarised where none is given."""
    given, analyser = config.polarisation.input, config.polarisation.analyser
    if given is None or given == "unpolarised":
        return Polarisation(None, analyser)
    state = {"left": LEFT, "right": RIGHT}[given] if isinstance(given, str) else linear(given)
    return Polarisation(state, analyser)


def falloff_of(config: Config) -> Falloff:
    """Return the falloff of what the fibre collects."""
    detector = config.detector
    core, mode = detector.core_diameter, detector.mode_field_diameter
    match detector.falloff:
        case "top_hat":
            return TopHat()
        case "cosine":
            return Cosine()
        case "gaussian":
            # R_det over w, of which one goes with the core and the other with the mode's field
            return GaussianFalloff(1.0 if mode is None else core / mode)
        case "fibre":
            return FibreFalloff(core / 2, detector.fibre_na)
        case _:
            return Parabolic()


def waist_of(config: Config) -> Waist | None:
    """Return the beam whose rulings rays are, if they are any's."""
    beam = config.beam
    if beam.waist is None:
        return None
    radius = beam.waist if isinstance(beam.waist, float) else None
    one = 2 * pi / beam.wavelength if isinstance(beam.wavelength, float) else None
    return Waist(radius, one)


def effects_of(config: Config) -> Effects:
    """Return what the thesis left out, of a config that asks for it."""
    objective, shift = config.objective, config.objective.focal_shift
    terms = aberration_terms(config)
    reference = config.interferometer.reference
    return Effects(
        aplanatic=objective.apodisation == "aplanatic",
        aberration=Aberration(terms) if terms else None,
        turned=not terms or objective.zernike_rays == "normal",
        focal_shift=shift.formula if shift is not None and shift.moves else None,
        falloff=falloff_of(config),
        waist=waist_of(config),
        vectorial=config.polarisation.given,
        reference=ReferenceArm(reference.amplitude, reference.length) if reference else None,
    )


def optics_of(config: Config) -> Optics:
    """Return what every scheme works with."""
    k = config.spectrum.wavenumbers()
    band = float(k[0]), float(k[-1])
    objective = config.objective
    return Optics(
        detector_of(config), band, config.tracing.max_intersections,
        objective.numerical_aperture, pupil_of(config), polarisation_of(config), k,
        effects_of(config), config.dispersive,
    )  # fmt: skip
