"""A config by the scheme fullwave, and what that can't do of it."""

from octsim.config.abilities import as_far_as, beyond_scheme
from octsim.config.models import Config
from octsim.schemes.table import FULL_WAVE


def by_maxwell(config: Config, accuracy: float = FULL_WAVE.presets["exact"]["accuracy"]) -> Config:
    """Return a plain config, not checked, whose light is found by Maxwell's equations."""
    asked = {"scheme": FULL_WAVE.name, "accuracy": accuracy}
    tracing = config.tracing.model_copy(update=asked)
    return as_far_as(FULL_WAVE, config).model_copy(update={"tracing": tracing})


def beyond_maxwell(config: Config) -> str:
    """Say in a line why Maxwell's equations are not solved for a plain config; empty if they are.

    Light above the index of the cylinder's medium is evanescent there, and its partial waves are
    modified Bessel functions, which the scheme does not have.
    """
    aperture, scene = config.objective.numerical_aperture, config.scene
    for line in beyond_scheme(by_maxwell(config)):
        return line
    if aperture >= scene.host_index:
        return (
            f"objective.numerical_aperture: {aperture} given, at or above the index of "
            f"{scene.host_medium}, {scene.host_index}, where tracing.scheme: {FULL_WAVE.name} does "
            "not work; give less"
        )
    return ""
