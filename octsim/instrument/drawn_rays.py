"""Some rays of a config's strongest light paths, from place to place: what a picture shows."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.abilities import as_far_as
from octsim.config.effects import ZernikeConfig
from octsim.config.models import Config
from octsim.instrument.build import optics_of, scene_of
from octsim.optics.beam import Beam, vogel_beam
from octsim.schemes.returned_rays import FIRST_FIELD, LENGTH, Returned, Spiral, weights
from octsim.schemes.table import COUNTED_RAYS
from octsim.tracing.faces import faces_at
from octsim.tracing.light_paths import names_of_paths
from octsim.tracing.trails import trails

_RAYS = 3000
"""Launched, of which the drawn ones are some."""
_DROPPED = 1e-3
"""Amplitude below which a ray is not followed."""


class DrawnPath(NamedTuple):
    """A light path with a few of its rays."""

    name: str
    field: float
    """Magnitude of what all of its rays come to at the middle of the band."""
    places: NDArray[np.float64]
    """Of N rays, from a height below all surfaces to it, (N, V, 3), µm."""


def drawn_rays(
    config: Config, diameter: float, focus: float, height: float, paths: int = 8, rays: int = 5
) -> list[DrawnPath]:
    """Return the strongest light paths of a point, with rays spread over where they are launched.

    Rays are those of the thesis, whatever the run's scheme is, and meet in the focus: without
    aberrations and rulings, as those that are drawn are followed from there.

    Parameters
    ----------
    config : Config
        A plain one.
    diameter, focus : float
        µm.
    height : float
        Where rays begin and end, µm; below all surfaces.
    paths, rays : int
        How many, at most, and of each.
    """
    counted = _plain(as_far_as(COUNTED_RAYS, config))
    optics, scene = optics_of(counted), scene_of(counted, diameter)
    k = config.spectrum.middle
    options = {"rays": _RAYS, "min_amplitude": _DROPPED}
    found = Spiral(optics, options, scene, focus, lengths=False).at(k)
    detector = optics.detector_at(scene, k)
    beam = vogel_beam(_RAYS, detector.objective_radius, detector.focus_distance)
    field = _fields(found, weights(optics, found.numbers[:, np.newaxis], np.array([k]))[0], k)
    codes = np.unique(found.path)
    size = np.array([np.abs(field[found.path == code].sum()) for code in codes])
    order = np.argsort(-size, kind="stable")[:paths]
    strongest = [number for number in order.tolist() if size[number] > 0]
    faces, at = faces_at(scene, k), optics.focus_at(focus, k)
    names = names_of_paths(scene, k, codes[strongest].tolist())
    drawn = []
    for number, name in zip(strongest, names, strict=True):
        there = found.ray[(found.path == codes[number]) & (field != 0)] % _RAYS
        few = _spread(beam, np.flatnonzero(np.isin(beam.number, there)), rays)
        way = trails(faces, int(codes[number]), few, at, height)
        drawn.append(DrawnPath(name, float(size[number]), way))
    return drawn


def _plain(config: Config) -> Config:
    """Return a config, not checked, whose rays meet in the focus."""
    objective = config.objective.model_copy(update={"zernike": ZernikeConfig()})
    return config.model_copy(update={"objective": objective, "beam": type(config.beam)()})


def _fields(found: Returned, weight: NDArray[np.float64], k: float) -> NDArray[np.complex128]:
    """Return what each ray adds to the first of the detected fields, (D,)."""
    phase = np.exp(1j * k * found.numbers[LENGTH])
    field: NDArray[np.complex128] = found.numbers[FIRST_FIELD] * weight * phase
    return field


def _spread(beam: Beam, there: NDArray[np.int64], rays: int) -> Beam:
    """Return a few rays of some, near the plane y = 0 and spread over x."""
    near = there[np.argsort(np.abs(beam.vy[there]), kind="stable")][: 3 * rays]
    along = near[np.argsort(beam.vx[near], kind="stable")]
    chosen = along[np.unique(np.linspace(0, along.size - 1, rays).round().astype(int))]
    return Beam(
        beam.vx[chosen], beam.vy[chosen], beam.vz[chosen], beam.amplitude[chosen],
        np.arange(chosen.size),
    )  # fmt: skip
