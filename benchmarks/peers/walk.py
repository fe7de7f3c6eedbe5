"""One path through the scene, chosen by given numbers: what path tracing and Metropolis sample.

At each surface a number chooses between the reflected and the transmitted ray, where the ray tree
of octsim follows both; two more choose the place on the objective. The mean over all numbers from 0
to 1 is the detected field.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from peers.ray_job import FOCUS, MEETINGS, Job
from trees import indices

from octsim.optics.beam import aim
from octsim.optics.detector import Acceptance, Detector, Outcome, at_plane, falloff, fate, to_fibre
from octsim.optics.interface import Vector, cos_transmitted_squared, fresnel, reflect, refract

GLASS, WATER, NEURON = 0, 1, 2
NUMBERS = 2 + MEETINGS
"""Numbers from 0 to 1 that choose a path."""


class Setting(NamedTuple):
    """What a path goes through; lengths in µm."""

    index: tuple[float, float, float]
    """Of glass, water and neuron."""
    height: float
    """Of the cylinder's axis."""
    radius: float
    focus: float
    detector: Detector


def setting_of(job: Job) -> Setting:
    """Return what a path of a job goes through."""
    glass, water, neuron = indices(job.scene)
    cylinder = job.cylinder
    return Setting((glass, water, neuron), cylinder.z, cylinder.radius, FOCUS, job.detector)


@njit(cache=False)
def to_cylinder(setting: Setting, at: Vector, along: Vector, inside: bool) -> float:
    """Return the distance to the cylinder: the far end of a chord, or the near side; else −1."""
    z = at.z - setting.height
    a = along.x * along.x + along.z * along.z
    b = at.x * along.x + z * along.z
    if inside:
        return -2 * b / a
    root = b * b - a * (at.x * at.x + z * z - setting.radius**2)
    return (-b - math.sqrt(root)) / a if root > 0 and b < 0 else -1.0


@njit(cache=False)
def walk(setting: Setting, chosen: NDArray[np.float64], power: float) -> tuple[float, float, float]:
    """Follow one path.

    Parameters
    ----------
    setting : Setting
    chosen : ndarray, shape (NUMBERS,)
        Place on the objective, and a choice for each meeting.
    power : float
        A ray is chosen with a probability like this power of its amplitude: 2 is path tracing as
        renderers do it, by energy.

    Returns
    -------
    amplitude, path : float
        Amplitude over the probability of the path, weighted by the detector (0 if it does not get
        there), and optical path, µm.
    returned : float
        The part of its light, over the probability, that comes back through the objective.
    """
    detector = setting.detector
    radius = detector.objective_radius * math.sqrt(chosen[0])
    turn = 2 * math.pi * chosen[1]
    vx, vy, vz = aim(radius * math.cos(turn), radius * math.sin(turn), detector.focus_distance)
    along = Vector(vx, vy, vz)
    down = -setting.focus / vz
    at = Vector(vx * down, vy * down, 0.0)
    path, amplitude, energy = setting.index[GLASS] * down, 1.0, 1.0
    medium, on_cylinder = GLASS, False
    for meeting in range(MEETINGS):
        if on_cylinder:
            normal = Vector(at.x / setting.radius, 0.0, (at.z - setting.height) / setting.radius)
            beyond = NEURON if medium == WATER else WATER
        else:
            normal = Vector(0.0, 0.0, 1.0)
            beyond = WATER if medium == GLASS else GLASS
        cosine = along.x * normal.x + along.y * normal.y + along.z * normal.z
        if cosine > 0:
            normal, cosine = Vector(-normal.x, -normal.y, -normal.z), -cosine
        cosine = -cosine
        n_here, n_there = setting.index[medium], setting.index[beyond]
        squared = cos_transmitted_squared(n_here, n_there, cosine)
        r, t = fresnel(n_here, n_there, cosine, math.sqrt(squared)) if squared > 0 else (1.0, 0.0)
        share = abs(r) ** power / (abs(r) ** power + t**power)
        if chosen[2 + meeting] < share:
            along = reflect(along, normal, cosine)
            amplitude, energy = amplitude * r / share, energy * r * r / share
        else:
            along = refract(along, normal, n_here, n_there, cosine, math.sqrt(squared))
            amplitude, energy = amplitude * t / (1 - share), energy * (1 - r * r) / (1 - share)
            medium = beyond
        if medium == GLASS:
            floor = setting.focus - detector.focus_distance
            to_focus, at_focus = at_plane(setting.focus, at, along)
            within = Acceptance(detector.objective_radius, detector.radius)
            outcome = fate(within, at_focus, at_plane(floor, at, along)[1])
            returned = 0.0 if outcome == Outcome.OFF_OBJECTIVE else energy
            if outcome != Outcome.DETECTED:
                return 0.0, 0.0, returned
            path += to_fibre(detector, setting.index[GLASS], to_focus, at_focus)
            return amplitude * falloff(at_focus / detector.radius**2), path, returned
        if medium == NEURON or not on_cylinder:
            step, hits_cylinder = to_cylinder(setting, at, along, medium == NEURON), True
        else:
            step, hits_cylinder = -1.0, False
        if step < 0 and along.z < 0:
            step, hits_cylinder = -at.z / along.z, False
        if step < 0:
            break
        at = Vector(at.x + step * along.x, at.y + step * along.y, at.z + step * along.z)
        path += step * setting.index[medium]
        on_cylinder = hits_cylinder
    return 0.0, 0.0, 0.0


@njit(cache=False)
def path_tracing(
    setting: Setting, samples: int, power: float, seed: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Draw paths one by one; amplitudes and paths of those detected, and the part that returns."""
    np.random.seed(seed)  # noqa: NPY002
    amplitude, path = np.empty(samples), np.empty(samples)
    found, returned, chosen = 0, 0.0, np.empty(NUMBERS)
    for _ in range(samples):
        for i in range(NUMBERS):
            chosen[i] = np.random.random()  # noqa: NPY002
        a, length, energy = walk(setting, chosen, power)
        returned += energy
        if a != 0:
            amplitude[found], path[found] = a / samples, length
            found += 1
    return amplitude[:found], path[:found], returned / samples


@njit(cache=False)
def metropolis(
    setting: Setting, samples: int, power: float, seed: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Draw paths as often as they are bright, by small changes of one and by new ones.

    Metropolis light transport in the space of the numbers (Kelemen et al., Comput. Graph. Forum 21,
    531 (2002)); 3 of 10 proposals are new paths, and their mean brightness is the normalisation.
    Each proposal counts by the probability that it is accepted, what it would replace by the rest.
    """
    np.random.seed(seed)  # noqa: NPY002
    amplitude, path = np.empty(2 * samples), np.empty(2 * samples)
    now, proposed = np.random.random(NUMBERS), np.empty(NUMBERS)  # noqa: NPY002
    a_now, path_now, _ = walk(setting, now, power)
    while a_now == 0:
        now = np.random.random(NUMBERS)  # noqa: NPY002
        a_now, path_now, _ = walk(setting, now, power)
    bright, fresh, found = 0.0, 0, 0
    for _ in range(samples):
        new = np.random.random() < 0.3  # noqa: NPY002
        for i in range(NUMBERS):
            step = np.random.random()  # noqa: NPY002
            if new:
                proposed[i] = step
            else:
                size = math.exp(-math.log(1024 / 16) * abs(2 * step - 1)) / 16
                proposed[i] = (now[i] + math.copysign(size, step - 0.5)) % 1
        a, length, _ = walk(setting, proposed, power)
        if new:
            fresh += 1
            bright += abs(a)
        accepted = min(1.0, abs(a / a_now))
        if accepted > 0:
            amplitude[found], path[found] = accepted * math.copysign(1.0, a), length
            found += 1
        amplitude[found], path[found] = (1 - accepted) * math.copysign(1.0, a_now), path_now
        found += 1
        if np.random.random() < accepted:  # noqa: NPY002
            now[:] = proposed
            a_now, path_now = a, length
    scale = bright / max(fresh, 1) / samples
    return amplitude[:found] * scale, path[:found]
