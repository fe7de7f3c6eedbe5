"""A small spectrometer, whose recordings tests write: what it sees is known."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
NM = np.linspace(900.0, 650.0, 300)
"""Wavelengths of its samples, falling."""
K = 2e3 * np.pi / NM
SOURCE = np.exp(-4 * np.log(2) * ((NM - 775) / 120) ** 2) * (1 + 0.05 * np.cos(NM / 4))
DARK, READ = 50.0, 2.0
DEPTH = 4.0


class Lab(NamedTuple):
    """What was recorded, in counts."""

    spectra: Array
    dark: Array
    reference: Array
    phase: Array
    """Of each spectrum, rad."""


def recorded(
    spectra: int = 60, photons: float = 4e3, seed: int = 1, phase: Array | None = None
) -> Lab:
    """Return recordings of a fringe at `DEPTH`, of so many electrons in its brightest sample."""
    generator = np.random.default_rng(seed)
    phase = np.linspace(0.2, 0.5, spectra) if phase is None else phase
    angle = 2 * DEPTH * (K - (K[0] + K[-1]) / 2) + phase[:, np.newaxis]
    light = photons / 1.5 * SOURCE * (1 + 0.5 * np.cos(angle))

    def camera(expected: Array) -> Array:
        noise = READ * generator.standard_normal(expected.shape)
        return np.asarray(np.round(generator.poisson(expected) + noise + DARK))

    return Lab(
        camera(light), camera(np.zeros((80, NM.size))),
        camera(np.broadcast_to(photons * SOURCE, (400, NM.size))), phase,
    )  # fmt: skip


def written(folder: Path, lab: Lab, **further: Any) -> dict[str, Any]:
    """Write the recordings, and return the config's section `measured` that names them."""
    for name in ("spectra", "dark", "reference"):
        np.save(folder / f"{name}.npy", getattr(lab, name).astype(np.uint16))
    np.savetxt(folder / "axis.csv", NM, header="wavelength (nm)", comments="")
    named = {name: str(folder / f"{name}.npy") for name in ("spectra", "dark", "reference")}
    return {
        **named, "axis": {"wavelength": str(folder / "axis.csv")}, "rate": "1 kHz", **further
    }  # fmt: skip
