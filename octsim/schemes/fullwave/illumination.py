r"""The light that the pupil sends to the cylinder, in regular partial waves about its axis.

.. math::

    a_m = \int w(\rho) \cos^{-1/2}\theta\, e^{-i k_{z1} z_f + i k_{z2} h + i k_x x_0}\,
    (t F)\, e^{i m \beta}\, ds_x, \quad \sin\beta = k_x / \kappa_2

with F = :math:`(E_y, Z_0 H_y)` of an aplanatic objective (Richards & Wolf, Proc. R. Soc. A 253, 358
(1959)).
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.optics.pupil import Pupil
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.gauss_legendre import gauss_legendre
from octsim.schemes.fullwave.plane import normal, reflection
from octsim.schemes.fullwave.stacks import above_water, below_water, into_water

Array = NDArray[Any]
Wavefront = Callable[[Array, Array], Array]
"""Returns an aberration W (µm) at points of the pupil, in units of its radius: across the cylinder,
and along it, in which it is even."""


_AT_ONCE = 200_000
"""Points of the integrals, at all wavenumbers, that fast memory holds."""
Both = tuple[Array, Array]
_Sent = tuple[Array, Both, Both | None]
"""A factor of all, and E_y and H_y of light that reaches the axis upwards, and downwards."""


class Lit(NamedTuple):
    """Regular waves of one polarisation and one mirror class, (K, Y, M + 1) each."""

    polarisation: int
    """0 across the cylinder, 1 along it."""
    mirror: int
    """The class: 0 if E_y is odd in m and H_y even, 1 if the reverse."""
    e: Array
    h: Array


def mirror_waves(angle: Array, waves: int) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Return the parts of e^{imβ}, m = 0 … M, that E_y and H_y have: of each mirror class.

    Parameters
    ----------
    angle : ndarray, shape (..., B)
        β.
    waves : int
        M.

    Returns
    -------
    (e, h), (e, h) : ndarray, shape (..., M + 1, B)
    """
    turn = np.arange(waves + 1)[:, np.newaxis] * angle[..., np.newaxis, :]
    odd, even = 1j * np.sin(turn), np.cos(turn) + 0j
    return (odd, even), (even, odd)


def downward_signs(orders: int, mirror: int) -> tuple[Array, Array]:
    """Return what light that travels downwards has to e^{imβ} of a mirror class, (M + 1,) each.

    As it is (−1)^m e^{−imβ}: of E_y and of H_y.
    """
    turn = np.where(np.arange(orders) % 2, -1.0, 1.0)
    return (-turn, turn) if mirror == 0 else (turn, -turn)


def illumination(
    scene: CylinderOnPlane,
    pupil: Pupil,
    aperture: float,
    focus: float,
    along: NDArray[np.float64],
    k: NDArray[np.float64],
    waves: int,
    nodes: int,
    wavefront: Wavefront | None = None,
) -> list[Lit]:
    """Return the waves of both polarisations, those of mirror classes that are not 0.

    Parameters
    ----------
    scene : CylinderOnPlane
    pupil, aperture, focus
        What weighs the light over the pupil, numerical aperture, height of the focus (µm).
    along : ndarray, shape (Y,)
        Components k_y / k.
    k : ndarray, shape (K,)
        Wavenumbers, 1/µm.
    waves, nodes : int
        Largest order M, and Gauss–Legendre nodes over k_x / k > 0.
    wavefront : callable, optional
        Aberration of the pupil.
    """
    x, w = gauss_legendre(nodes)
    reach = np.sqrt(aperture**2 - along**2)[:, np.newaxis]
    across = reach * (x + 1) / 2
    sideways = np.broadcast_to(along[:, np.newaxis], across.shape)
    sine = np.hypot(across, sideways)
    below, above = normal(scene.n_glass, sine), normal(scene.n_water, sine)
    classes = mirror_waves(np.arctan2(across, above.real), waves)
    # both halves of the integral over k_x
    measure = reach * w * np.sqrt(scene.n_glass / below)

    def lit_at(k: NDArray[np.float64]) -> list[Lit]:
        weight = np.stack([pupil.amplitude(sine, aperture, one) for one in k.tolist()])
        size, wavenumber = weight * measure, k[:, np.newaxis, np.newaxis]
        of_class = _over_classes(scene, across, sideways, aperture, wavenumber, wavefront)
        sent = _through_plane if scene.one_plane else _through_stacks
        return [
            _waves_of(polarisation, turned, size * one[0] * part_of, one, classes)
            for polarisation, one in enumerate(sent(scene, focus, across, sideways, wavenumber))
            for turned, part_of in enumerate(of_class)
        ]

    at_once = max(1, _AT_ONCE // across.size)
    parts = [lit_at(k[first : first + at_once]) for first in range(0, k.size, at_once)]
    return [
        Lit(*same[0][:2], *(np.concatenate([one[side] for one in same]) for side in (2, 3)))
        for same in zip(*parts, strict=True)
    ]


def _waves_of(
    polarisation: int, turned: int, reaching: Array, sent: _Sent, classes: tuple[Both, Both]
) -> Lit:
    """Return the waves of light of one polarisation, even or odd in k_x.

    Parameters
    ----------
    polarisation : int
    turned : int
        0 even, 1 odd.
    reaching : ndarray, shape (K, Y, X)
        Weight and phase.
    sent
        Its field.
    classes
        e^{imβ} of both mirror classes.
    """
    mirror = polarisation ^ turned
    _, upwards, downwards = sent
    # a matrix for each k_y, over all wavenumbers
    sides = [
        _over_across(reaching * field, waves_of)
        for field, waves_of in zip(upwards, classes[mirror], strict=True)
    ]
    if downwards:
        for at, waves_of in enumerate(classes[mirror]):
            back = _over_across(reaching * downwards[at], waves_of)
            sides[at] += downward_signs(back.shape[-1], mirror)[at] * back
    return Lit(polarisation, mirror, *sides)


def _through_plane(
    scene: CylinderOnPlane, focus: float, across: Array, sideways: Array, wavenumber: Array
) -> list[_Sent]:
    """Return the light of both polarisations through one plane."""
    sine = np.hypot(across, sideways)
    below, above = normal(scene.n_glass, sine), normal(scene.n_water, sine)
    r = reflection(
        sideways + 0j, across + 0j, below, above, scene.n_glass, scene.n_water, upwards=True
    )
    travel = np.exp(1j * wavenumber * (above * scene.height - below * focus))
    found: list[_Sent] = []
    for polarisation in (0, 1):
        e, h = _components(polarisation, sideways, across, sine, below, scene.n_glass)
        through = e + r.ee * e + r.eh * h, h + r.he * e + r.hh * h
        found.append((travel, through, None))
    return found


def _through_stacks(
    scene: CylinderOnPlane, focus: float, across: Array, sideways: Array, wavenumber: Array
) -> list[_Sent]:
    """Return the light of both polarisations through planes below, and from planes above."""
    sine = np.hypot(across, sideways)
    squared = np.square(sine) + 0j
    below, above = normal(scene.n_glass, sine), normal(scene.n_water, sine)
    passed = into_water(scene, squared, wavenumber)
    travel = np.exp(1j * wavenumber * (above * scene.height - below * focus))
    beyond = None
    if scene.above:
        round_trip = np.exp(2j * wavenumber * above * scene.room)
        beyond = above_water(scene, squared, wavenumber)
        passed_s, passed_p = (
            t / (1 - r_b * r_a * round_trip)
            for t, r_b, r_a in zip(
                passed, below_water(scene, squared, wavenumber), beyond, strict=True
            )
        )
        passed = passed_s, passed_p
        back = np.exp(2j * wavenumber * above * (scene.room - scene.height))
    c, s, cosine = across / sine, sideways / sine, above / scene.n_water
    found: list[_Sent] = []
    for radial, azimuthal in ((c, -s), (s, c)):
        # E of s light, and H of p light over n₂
        e_s, e_p = passed[0] * azimuthal, passed[1] * radial * (scene.n_glass / scene.n_water)
        downwards = None
        if beyond:
            returned = e_s * beyond[0] * back, e_p * beyond[1] * back
            downwards = _turned(*returned, c, s, -cosine, scene.n_water)
        found.append((travel, _turned(e_s, e_p, c, s, cosine, scene.n_water), downwards))
    return found


def _over_classes(
    scene: CylinderOnPlane, across: Array, sideways: Array, aperture: float, wavenumber: Array,
    wavefront: Wavefront | None,
) -> tuple[Array, ...]:  # fmt: skip
    """Return the parts even and odd in k_x of what an offset and an aberration turn light by.

    The even one alone, where the odd one is 0.
    """
    offset = wavenumber * across * scene.offset
    if wavefront is None:
        even = np.cos(offset) + 0j
        return (even, 1j * np.sin(offset)) if scene.offset else (even,)
    # light that heads to one side comes from the pupil's other one
    px, py = across / aperture, sideways / aperture
    ahead = np.exp(1j * (offset + wavenumber * wavefront(-px, py)))
    back = np.exp(1j * (-offset + wavenumber * wavefront(px, py)))
    return (ahead + back) / 2, (ahead - back) / 2


def _over_across(field: Array, waves: Array) -> Array:
    """Integrate (K, Y, X) over k_x with waves (Y, M + 1, X): (K, Y, M + 1)."""
    return (field.swapaxes(0, 1) @ waves.swapaxes(1, 2)).swapaxes(0, 1)


def _components(
    polarisation: int,
    along: NDArray[np.float64],
    across: NDArray[np.float64],
    sine: NDArray[np.float64],
    below: Array,
    n_glass: float,
) -> tuple[Array, Array]:
    """Return E_y and Z₀ H_y of the pupil's light in glass."""
    c, s = across / sine, along / sine
    radial, azimuthal = (c, -s) if polarisation == 0 else (s, c)
    return _turned(azimuthal, radial, c, s, below / n_glass, n_glass)


def _turned(s_light: Array, p_light: Array, c: Array, s: Array, cosine: Array, n: float) -> Both:
    """Return E_y and Z₀ H_y of E of s and p light that travels upwards, or with −cosine down."""
    e: Array = s_light * c + p_light * cosine * s
    h: Array = n * (p_light * c - s_light * cosine * s)
    return e, h
