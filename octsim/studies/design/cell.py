"""Spectra of one diameter by one aperture: of each focus and fill, and with one thing off."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from octsim.config.models import Config
from octsim.instrument.sharing import SharingInstrument
from octsim.phase.derivatives import FRACTIONS, Array
from octsim.schemes.fullwave.operators import Operators
from octsim.schemes.light import AccuracyStatus
from octsim.studies.design.settings import (
    STEP,
    Band,
    configs_off,
    filled,
    waves,
)

OFFSETS = 2 * STEP * FRACTIONS
"""Of the diameter, (5,), µm."""
SIDES = OFFSETS[[1, 3]]
"""Of the diameter, for a slope with something off, (2,), µm."""


class Seen(NamedTuple):
    """Spectra of one focus, fill and band."""

    around: Array
    """Of the diameter at `OFFSETS`, (5, K)."""
    off: dict[str, Array]
    """With one thing off, by its name, of the diameter at `SIDES`, (2, K)."""
    error: float
    """Estimated error of the intensity, over the largest."""
    status: AccuracyStatus
    """Whether that is as asked; the gravest."""


class Bench(NamedTuple):
    """Instruments of one aperture, by fill, that share the scenes."""

    own: list[SharingInstrument]
    """Of each fill."""
    refilled: list[SharingInstrument]
    """With the fill off."""
    off: dict[str, list[SharingInstrument]]
    """With something of the config off, by its name."""


def bench_of(config: Config, aperture: float) -> Bench:
    """Return the instruments of an aperture."""
    operators, fills, base = Operators(), config.design.fills, waves(config, aperture)

    def each(one: Config, scale: float = 1.0) -> list[SharingInstrument]:
        return [SharingInstrument(filled(one, scale * fill), operators) for fill in fills]

    return Bench(
        each(base), each(base, 1 + config.calibration.tolerances.fill),
        {name: each(moved) for name, moved in configs_off(base)},
    )  # fmt: skip


def cell(
    config: Config, bench: Bench, bands: list[Band], diameter: float, focus: float
) -> Iterator[list[Seen]]:
    """Solve one diameter at one focus for all fills and bands.

    What shares a scene is solved one after the other, as its operator is kept for so long.

    Parameters
    ----------
    config : Config
    bench : Bench
        Instruments of one aperture.
    bands : list of Band
    diameter, focus : float
        µm.

    Yields
    ------
    list of Seen
        Of each band; one list for each fill.
    """
    higher = focus + config.calibration.tolerances.focus
    fills = range(len(bench.own))
    found: dict[tuple[str, int], list[list[Array]]] = {}
    errors, status = np.zeros(len(fills)), [AccuracyStatus.REACHED] * len(fills)

    def look(name: str, instruments: list[SharingInstrument], at: float, height: float) -> None:
        for fill, one in enumerate(instruments):
            light = one.light(at, height)
            spectra = [one.over(light, band.wavenumber) for band in bands]
            found.setdefault((name, fill), []).append([seen.intensity for seen in spectra])
            errors[fill] = max(errors[fill], *(seen.error for seen in spectra))
            status[fill] = max(status[fill], light.status)

    for offset in OFFSETS.tolist():
        look("own", bench.own, diameter + offset, focus)
        if offset in SIDES:
            look("focus", bench.own, diameter + offset, higher)
            look("fill", bench.refilled, diameter + offset, focus)
            for name, instruments in bench.off.items():
                look(name, instruments, diameter + offset, focus)
    names = [name for name, fill in found if fill == 0 and name != "own"]
    for fill in fills:
        yield [
            Seen(
                np.stack([one[place] for one in found["own", fill]]),
                {name: np.stack([one[place] for one in found[name, fill]]) for name in names},
                float(errors[fill]), status[fill],
            )
            for place in range(len(bands))
        ]  # fmt: skip
