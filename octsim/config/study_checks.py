"""What is impossible of the sections of targets beside a run, which other scenes do not have."""

import itertools
from collections.abc import Iterator

from octsim.config.calibration import DIAMETER
from octsim.config.models import Config
from octsim.config.scene_keys import wrong_tolerances
from octsim.config.units import format_length


def wrong_for_studies(config: Config) -> Iterator[str]:
    """Say, a line each, what a target beside the run of a config can't be asked for.

    Of a config as it is given alone: studies of other scenes and bands leave that out.
    """
    yield from wrong_tolerances(config)
    yield from _fitted(config)
    yield from _bands(config)


def shells_of(config: Config) -> int:
    """Return how many shells the swept cylinder has."""
    return next((len(c.shells) for c in config.scene.cylinders if c.diameter is None), 0)


def _fitted(config: Config) -> Iterator[str]:
    fit, bands = config.expansion.fit, config.expansion.bands
    if config.expansion.series is not None and config.measured.spectra is not None:
        yield (
            f"expansion.series: {config.expansion.series} given, and measured.spectra too; give "
            "one of the two, phases or spectra"
        )
    if config.expansion.slope == "match" and (
        config.measured.spectra is None or config.expansion.several
    ):
        yield (
            "expansion.slope: match given, which is of measured.spectra and fits the diameter "
            "alone; give calibration, or measured.spectra, no expansion.bands and fit: [diameter]"
        )
    shells = shells_of(config)
    for name in fit:
        word, _, number = name.partition("_")
        if word == "thickness" and int(number or 1) > shells:
            yield (
                f"expansion.fit: {name} given, but the neuron has {shells} shells; give it one in "
                f"scene.cylinders, or leave {name} out"
            )
    if fit != (DIAMETER,) and len(bands) < len(fit):
        yield (
            f"expansion.fit: {len(fit)} quantities given, but phases in {len(bands)} bands can't "
            f"tell them apart; give {len(fit)} expansion.bands or more, and a phase column of "
            "each, or fit fewer"
        )


def _bands(config: Config) -> Iterator[str]:
    whole, bands = config.spectrum.wavelength, config.expansion.bands
    for place, (least, most) in enumerate(bands):
        if least < whole.min or most > whole.max:
            yield (
                f"expansion.bands.{place}: {_told(least, most)} given, which is not within "
                f"spectrum.wavelength, {_told(whole.min, whole.max)}"
            )
    numbered = sorted((band, place) for place, band in enumerate(bands))
    for (one, at), (other, beside) in itertools.pairwise(numbered):
        if other[0] < one[1]:
            yield (
                f"expansion.bands.{beside}: {_told(*other)} given, which overlaps "
                f"expansion.bands.{at}, {_told(*one)}; their phases share noise, so give bands "
                "beside each other"
            )


def _told(least: float, most: float) -> str:
    return f"{format_length(least)} to {format_length(most)}"
