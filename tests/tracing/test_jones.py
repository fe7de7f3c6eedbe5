"""Rays that carry fields, against a slow literal tracer, symmetry, and the thesis's split."""

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
import reference
from numpy.typing import NDArray

from octsim.optics.beam import Beam, vogel_beam
from octsim.optics.detector import Detector, fibre_detector
from octsim.optics.interface import Vector
from octsim.optics.materials import Constant
from octsim.optics.polarisation import LEFT, UNPOLARISED, Polarisation, detected_fields, linear
from octsim.optics.scene import NEURON_ON_GLASS, Scene, neuron_on_glass
from octsim.tracing.jones import jones_of, trace_fields
from octsim.tracing.light_paths import path_name
from octsim.tracing.tree import Arrivals, arrivals

Complex = NDArray[np.complex128]
GLASS, WATER, NEURON = 1.52, 1.33, 1.39
DIAMETER, FOCUS, RAYS = 1.4, 0.877, 300
FAR = 300.0


def objective(aperture: float = 1.2, core: float = 4.4) -> Detector:
    return fibre_detector(aperture, GLASS, FAR, 20.0, core)


def spiral(detector: Detector, rays: int = RAYS) -> Beam:
    return vogel_beam(rays, detector.objective_radius, FAR)


def scene(neuron: float = NEURON) -> Scene:
    return neuron_on_glass(Constant(GLASS), Constant(WATER), Constant(neuron), 0.005, DIAMETER)


def towards(*directions: tuple[float, float]) -> Beam:
    vx, vy = np.array(directions, float).T
    n = vx.size
    return Beam(vx, vy, np.sqrt(1 - vx**2 - vy**2), np.full(n, 1 / n), np.arange(n))


def jones(found: Arrivals) -> Complex:
    return jones_of(found.carried, found.vx, found.vy)


def intensity(
    polarisation: Polarisation, found: Arrivals, phase: NDArray[np.float64] | float = 0.0
) -> float:
    fields = detected_fields(polarisation, jones(found) * np.exp(1j * phase)[..., None, None])
    return float(np.mean(np.abs(fields.sum(axis=1)) ** 2))


class Literal:
    """Every ray and its 3x2 matrix of fields, split by s and p as they are defined."""

    def __init__(self, aperture: float, core: float, focus: float, faintest: float) -> None:
        self.focus = focus
        self.scene, self.faintest = reference.Scene(GLASS, WATER, NEURON, 0.005, DIAMETER), faintest
        self.instrument = reference.Instrument(aperture, core_diameter=core)
        self.found: dict[tuple[int, str], tuple[Complex, float]] = {}
        points = reference.vogel_points(RAYS, self.instrument.aperture_radius(GLASS))
        rays = reference.launch(self.scene, self.instrument, focus, points)
        for index, ray in enumerate(rays):
            self.follow(ray, rotation((0, 0, 1), ray.direction)[:, :2].astype(complex), index)

    def follow(self, ray: reference.Ray, field: Complex, index: int) -> None:
        plane = self.focus - self.instrument.focus_distance
        ahead = reference.next_surface(self.scene, ray, plane)
        if ahead is None:
            return
        ray = reference.advance(self.scene, ray, *ahead, plane)
        if ray.surface == reference.OBJECTIVE:
            seen = reference.detect(self.scene, self.instrument, self.focus, ray, index)
            if not isinstance(seen, str):
                detected = (rotation(ray.direction, (0, 0, -1)) @ field)[:2]
                self.found[index, seen.path] = detected, seen.optical_path_length
        elif len(ray.meetings) < 11:
            self.split(ray, field, index)

    def split(self, ray: reference.Ray, field: Complex, index: int) -> None:
        n = reference.normal(self.scene, ray)
        medium = reference.medium_beyond(ray)
        n_i, n_t = self.scene.index(ray.medium), self.scene.index(medium)
        v_r = reference.reflect(ray.direction, n)
        v_t = reference.refract(ray.direction, n, n_i, n_t)
        cos_i = -reference.dot(ray.direction, n)
        cos_t = cmath.sqrt(1 - (n_i / n_t) ** 2 * (1 - cos_i**2))
        s = reference.cross(ray.direction, n)
        s = reference.scale(1 / reference.norm(s), s) if reference.norm(s) > 1e-12 else (1, 0, 0)
        s_part = np.array(s) @ field
        p_part = np.array(reference.cross(ray.direction, s)) @ field
        r_s = (n_i * cos_i - n_t * cos_t) / (n_i * cos_i + n_t * cos_t)
        r_p = (n_t * cos_i - n_i * cos_t) / (n_t * cos_i + n_i * cos_t)
        t_s = 2 * n_i * cos_i / (n_i * cos_i + n_t * cos_t)
        t_p = 2 * n_i * cos_i / (n_t * cos_i + n_i * cos_t)
        returned = np.outer(s, r_s * s_part) + np.outer(reference.cross(v_r, s), r_p * p_part)
        met = ray.meetings
        child = replace(ray, direction=v_r, meetings=(*met, ray.surface + "R"))
        if strength(returned) >= self.faintest:
            self.follow(child, returned, index)
        if v_t is not None:
            through = np.outer(s, t_s * s_part) + np.outer(reference.cross(v_t, s), t_p * p_part)
            child = replace(ray, direction=v_t, medium=medium, meetings=(*met, ray.surface + "T"))
            if strength(through) >= self.faintest:
                self.follow(child, through, index)


def strength(field: Complex) -> float:
    return float(np.sqrt(np.sum(np.abs(field) ** 2) / 2))


def rotation(one: reference.Vector, other: reference.Vector) -> NDArray[np.float64]:
    """Return the least rotation from one direction to another, by Rodrigues's formula."""
    x, y, z = reference.cross(one, other)
    sine = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turned: NDArray[np.float64] = sine + sine @ sine / (1 + reference.dot(one, other))
    return np.eye(3) + turned


@pytest.mark.parametrize(
    ("aperture", "core", "focus", "faintest", "detected"),
    [
        (1.2, 4.4, FOCUS, 0.0, 60),
        (1.2, 4.4, FOCUS, 0.02, 30),
        (1.2, 100.0, FOCUS, 0.0, 1000),
        (1.45, 100.0, 0.1, 0.0, 1000),  # totally reflecting
    ],
)
def test_fields_are_those_of_a_literal_tracer(
    aperture: float, core: float, focus: float, faintest: float, detected: int
) -> None:
    detector = objective(aperture, core)
    beam, slow = spiral(detector), Literal(aperture, core, focus, faintest).found
    found = arrivals(scene(), beam, detector, focus, 11, faintest, tree=trace_fields)
    assert (np.abs(jones(found).imag).max() > 0.1) == (aperture > WATER)
    paths = (path_name(code, NEURON_ON_GLASS) for code in found.path.tolist())
    keys = zip(beam.number[found.ray].tolist(), paths, strict=True)
    values = zip(jones(found), found.optical_path_length.tolist(), strict=True)
    fast = dict(zip(keys, values, strict=True))
    assert len(fast) >= detected
    for key in fast.keys() ^ slow.keys():
        assert np.abs((fast.get(key) or slow[key])[0]).max() < 1e-9, f"{key} is in one tree only"
    for key in fast.keys() & slow.keys():
        assert fast[key][0] == pytest.approx(slow[key][0], abs=1e-11), key
        assert fast[key][1] == pytest.approx(slow[key][1], abs=1e-9), key


def test_rays_go_where_those_that_carry_an_amplitude_go() -> None:
    detector = objective()
    plain = arrivals(scene(), spiral(detector), detector, FOCUS)
    found = arrivals(scene(), spiral(detector), detector, FOCUS, tree=trace_fields)
    for name in plain._fields:
        if name != "carried":
            assert np.array_equal(getattr(found, name), getattr(plain, name)), name


def test_fields_are_at_right_angles_to_their_rays() -> None:
    detector = objective()
    found = arrivals(scene(), spiral(detector), detector, FOCUS, tree=trace_fields)
    v = np.array([found.vx, found.vy, -np.sqrt(1 - found.vx**2 - found.vy**2)])
    along = np.einsum("cd,cipd->ipd", v, found.carried.reshape(3, 2, 2, -1))
    assert np.abs(along).max() < 1e-15


def test_the_axial_ray_keeps_its_polarisation_and_has_the_amplitude_of_the_thesis() -> None:
    detector = objective()
    plain = arrivals(scene(), spiral(detector, 1), detector, FOCUS)
    found = arrivals(scene(), spiral(detector, 1), detector, FOCUS, tree=trace_fields)
    assert found.path.size > 5
    for matrix, amplitude in zip(jones(found), plain.carried[0], strict=True):
        assert matrix == pytest.approx(amplitude * np.eye(2), rel=1e-13)


def test_rays_in_the_planes_of_symmetry_mix_nothing() -> None:
    beam = towards((0.3, 0.0), (-0.6, 0.0), (0.0, 0.1), (0.0, -0.7), (0.0, 0.0))
    wide = fibre_detector(1.2, GLASS, FAR, 20.0, 400.0)
    found = arrivals(scene(), beam, wide, FOCUS, tree=trace_fields)
    assert np.unique(found.ray).size == 5
    matrices = jones(found)
    assert np.all(matrices[:, 0, 1] == 0)
    assert np.all(matrices[:, 1, 0] == 0)


@pytest.mark.parametrize(("mirror_x", "mirror_y"), [(-1, 1), (1, -1), (-1, -1)])
def test_a_mirrored_beam_returns_mirrored_fields(mirror_x: int, mirror_y: int) -> None:
    detector = objective()
    beam = spiral(detector)
    mirrored = beam._replace(vx=mirror_x * beam.vx, vy=mirror_y * beam.vy)
    one = arrivals(scene(), beam, detector, FOCUS, tree=trace_fields)
    other = arrivals(scene(), mirrored, detector, FOCUS, tree=trace_fields)
    sign = np.array([mirror_x, mirror_y])
    assert np.array_equal(jones(one), sign[:, None] * jones(other) * sign)


def test_at_a_single_plane_the_mean_over_polarisations_is_the_thesis() -> None:
    detector = objective()
    plain = arrivals(scene(WATER), spiral(detector), detector, 0.01, 1)
    found = arrivals(scene(WATER), spiral(detector), detector, 0.01, 1, tree=trace_fields)
    squared = np.sum(np.abs(jones(found)) ** 2, axis=(1, 2)) / 2
    assert squared == pytest.approx(plain.carried[0] ** 2, rel=1e-13)


@pytest.mark.parametrize(("aperture", "expected"), [(1.2, 0.379), (1.45, 0.0166)])
def test_a_bare_plane_at_the_focus_returns_less_than_the_split_of_the_thesis(
    aperture: float, expected: float
) -> None:
    detector = objective(aperture)
    beam = spiral(detector, 20_000)
    plain = arrivals(scene(WATER), beam, detector, 0.0, 1)
    found = arrivals(scene(WATER), beam, detector, 0.0, 1, tree=trace_fields)
    assert plain.ray.size == beam.vx.size
    thesis = plain.carried[0].sum() ** 2
    ratio = intensity(UNPOLARISED, found) / thesis
    assert ratio == pytest.approx(expected, rel=3e-3)
    # so for every polarisation, as the plane and the objective are round
    for state in (linear(0.4), LEFT):
        assert intensity(Polarisation(state), found) / thesis == pytest.approx(ratio, rel=1e-3)
    # what returns of a ray is the mean of both, as the azimuthal part sees s and the radial p
    sine = np.hypot(beam.vx, beam.vy)
    cos_i, cos_t = np.sqrt(1 - sine**2), np.sqrt((1 - (GLASS / WATER * sine) ** 2).astype(complex))
    r_s = (GLASS * cos_i - WATER * cos_t) / (GLASS * cos_i + WATER * cos_t)
    r_p = (WATER * cos_i - GLASS * cos_t) / (WATER * cos_i + GLASS * cos_t)
    mean = ((r_s - r_p) / 2).sum()
    assert intensity(UNPOLARISED, found) == pytest.approx(abs(mean) ** 2, rel=1e-4)


def test_polarisations_add_up_to_all_light() -> None:
    detector = objective()
    found = arrivals(scene(), spiral(detector), detector, FOCUS, tree=trace_fields)
    phase = 2 * math.pi / 0.75 * found.optical_path_length
    for state in (None, linear(0.3), LEFT):
        parts = [intensity(Polarisation(state, a), found, phase) for a in (0.5, 0.5 + math.pi / 2)]
        assert sum(parts) == pytest.approx(intensity(Polarisation(state), found, phase))
    halves = [intensity(Polarisation(linear(a)), found, phase) for a in (0.2, 0.2 + math.pi / 2)]
    assert np.mean(halves) == pytest.approx(intensity(UNPOLARISED, found, phase))


def test_what_is_detected_of_diagonal_matrices_is_that_of_a_cylinder_along_y() -> None:
    matrices = np.array([np.diag([0.3 - 0.4j, -0.7 + 0.2j])])
    for state in (None, linear(0.3), LEFT):
        for analyser in (None, 0.9):
            fields = detected_fields(Polarisation(state, analyser), matrices)[:, 0]
            inputs = [(1, 0), (0, 1)] if state is None else [state]
            returned = [matrices[0] @ np.array(e) for e in inputs]
            axis = np.eye(2) if analyser is None else np.array([linear(analyser)])
            expected = sum(np.sum(np.abs(axis @ e) ** 2) for e in returned) / len(inputs)
            assert np.mean(np.abs(fields) ** 2) == pytest.approx(expected)


def test_no_rays_are_no_fields() -> None:
    none = jones_of(np.empty((12, 0)), np.empty(0), np.empty(0))
    assert none.shape == (0, 2, 2)
    assert detected_fields(UNPOLARISED, none).shape == (4, 0)


def test_a_field_behind_the_objective_is_horizontal() -> None:
    # a field along the turned x axis, of a ray that heads down aslant
    v = Vector(0.6, 0.0, -0.8)
    carried = np.zeros((12, 1))
    carried[[0, 8], 0] = 0.8, 0.6  # x and z, of the light that went in along x
    matrix = jones_of(carried, np.array([v.x]), np.array([v.y]))[0]
    assert matrix == pytest.approx(np.array([[1, 0], [0, 0]]), abs=1e-15)
