"""What of the light's way is possible but likely not meant, a line each."""

import math
from collections.abc import Iterator
from itertools import pairwise

from octsim.config.effects import zernike_name
from octsim.config.following import calibration_diameters, fitted_diameters
from octsim.config.immersion import immersion_remarks, of_slide
from octsim.config.models import Config
from octsim.config.source import dim
from octsim.schemes.table import SCHEMES

_PISTON = 1
_SMALL_RMS = 5e-3  # µm
_LARGE_RMS = 0.25  # waves
_GONE = 5.0
"""Exponent of the amplitude that is left, above which light is as good as gone."""
_LEAST_V = 0.6
"""Of a fibre: there its mode is some hundred times as wide as its core."""


def light_remarks(config: Config) -> Iterator[str]:
    """Say what of the effects of a possible plain config is likely not meant."""
    yield from _aberrations(config)
    yield from immersion_remarks(config)
    yield from _focal_shift(config)
    yield from _reference_arm(config)
    yield from _attenuation(config)
    yield from _beam_and_fibre(config)
    yield from _without_contrast(config)
    yield from _source(config)
    yield from _neuron_of_a_series(config)


def _neuron_of_a_series(config: Config) -> Iterator[str]:
    """Say if a lab's neuron is none of those that the calibration is of."""
    given_none = config.expansion.series is None and config.measured.spectra is None
    if given_none or config.expansion.several:  # which are by responses, of that diameter too
        return
    given, table = config.expansion.diameter, calibration_diameters(config).values()
    if not table[0] <= given <= table[-1]:
        yield (
            f"expansion.diameter: {given:.6g} um given, and the calibration is of {table[0]:.6g} "
            f"to {table[-1]:.6g} um, so no change can be read from it; give calibration.diameters "
            "that span it"
        )


def _source(config: Config) -> Iterator[str]:
    yield from dim(config.spectrum.source, config.spectrum.wavelength)
    own = config.processing.estimator
    blind = own not in ("sinusoid", "maximum_likelihood")
    # a lab's own spectra are read by the calibration's estimator
    if config.spectrum.source != "flat" and blind and config.measured.spectra is None:
        yield (
            f"processing.estimator: {own} given, for which the source's shape is a window: at few "
            "oscillations the slope is another than that of a flat source; sinusoid has the source "
            "in its model"
        )


def _band(config: Config) -> tuple[float, float]:
    ends = config.spectrum.wavelength
    return ends.min, ends.max


def _aberrations(config: Config) -> Iterator[str]:
    objective = config.objective
    turned = objective.zernike_rays == "normal"
    by_rays = SCHEMES[config.tracing.scheme].light == "rays"
    shortest, _ = _band(config)
    for term, rms, remedy in _terms(config):
        waves = rms / shortest
        if waves > _LARGE_RMS:
            yield (
                f"{term} is {waves:.3g} waves rms at {shortest:.6g} um, far beyond what an "
                f"objective has, and by which the focus is lost; {remedy}"
            )
        elif by_rays and turned and rms > _SMALL_RMS:
            yield (
                f"{term} moves rays by less than the diffraction spot, so rays are not to be "
                "trusted with it, as the detector cuts by position; compare with "
                "tracing.scheme: fullwave"
            )


def _terms(config: Config) -> Iterator[tuple[str, float, str]]:
    """Return aberrations in words, their rms, µm, and what to do about one that is too large."""
    for number, rms in config.objective.zernike.of.items():
        if number != _PISTON:
            name = f" ({name})" if (name := zernike_name(number)) else ""
            yield f"objective.zernike.{number}: {rms:.6g} um{name}", abs(rms), "give nanometres"
    if slide := of_slide(config):
        below = f"{config.objective.immersion} below a slide of {config.scene.objective_medium}"
        yield (
            f"objective.immersion: {below}, {slide.rms:.3g} um,", slide.rms,
            "an objective that is corrected for its slide is one without objective.immersion",
        )  # fmt: skip


def _focal_shift(config: Config) -> Iterator[str]:
    shift = config.objective.focal_shift
    if shift is None:
        return
    key, (shortest, longest) = "objective.focal_shift", _band(config)
    if not shift.moves:
        yield (
            f"{key}: moves nothing, as its linear and quadratic are 0; give one of them, or leave "
            "it out"
        )
    elif not shortest <= shift.reference <= longest:
        moved = shift.formula.at(config.spectrum.middle)
        yield (
            f"{key}.reference: {shift.reference:.6g} um is outside the band, {shortest:.6g} um to "
            f"{longest:.6g} um, so the focus is moved by {moved:.3g} um in the "
            "middle of the band; give a wavelength within"
        )


def _reference_arm(config: Config) -> Iterator[str]:
    arm = config.interferometer.reference
    if arm is None or not arm.amplitude:
        return
    key, (shortest, longest) = "interferometer.reference", _band(config)
    if arm.amplitude > 1:
        yield (
            f"{key}.amplitude: {arm.amplitude:g} is more light than goes in, whose amplitude is 1; "
            "give 1 or less"
        )
    periods = abs(arm.length) * 2 * (1 / shortest - 1 / longest)  # of π/L in the band
    needed = math.ceil(2 * periods) + 1
    given = config.spectrum.samples
    if given < needed:
        yield (
            f"{key}.length: {arm.length:.6g} um has a fringe of period "
            f"{math.pi / abs(arm.length):.3g} /um, which spectrum.samples: {given} alias; give "
            f"{needed} samples or more, or a shorter length"
        )


def _thicknesses(config: Config) -> Iterator[tuple[str, float, str]]:
    """Return media, and the most that light passes of each, µm, and what that is of."""
    scene = config.scene
    largest = max(config.sweep.diameters.stop, fitted_diameters(config).stop)
    yield scene.swept_medium, largest, "the largest swept thickness"
    yield scene.objective_medium, config.objective.focus_distance, "objective.focus_distance"
    for layer in scene.layers[1:-1]:
        if isinstance(layer.thickness, float):
            yield layer.medium, layer.thickness, f"the layer of {layer.medium}"
    for cylinder in scene.cylinders:
        if cylinder.diameter:
            yield cylinder.medium, cylinder.diameter, f"the cylinder of {cylinder.medium}"
        for shell in cylinder.shells:
            yield shell.medium, shell.thickness, f"the shell of {shell.medium}"


def _attenuation(config: Config) -> Iterator[str]:
    given, k = config.scene.attenuation.of, config.spectrum.middle
    of = config.scene.refractive_index.of
    most: dict[str, tuple[float, str]] = {}
    for medium, thick, what in _thicknesses(config):
        most[medium] = max(most.get(medium, (0.0, "")), (thick, what))
    for medium, (thick, what) in most.items():
        attenuation = given.get(medium, 0.0) + 2 * k * of[medium].index(k).imag
        exponent = attenuation * thick / 2
        key = "attenuation" if given.get(medium) else "refractive_index"
        if exponent > _GONE:
            yield (
                f"scene.{key}.{medium}: an attenuation of {attenuation * 1e4:.6g} /cm leaves "
                f"{math.exp(-exponent):.2g} of the amplitude after {what}, {thick:.6g} um, so "
                "light from beyond is gone; give less"
            )


def _beam_and_fibre(config: Config) -> Iterator[str]:
    shortest, longest = _band(config)
    beam, detector = config.beam, config.detector
    one = beam.wavelength
    if beam.waist is not None and isinstance(one, float) and not shortest <= one <= longest:
        yield (
            f"beam.wavelength: {one:.6g} um is outside the band, {shortest:.6g} um to "
            f"{longest:.6g} um; give one within, or each"
        )
    v = math.pi * detector.core_diameter * detector.fibre_na / longest
    if detector.falloff == "fibre" and v < _LEAST_V:
        yield (
            f"detector.fibre_na: {detector.fibre_na:g} and detector.core_diameter: "
            f"{detector.core_diameter:.6g} um are of V = {v:.2g} at {longest:.6g} um, at which a "
            f"fibre hardly guides light; give V above {_LEAST_V:g}"
        )


def _without_contrast(config: Config) -> Iterator[str]:
    """Say where there is no surface, as the index is the same on both sides."""
    scene = config.scene
    of = scene.refractive_index.of
    names = [layer.medium for layer in scene.layers]
    for place, (below, above) in enumerate(pairwise(names)):
        if below != above and of[below] == of[above]:
            yield (
                f"scene.layers.{place + 1}: {above} has the index of {below} below it, so no light "
                "is reflected from the plane between them; give one of them another index"
            )
    if not scene.cylinders and len(set(names)) == 1:
        yield (
            f"scene.layers: all are of {names[0]}, and the same material on both sides is no "
            "surface, so no light returns; give what is swept another medium"
        )
    for place, cylinder in enumerate(scene.cylinders):
        outer = cylinder.shells[0].medium if cylinder.shells else cylinder.medium
        if of[outer] != of[scene.host_medium]:
            continue
        key = f"scene.cylinders.{place}.{'shells.0.' if cylinder.shells else ''}medium"
        if outer == scene.host_medium:
            yield (
                f"{key}: {outer}, as what is around it, and the same material on both sides is no "
                "surface; give another medium"
            )
            continue
        yield (
            f"{key}: {outer} has the index of {scene.host_medium} around it, so no light is "
            "reflected from that surface; give another medium or index"
        )
