"""Rays of a config's strongest light paths, from place to place or over the aperture: pictures."""

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
from octsim.tracing.faces import Faces, faces_at
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


class LitAperture(NamedTuple):
    """Where rays leave the objective, and on which light path each comes back."""

    x: NDArray[np.float64]
    """Place on the objective's disk over its radius, (N,)."""
    y: NDArray[np.float64]
    path: NDArray[np.int64]
    """Number in `names` of the path on which most of a ray is detected, (N,): -1 where none of it
    is, and one more than the last where that is a path which is not among them."""
    names: list[str]
    """Of the strongest light paths, as those that are drawn in the scene."""


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
    traced = _traced(config, diameter, focus, paths)
    drawn = []
    for code, name, size in zip(traced.codes, traced.names, traced.sizes, strict=True):
        there = traced.ray[(traced.path == code) & (traced.field != 0)]
        few = _spread(traced.beam, np.flatnonzero(np.isin(traced.beam.number, there)), rays)
        drawn.append(DrawnPath(name, size, trails(traced.faces, code, few, traced.at, height)))
    return drawn


def lit_aperture(config: Config, diameter: float, focus: float, paths: int = 8) -> LitAperture:
    """Return where the rays of a point are launched, and the light path that each comes back on.

    They are the rays of `drawn_rays`. A ray that is split comes back on several paths: it is of
    the one on which most of its field is detected.
    """
    traced = _traced(config, diameter, focus, paths)
    number = {code: place for place, code in enumerate(traced.codes)}
    at = np.array([number.get(code, len(number)) for code in traced.path.tolist()], np.int64)
    path = np.full(_RAYS, -1, np.int64)
    size = np.abs(traced.field)
    # the last that is written is the strongest
    for place in np.flatnonzero(size > 0)[np.argsort(size[size > 0], kind="stable")]:
        path[traced.ray[place]] = at[place]
    beam = traced.beam
    slope = np.stack([beam.vx, beam.vy]) / beam.vz / traced.rim
    return LitAperture(slope[0], slope[1], path[beam.number], traced.names)


class _Traced(NamedTuple):
    """Detected rays of a point, and its strongest light paths."""

    beam: Beam
    rim: float
    """Tangent of the steepest ray's angle."""
    ray: NDArray[np.int64]
    """Number of the launched ray, (D,)."""
    path: NDArray[np.int64]
    field: NDArray[np.complex128]
    """What each adds to the first detected field at the middle of the band, (D,)."""
    codes: list[int]
    """Of the strongest paths, strongest first."""
    names: list[str]
    sizes: list[float]
    faces: Faces
    at: float
    """Height of the focus at the middle of the band, µm."""


def _traced(config: Config, diameter: float, focus: float, paths: int) -> _Traced:
    counted = _plain(as_far_as(COUNTED_RAYS, config))
    optics, scene = optics_of(counted), scene_of(counted, diameter)
    k = config.spectrum.middle
    options = {"rays": _RAYS, "min_amplitude": _DROPPED}
    found = Spiral(optics, options, scene, focus, lengths=False).at(k)
    detector = optics.detector_at(scene, k)
    radius, distance = detector.objective_radius, detector.focus_distance
    field = _fields(found, weights(optics, found.numbers[:, np.newaxis], np.array([k]))[0], k)
    codes = np.unique(found.path)
    size = np.array([np.abs(field[found.path == code].sum()) for code in codes])
    order = np.argsort(-size, kind="stable")[:paths]
    strongest = [number for number in order.tolist() if size[number] > 0]
    chosen = codes[strongest].tolist()
    return _Traced(
        vogel_beam(_RAYS, radius, distance), radius / distance, found.ray % _RAYS, found.path,
        field, chosen, names_of_paths(scene, k, chosen), size[strongest].tolist(),
        faces_at(scene, k), optics.focus_at(focus, k),
    )  # fmt: skip


def _plain(config: Config) -> Config:
    """Return a config, not checked, whose rays meet in the focus."""
    objective = config.objective.model_copy(update={"zernike": ZernikeConfig(), "immersion": None})
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
