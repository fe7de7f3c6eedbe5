"""What neither focus nor pupil matters to: how a scene scatters, kept from point to point."""

import threading
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from octsim.schemes.fullwave.coupling import contour
from octsim.schemes.fullwave.cylinder import Scattering
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.gauss_legendre import gauss_legendre
from octsim.schemes.fullwave.illumination import mirror_waves
from octsim.schemes.fullwave.orders import Orders, waves_along
from octsim.schemes.fullwave.shells import scattering_of
from octsim.schemes.fullwave.slab import Planes, planes_of

Array = NDArray[Any]
_KEPT = 6
Kept = TypeVar("Kept")


class Operator(NamedTuple):
    """Of a scene at K wavenumbers and Y components k_y > 0."""

    k: NDArray[np.float64]
    along: NDArray[np.float64]
    """k_y / k, (Y,)."""
    along_weight: NDArray[np.float64]
    """Of the integral over all of the pupil's k_y / k, both signs."""
    cylinder: Scattering
    plane: Planes
    mirrors: tuple[tuple[Array, Array], ...]
    """e^{imβ} at the contour's nodes, of each mirror class, of E_y and H_y."""


def operator(
    scene: CylinderOnPlane, aperture: float, k: NDArray[np.float64], orders: Orders
) -> Operator:
    """Return the operator of a scene, for all k_y / k up to an aperture."""
    along, weight = along_nodes(aperture, orders.along)
    # it reaches farthest for light straight across, or for that of the rim
    both = along[[0, -1]]
    heights = np.sqrt(scene.n_water**2 - both**2) * scene.height * float(k.min())
    farthest = waves_along(scene, both, k[:1], orders.waves)[0]
    if scene.above:
        # or what is closer to the plane above
        upwards = heights * (scene.room - scene.height) / scene.height
        farthest, heights = np.tile(farthest, 2), np.concatenate([heights, upwards])
    path = contour(orders.contour, farthest, heights)
    return Operator(
        k, along, weight,
        scattering_of(scene, along, k, orders.waves),
        planes_of(scene, path, along, k),
        mirror_waves(path.angle, orders.waves),
    )  # fmt: skip


def along_nodes(aperture: float, nodes: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return k_y / k > 0 and the weights of the integral over both signs."""
    x, w = gauss_legendre(nodes)
    # closer where the phase turns fastest, at the rim: a tenth of the error of evenly mapped nodes
    u = (x + 1) / 2
    return aperture * (1.5 - 0.5 * u) * u, aperture * w * (1.5 - u)


class Operators:
    """The operators that were asked for last; threads share them, and each is made once."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._kept: OrderedDict[tuple[object, ...], Future[Any]] = OrderedDict()

    def of(
        self, scene: CylinderOnPlane, aperture: float, k: NDArray[np.float64], orders: Orders
    ) -> Operator:
        """Return the operator of a scene, made or kept."""
        # the offset and the nodes over k_x are the illumination's
        return self.kept(
            (scene._replace(offset=0.0), aperture, k.tobytes(), orders._replace(across=0)),
            lambda: operator(scene, aperture, k, orders),
        )

    def kept(self, key: tuple[object, ...], make: Callable[[], Kept]) -> Kept:
        """Return what a function makes, or made for the same key before."""
        with self._lock:
            found, wanted = self._kept.pop(key, None), Future[Kept]()
            self._kept[key] = found or wanted
            while len(self._kept) > _KEPT:
                self._kept.popitem(last=False)
        if found:
            return cast(Kept, found.result())
        # without the lock, so that threads make theirs at the same time
        try:
            wanted.set_result(make())
        except BaseException as error:
            with self._lock:
                self._kept.pop(key, None)  # whoever asks next tries again
            wanted.set_exception(error)
            raise
        return wanted.result()
