r"""Rays that an aberration turns, so that they stay normal to the wavefront, for compiled code.

They cross the focal plane beside the focus, in and out, at

.. math:: \nabla_p W / NA \quad \text{with the path} \quad W - p \cdot \nabla_p W

for their point p of the pupil.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba.extending import overload, register_jitable
from numpy.typing import NDArray

from octsim.optics.beam import Beam, Coordinate, DisplacedBeam, crossing
from octsim.optics.detector import Detector, lens_correction
from octsim.optics.zernike import Aberration


class Straight(NamedTuple):
    """No aberration that turns rays."""

    none: float = 0.0


class Turning(NamedTuple):
    """An aberration W(p) that turns rays."""

    aperture: float
    """Numerical aperture."""
    n_objective: float
    """Refractive index of the medium that the objective lies in."""
    wavefront: NDArray[np.float64]
    """W by the powers of both coordinates of p, (N, N), µm."""
    across: NDArray[np.float64]
    """∂W/∂p_x, the same."""
    along: NDArray[np.float64]
    """∂W/∂p_y, the same."""


STRAIGHT = Straight()
Displacement = tuple[float, float, float]
"""Where a ray crosses the focal plane beside the focus, x and y, and its path there, µm."""


def turning(aberration: Aberration, aperture: float, index: float) -> Turning:
    """Return an aberration for compiled code, for a numerical aperture and an index."""
    return Turning(aperture, index, *aberration.powers)


@register_jitable(forceinline=True)
def displacement(
    w: Coordinate, w_x: Coordinate, w_y: Coordinate, px: Coordinate, py: Coordinate, aperture: float
) -> tuple[Coordinate, Coordinate, Coordinate]:
    """Return where rays cross the focal plane beside the focus, and their path, µm.

    Parameters
    ----------
    w, w_x, w_y
        W and its derivatives at their points of the pupil, µm.
    px, py
        Those points, in units of the pupil's radius.
    aperture : float
        Numerical aperture.
    """
    return w_x / aperture, w_y / aperture, w - px * w_x - py * w_y


@register_jitable
def _value(powers: NDArray[np.float64], px: float, py: float) -> float:
    """Return a polynomial at a place (by Horner)."""
    value = 0.0
    for i in range(powers.shape[0] - 1, -1, -1):
        row = 0.0
        for j in range(powers.shape[1] - 1, -1, -1):
            row = row * py + powers[i, j]
        value = value * px + row
    return value


@register_jitable
def _turned(by: Turning, vx: float, vy: float, sign: float) -> Displacement:
    over = sign * by.n_objective / by.aperture
    px, py = over * vx, over * vy
    w, w_x = _value(by.wavefront, px, py), _value(by.across, px, py)
    x, y, path = displacement(w, w_x, _value(by.along, px, py), px, py, by.aperture)
    return x, y, path


def turned(by: Straight | Turning, vx: float, vy: float, sign: float) -> Displacement:
    """Return where a ray of a direction crosses the focal plane, and its path there.

    Parameters
    ----------
    by : Straight or Turning
    vx, vy : float
        Its unit direction.
    sign : float
        −1 for light that goes in, which comes from the pupil's opposite side, or +1.
    """
    return _turned(by, vx, vy, sign) if isinstance(by, Turning) else (0.0, 0.0, 0.0)


# by the type, when code is compiled: nothing is in it of what is off
@overload(turned, strict=False)
def _compile_turned(by: Any, vx: Any, vy: Any, sign: Any) -> Callable[..., Any]:  # noqa: ARG001
    if by.instance_class is Turning:
        return lambda by, vx, vy, sign: _turned(by, vx, vy, sign)
    return lambda by, vx, vy, sign: (0.0, 0.0, 0.0)  # noqa: ARG005


class TurnedBeam(NamedTuple):
    """Rays aimed at the focus that an aberration turns, N of them; as `Beam`, with what turns."""

    vx: NDArray[np.float64]
    vy: NDArray[np.float64]
    vz: NDArray[np.float64]
    amplitude: NDArray[np.float64]
    number: NDArray[np.int64]
    lens: Turning


AnyBeam = Beam | DisplacedBeam | TurnedBeam
"""Rays aimed at the focus, or nearly."""


def through_lens(beam: Beam, lens: Straight | Turning) -> Beam | TurnedBeam:
    """Return a beam that a lens turns, if it turns any."""
    if isinstance(lens, Turning):
        return TurnedBeam(beam.vx, beam.vy, beam.vz, beam.amplitude, beam.number, lens)
    return beam


@overload(through_lens, strict=False)
def _compile_through_lens(beam: Any, lens: Any) -> Callable[..., Any]:  # noqa: ARG001
    if lens.instance_class is Turning:
        return lambda beam, lens: TurnedBeam(
            beam.vx, beam.vy, beam.vz, beam.amplitude, beam.number, lens
        )  # fmt: skip
    return lambda beam, lens: beam  # noqa: ARG005


@overload(crossing, strict=False)
def _compile_turned_crossing(beam: Any, place: Any) -> Callable[..., Any] | None:  # noqa: ARG001
    if getattr(beam, "instance_class", None) is TurnedBeam:
        return lambda beam, place: _turned(beam.lens, beam.vx[place], beam.vy[place], -1.0)
    return None


def path_by_lens(
    lens: Straight | Turning, detector: Detector, x: float, y: float, vx: float, vy: float,
    at_focus: float,
) -> float:  # fmt: skip
    """Return the path that a turned ray has on its way out, beyond that of one that is not, µm.

    Parameters
    ----------
    lens : Straight or Turning
    detector : Detector
        What receives it.
    x, y, vx, vy, at_focus : float
        Where it leaves the focal plane (µm), its unit direction, and its squared radius there.
    """
    if isinstance(lens, Turning):
        return _path_by_lens(lens, detector, x, y, vx, vy, at_focus)
    return 0.0


@register_jitable
def _path_by_lens(
    lens: Turning, detector: Detector, x: float, y: float, vx: float, vy: float, at_focus: float
) -> float:
    across, along, path = _turned(lens, vx, vy, 1.0)
    squared = (x - across) ** 2 + (y - along) ** 2
    return (
        path
        + lens_correction(squared, detector.magnification, detector.focal_length)
        - lens_correction(at_focus, detector.magnification, detector.focal_length)
    )


@overload(path_by_lens, strict=False)
def _compile_path_by_lens(lens: Any, *_rest: Any) -> Callable[..., Any]:
    if lens.instance_class is Turning:
        return lambda lens, detector, x, y, vx, vy, at_focus: _path_by_lens(
            lens, detector, x, y, vx, vy, at_focus
        )
    return lambda lens, detector, x, y, vx, vy, at_focus: 0.0  # noqa: ARG005
