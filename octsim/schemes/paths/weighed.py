"""The nodes of the integrals with all that an instrument does to light besides the thesis.

Paths are integrated as the thesis has them; their nodes are then followed once more, with what the
effects need. A factor that is smooth over the aperture keeps the rules as good as they are, nearly:
the rougher rule tells, and where it says so the integral is made with a smaller error.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.optics.beam import Beam
from octsim.optics.pupil import UniformPupil
from octsim.optics.scene import Scene, Symmetry
from octsim.optics.turned_rays import STRAIGHT, Straight, Turning, through_lens, turning
from octsim.schemes.light import Light, Optics
from octsim.schemes.paths.falloffs import series_of
from octsim.schemes.paths.integrate import EVEN, Integrated, integrate_nodes
from octsim.schemes.through_objective import passed
from octsim.tracing.carry import AMPLITUDE
from octsim.tracing.jones import FIELD, jones_of
from octsim.tracing.kernel import AT_VX, AT_VY, FIRST_CARRIED
from octsim.tracing.lengths import with_lengths
from octsim.tracing.path_rays import make_path_tracer

_FAINT = 1e-3
"""Amplitude of a falloff without an edge at which it is cut, over the accuracy."""


class Followed(NamedTuple):
    """The nodes of the integrals of a point in a band, followed with what the effects need."""

    integrated: Integrated
    numbers: NDArray[np.float64]
    """As `octsim.tracing.path_rays` has them, (5 + C, D)."""
    regions: int
    """Regions whose lengths of ways are known: the last of the numbers."""


class Weighed(NamedTuple):
    """Rays at one wavenumber, or at all where they are the same, with all that weighs them."""

    light: Light
    """Of amplitudes without what regions take, and with the lengths, where asked for."""
    fields: NDArray[np.complex128]
    """What light across and along the cylinder becomes over those amplitudes, (2, D)."""


def followed(
    optics: Optics,
    scene: Scene,
    focus: float,
    k: float,
    accuracy: float,
    lengths: bool,
) -> Followed:
    """Integrate the light paths of a point at a wavenumber, and follow the nodes once more.

    Parameters
    ----------
    optics : Optics
    scene : Scene
    focus : float
        Height of the focus at the reference, µm.
    k : float
        Wavenumber at which all is taken, 1/µm.
    accuracy : float
        Of the integrals over the band, if all were the same there.
    lengths : bool
        Whether the lengths of ways are asked for.
    """
    effects = optics.effects
    reach = effects.falloff.reach(k, _FAINT * accuracy)
    detector = optics.detector_at(scene, k)
    within = detector._replace(radius=reach * detector.radius)
    height = optics.focus_at(focus, k)
    even = Symmetry(*effects.aberration.even) if effects.aberration else EVEN
    lens: Straight | Turning = STRAIGHT
    if effects.aberration and effects.turned:
        index = scene.objective.material.index(k).real
        lens = turning(effects.aberration, optics.numerical_aperture, index)
    found = integrate_nodes(
        scene, within, height, optics.band, accuracy, optics.max_intersections, wavenumber=k,
        falloff=series_of(effects.falloff, reach, k), lens=lens, even=even, placed=True,
    )  # fmt: skip
    carry, regions = FIELD if effects.vectorial else AMPLITUDE, 0
    if lengths:
        regions = len(scene.regions)
        carry = with_lengths(carry, regions)
    numbers = np.zeros((FIRST_CARRIED + carry.size, found.light.path.size))
    if effects.vectorial or effects.aplanatic or effects.aberration is not None or lengths:
        vx, vy, _ = found.launched
        beam = Beam(vx, vy, np.sqrt(1 - vx * vx - vy * vy), np.ones(vx.size), np.arange(vx.size))
        follow = make_path_tracer(carry)
        numbers = follow(found.faces, found.light.path, through_lens(beam, lens), within, height)
    # nodes that do not take their path have no weight
    numbers = np.nan_to_num(numbers, nan=0.0)
    return Followed(found, numbers, regions)


def are_weighed(optics: Optics) -> bool:
    """Return whether an instrument does to rays what their integration does not know of."""
    effects = optics.effects
    phase = effects.aberration is not None and not effects.turned
    return effects.aplanatic or phase or optics.pupil != UniformPupil()


def weighed(optics: Optics, scene: Scene, found: Followed, k: float) -> Weighed:
    """Weigh the rays of a point at a wavenumber of their band, 1/µm."""
    (light, _, (vx, vy, carried)), numbers, regions = found
    effects, aperture = optics.effects, optics.numerical_aperture
    index, (out_x, out_y) = scene.objective.material.index(k).real, numbers[[AT_VX, AT_VY]]
    through = passed(optics, index, (vx, vy), (out_x, out_y))
    pupil = optics.pupil.amplitude(index * np.hypot(vx, vy), aperture, k)
    factor, length = pupil * through.factor, light.optical_path_length + through.path
    end = len(numbers) - regions
    fields = np.ones((2, light.path.size), np.complex128)
    if effects.vectorial:
        jones = jones_of(numbers[FIRST_CARRIED:end], out_x, out_y)
        # light turned from one to the other cancels with that of the mirrored ray
        there = carried != 0
        fields = np.where(there, [jones[:, 0, 0], jones[:, 1, 1]] / np.where(there, carried, 1), 0)
    ways = numbers[end:].copy() if regions else None
    if ways is not None:
        ways[0] += through.in_glass
    most = float(np.abs(factor).max(initial=0.0) * np.abs(fields).max(initial=0.0))
    return Weighed(
        light._replace(
            amplitude=light.amplitude * factor, rough_amplitude=light.rough_amplitude * factor,
            optical_path_length=length, missing=light.missing * max(most, 1.0), lengths=ways,
        ),
        fields,
    )  # fmt: skip
