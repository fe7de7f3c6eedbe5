"""Two and more plates on one arm (thesis §2.2): their spectra over a thickness."""

from collections.abc import Iterator
from enum import IntEnum
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.derive import by_waves, changed, counting_rays
from octsim.config.models import Config
from octsim.instrument.instrument import Instrument
from octsim.optics.two_beams import ideal_spectra
from octsim.studies.interferometers.michelson import ALONE

Array = NDArray[np.float64]
IDEAL = "cos(2ndk)"
ALONG_THE_AXIS = 1e-3
"""Numerical aperture of light that is nearly parallel."""
FAR = "300 mm"
"""Focus distance: from afar the objective's rim cuts nothing of what returns from beside it."""
APERTURES = (0.3, 0.6, 0.9, 1.2)
FILM = 0.7
"""Thickness of the film of water below the plate that is swept, µm."""


class ClosedForm(IntEnum):
    """Whether spectra are compared with a closed form."""

    COMPARED = 0
    NO_CLOSED_FORM = 1
    """They are the ideal, or of light in a cone, which Airy's sum is not of."""


class Plates(NamedTuple):
    """Spectra of one kind of plates."""

    name: str
    config: Config | None
    """None of the ideal."""
    spectra: Array
    """(D, K)."""
    closed_form: Array | None
    """Airy's sum of light along the axis, (D, K), where that is what is asked."""

    @property
    def compared(self) -> ClosedForm:
        """Whether there is a closed form."""
        return ClosedForm.NO_CLOSED_FORM if self.closed_form is None else ClosedForm.COMPARED


def plates(config: Config, thickness: Array, threads: int) -> Iterator[Plates]:
    """Return the spectra of plates, of light along the axis and in a cone.

    Parameters
    ----------
    config : Config
        Whose media, band and number of rays they have.
    thickness : ndarray, shape (D,)
        Of the plate of the neuron's index, µm.
    threads : int
        How many spectra are found at a time.
    """
    k = config.spectrum.wavenumbers()
    yield Plates(IDEAL, None, ideal_spectra(config.swept_index, thickness, k), None)
    parallel = {"numerical_aperture": ALONG_THE_AXIS, "focus_distance": FAR}
    glass, water, neuron = _media(config)
    for name, between in (("two", (neuron,)), ("three", (water, neuron))):
        scene = _scene((glass, *between, glass), neuron)
        one = changed(counting_rays(config), ALONE, {"scene": scene, "objective": parallel})
        spectra = Instrument(one).spectra(thickness, np.zeros(thickness.size), threads)
        of = {glass: config.objective_index, water: config.host_index, neuron: config.swept_index}
        indices = [of[medium] for medium in (glass, *between, glass)]
        film = [FILM] * (len(between) - 1)
        closed = np.stack([airy(indices, [*film, d], k) for d in thickness.tolist()])
        yield Plates(f"{name} planes, rays along the axis", one, spectra, closed)
    # the middle of the plate, as the glass below sees it
    foci = config.objective_index / config.swept_index * thickness / 2
    for aperture in APERTURES:
        cone = {"numerical_aperture": aperture, "pupil": "uniform"}
        scene = _scene((glass, neuron, glass), neuron)
        one = changed(by_waves(config), ALONE, {"scene": scene, "objective": cone})
        spectra = Instrument(one).spectra(thickness, foci, threads)
        yield Plates(f"two planes, Maxwell, NA {aperture:g}", one, spectra, None)


def _media(config: Config) -> tuple[str, str, str]:
    return config.scene.objective_medium, config.scene.host_medium, config.scene.swept_medium


def _scene(media: tuple[str, ...], swept: str) -> dict[str, Any]:
    """Return the overlay of plates of media, one of which is swept and the others a film."""
    between = [
        {"medium": medium, "thickness": "swept" if medium == swept else f"{FILM} um"}
        for medium in media[1:-1]
    ]
    return {"layers": [media[0], *between, media[-1]], "cylinders": []}


def airy(indices: list[float], thicknesses: list[float], k: Array) -> Array:
    """Return the intensity that a stack reflects of light along the axis, (K,).

    Parameters
    ----------
    indices : list of float
        Below, between and above S planes, S + 1 of them.
    thicknesses : list of float
        Between the planes, S − 1 of them, µm.
    k : ndarray, shape (K,)
        1/µm.
    """
    steps = [(a - b) / (a + b) for a, b in pairwise(indices)]
    whole: NDArray[Any] = np.full(k.size, steps[-1], complex)
    inner = zip(steps[-2::-1], indices[-2:0:-1], reversed(thicknesses), strict=True)
    for step, index, thickness in inner:
        turned = whole * np.exp(2j * index * thickness * k)
        whole = (step + turned) / (1 + step * turned)
    intensity: Array = np.abs(whole) ** 2
    return intensity
