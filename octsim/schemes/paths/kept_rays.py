"""The weighted rays that an integration keeps: nodes of the integral, some with their places."""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numba.extending import overload, register_jitable
from numpy.typing import NDArray

from octsim.schemes.paths.chebyshev import HIGHEST
from octsim.schemes.paths.workspace import Workspace


class WeightedRays(NamedTuple):
    """Room for weighted rays: nodes of the integral."""

    path: NDArray[np.int64]
    amplitude: NDArray[np.float64]
    rough_amplitude: NDArray[np.float64]
    optical_path_length: NDArray[np.float64]


class PlacedRays(NamedTuple):
    """The same, with where each is aimed from."""

    path: NDArray[np.int64]
    amplitude: NDArray[np.float64]
    rough_amplitude: NDArray[np.float64]
    optical_path_length: NDArray[np.float64]
    vx: NDArray[np.float64]
    """Unit direction at launch, x component."""
    vy: NDArray[np.float64]
    """The same, y component."""
    carried: NDArray[np.float64]
    """Amplitude that it carries, without its weight in the integral."""


Rays = TypeVar("Rays", WeightedRays, PlacedRays)


def room_for_nodes(placed: bool) -> WeightedRays | PlacedRays:
    """Make room for weighted rays, with their places or without; it grows as they come."""
    size = 16 * HIGHEST * HIGHEST
    path, numbers = np.empty(size, np.int64), (np.empty(size) for _ in range(6 if placed else 3))
    return PlacedRays(path, *numbers) if placed else WeightedRays(path, *numbers)


@register_jitable
def _doubled(values: NDArray[Any]) -> NDArray[Any]:
    """Return room for twice as many values, with these at its begin."""
    more = np.empty(2 * values.size, values.dtype)
    for i in range(values.size):
        more[i] = values[i]
    return more


def _with_room(rays: Rays) -> Rays:
    """Return room for twice as many rays, with these at its begin."""
    return type(rays)(*map(_doubled, rays))


def _note_place(rays: Rays, count: int, space: Workspace, ray: int) -> None:
    """Note where a ray of the workspace's beam is aimed from, if that is asked for."""
    if isinstance(rays, PlacedRays):
        rays.vx[count], rays.vy[count] = space.beam.vx[ray], space.beam.vy[ray]
        rays.carried[count] = space.bundle.amplitude[ray]


# by the type of the rays, when code is compiled: what is not asked for is not in it
@overload(_with_room, strict=False)
def _compile_with_room(rays: Any) -> Callable[..., Any]:
    if rays.instance_class is PlacedRays:
        return lambda rays: PlacedRays(
            _doubled(rays.path), _doubled(rays.amplitude), _doubled(rays.rough_amplitude),
            _doubled(rays.optical_path_length), _doubled(rays.vx), _doubled(rays.vy),
            _doubled(rays.carried),
        )  # fmt: skip
    return lambda rays: WeightedRays(
        _doubled(rays.path), _doubled(rays.amplitude), _doubled(rays.rough_amplitude),
        _doubled(rays.optical_path_length),
    )  # fmt: skip


@overload(_note_place, strict=False)
def _compile_note_place(rays: Any, count: Any, space: Any, ray: Any) -> Callable[..., Any]:  # noqa: ARG001
    if rays.instance_class is PlacedRays:

        def note(rays: Any, count: int, space: Any, ray: int) -> None:
            rays.vx[count], rays.vy[count] = space.beam.vx[ray], space.beam.vy[ray]
            rays.carried[count] = space.bundle.amplitude[ray]

        return note
    return lambda rays, count, space, ray: None  # noqa: ARG005


def kept(rays: Rays, count: int) -> tuple[NDArray[Any], ...]:
    """Return the arrays of the first of some rays: a plain tuple, as compiled code returns it."""
    return tuple(values[:count] for values in rays)


@overload(kept, strict=False)
def _compile_kept(rays: Any, count: Any) -> Callable[..., Any]:  # noqa: ARG001
    if rays.instance_class is PlacedRays:
        return lambda rays, count: (
            rays.path[:count].copy(), rays.amplitude[:count].copy(),
            rays.rough_amplitude[:count].copy(), rays.optical_path_length[:count].copy(),
            rays.vx[:count].copy(), rays.vy[:count].copy(), rays.carried[:count].copy(),
        )  # fmt: skip
    return lambda rays, count: (
        rays.path[:count].copy(), rays.amplitude[:count].copy(),
        rays.rough_amplitude[:count].copy(), rays.optical_path_length[:count].copy(),
    )  # fmt: skip


@register_jitable
def keep_tile(
    rays: Rays, count: int, code: int, n: int, m: int, space: Workspace
) -> tuple[Rays, int]:
    """Note a tile's weighted nodes; return them all, and their number."""
    while count + n * m > rays.path.size:
        rays = _with_room(rays)
    for i in range(n):
        for j in range(m):
            amplitude = space.bundle.amplitude[i * m + j]
            rays.path[count] = code
            rays.amplitude[count] = space.weight[i, j] * amplitude
            rays.rough_amplitude[count] = space.rough_weight[i, j] * amplitude
            rays.optical_path_length[count] = space.bundle.optical_path_length[i * m + j]
            _note_place(rays, count, space, i * m + j)
            count += 1
    return rays, count
