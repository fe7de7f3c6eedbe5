"""A slow, literal reading of the thesis, kept as an oracle for the tests of the fast code.

Nothing here is clever. One ray is one object; every step follows the words of ``thesis.txt``
(section and equation numbers below are the thesis's), settled where the thesis is open by
``design.md`` section 1. It shares no code with the package, so agreement means something.

Units: lengths in um, wavenumbers in 1/um, phases in rad, phase slopes in rad/um = mrad/nm.
Axes: z is up along the optical axis, the glass-water plane is z = 0 with the glass below it; the
cylinder's axis is y and its centre is (x, z) = (0, gap + d/2).

A ray knows the medium it is in and the surface it stands on, which decides what it can meet next.
There are no epsilon offsets, and a gap of exactly zero works.

Examples
--------
>>> scene = Scene(diameter=1.4)
>>> traced = trace_all(scene, Instrument(), Settings(rays=1), focus=0.8774)
>>> [d.path for d in traced.detections if abs(d.amplitude) > 0.02]
['PR', 'PT CR PT', 'PT CT CR CT PT']
>>> round(traced.detections[0].optical_path_length, 9)  # down to the plane from the focus and back
-2.667296
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import curve_fit

Vector = tuple[float, float, float]
Array = np.ndarray

GLASS, WATER, NEURON = "glass", "water", "neuron"
OBJECTIVE, PLANE, CYLINDER = "O", "P", "C"

# What becomes of the last straight piece of a ray.
DETECTED = "detected"
MISSED_OBJECTIVE = "missed the objective"
MISSED_DETECTOR = "missed the detector"
ESCAPED = "escaped"
EXHAUSTED = "stopped at max_intersections"


# ---------------------------------------------------------------------------------------------
# The set-up (section 3)
# ---------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Scene:
    """Glass below z = 0, water above it, and a cylinder (the neuron) lying `gap` above the glass.

    Parameters
    ----------
    n_glass, n_water, n_neuron : float
        Refractive indices.
    gap, diameter : float
        Water between glass and cylinder, and the cylinder's diameter, in um.
    """

    n_glass: float = 1.52
    n_water: float = 1.33
    n_neuron: float = 1.39
    gap: float = 0.005
    diameter: float = 1.4

    @property
    def radius(self) -> float:
        """Radius of the cylinder in um."""
        return self.diameter / 2

    @property
    def centre_z(self) -> float:
        """Height of the cylinder's axis in um."""
        return self.gap + self.diameter / 2

    def index(self, medium: str) -> float:
        """Refractive index of a medium."""
        return {GLASS: self.n_glass, WATER: self.n_water, NEURON: self.n_neuron}[medium]


@dataclass(frozen=True)
class Instrument:
    """The objective and the fibre behind it; lengths in um."""

    numerical_aperture: float = 1.2
    focus_distance: float = 300.0
    magnification: float = 20.0
    core_diameter: float = 4.4

    @property
    def detector_radius(self) -> float:
        """Radius R_det of the fibre's core, projected into the focal plane, in um."""
        return self.core_diameter / (2 * self.magnification)

    @property
    def focal_length(self) -> float:
        """Focal length f in um: 1/f = 1/focus_distance + 1/(M focus_distance)."""
        return self.focus_distance * self.magnification / (self.magnification + 1)

    def aperture_radius(self, n_glass: float) -> float:
        """Radius R of the disk on the objective plane that rays come from and return to, in um."""
        half_angle = math.asin(self.numerical_aperture / n_glass)
        return self.focus_distance * math.tan(half_angle)


@dataclass(frozen=True)
class Settings:
    """How much to trace.

    Parameters
    ----------
    rays : int
        Rays launched, eq. (3).
    max_intersections : int
        Meetings with the plane and the cylinder allowed on one ray; the objective does not count.
    min_amplitude : float
        A child ray weaker than this fraction of the launch amplitude is not traced.
    """

    rays: int = 3000
    max_intersections: int = 11
    min_amplitude: float = 0.0


@dataclass(frozen=True)
class Ray:
    """One straight piece of light: where it starts, where it heads, and what it has been through.

    Parameters
    ----------
    position, direction : Vector
        Starting point in um and unit direction.
    amplitude, optical_path_length : float
        Signed amplitude, and optical path length in um at `position`.
    medium, surface : str
        The medium it travels in and the surface it stands on.
    meetings : tuple of str
        Meetings so far, each the surface (P, C) and then R or T: ``("PT", "CR", "PT")``.
    """

    position: Vector
    direction: Vector
    amplitude: float
    optical_path_length: float
    medium: str
    surface: str
    meetings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Detection:
    """A ray that reached the fibre.

    Parameters
    ----------
    ray : int
        Index of the launched ray it descends from.
    path : str
        Its meetings, like ``"PT CR PT"``.
    amplitude : float
        Signed amplitude E, with the launch amplitude (1/N) and the detector's falloff.
    optical_path_length : float
        Lambda in um, with the lens correction.
    rho : float
        Radius in um at which it crosses the focal plane once traced back.
    """

    ray: int
    path: str
    amplitude: float
    optical_path_length: float
    rho: float


@dataclass
class Traced:
    """All that tracing gave.

    Parameters
    ----------
    detections : list of Detection
        In order of launched ray, then depth first with the reflected child before the transmitted.
    segments : int
        Straight pieces traced: every launched ray and every child that was traced is one, whether
        it meets a surface, is detected, is lost, or stops because its meetings are used up.
    fates : Counter
        How many straight pieces ended each way without meeting the plane or the cylinder.
    not_traced : int
        Children below min_amplitude; they are not in `segments`.
    """

    detections: list[Detection] = field(default_factory=list)
    segments: int = 0
    fates: Counter[str] = field(default_factory=Counter)
    not_traced: int = 0


# ---------------------------------------------------------------------------------------------
# Vectors
# ---------------------------------------------------------------------------------------------
def dot(a: Vector, b: Vector) -> float:
    """Dot product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Cross product."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def scale(s: float, a: Vector) -> Vector:
    """Scalar times vector."""
    return (s * a[0], s * a[1], s * a[2])


def add(a: Vector, b: Vector) -> Vector:
    """Sum of two vectors."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def subtract(a: Vector, b: Vector) -> Vector:
    """Difference of two vectors."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def norm(a: Vector) -> float:
    """Length of a vector."""
    return math.sqrt(dot(a, a))


# ---------------------------------------------------------------------------------------------
# 4.1 Ray generation
# ---------------------------------------------------------------------------------------------
def vogel_points(rays: int, radius: float) -> list[tuple[float, float]]:
    """Eq. (3): the sunflower pattern of points (x, y) on a disk; a single ray is the axial one."""
    if rays == 1:
        return [(0.0, 0.0)]
    phi = (math.sqrt(5) - 1) / 2
    points = []
    for j in range(rays):
        theta = 2 * math.pi * j * phi
        r = radius * math.sqrt(j / (rays - 1))
        points.append((r * math.cos(theta), r * math.sin(theta)))
    return points


def launch(
    scene: Scene,
    instrument: Instrument,
    focus: float,
    points: Sequence[tuple[float, float]],
    amplitudes: Sequence[float] | None = None,
) -> list[Ray]:
    """Rays from points (x, y) of the objective plane z = focus - focus_distance to the focus.

    They are in phase, with zero optical path length, at the focus (0, 0, focus): so it is
    -n_glass times the distance to the focus where they start. Amplitudes are 1/N unless given.
    """
    objective_z = focus - instrument.focus_distance
    if objective_z >= 0:
        raise ValueError("focus_distance must exceed the focus: the objective lies in glass")
    if amplitudes is None:
        amplitudes = [1 / len(points)] * len(points)
    rays = []
    for (x, y), amplitude in zip(points, amplitudes, strict=True):
        start = (x, y, objective_z)
        to_focus = subtract((0.0, 0.0, focus), start)
        distance = norm(to_focus)
        rays.append(
            Ray(
                position=start,
                direction=scale(1 / distance, to_focus),
                amplitude=amplitude,
                optical_path_length=-scene.n_glass * distance,
                medium=GLASS,
                surface=OBJECTIVE,
            )
        )
    return rays


# ---------------------------------------------------------------------------------------------
# 4.2 Intersection
# ---------------------------------------------------------------------------------------------
def distance_to_plane(ray: Ray, z: float) -> float | None:
    """Distance along the ray to a horizontal plane at height z, or None if it heads away from it.

    The shortest distance to the plane over the part of the unit direction normal to the plane.
    The caller knows on which side the ray is, so a negative distance can be rounding alone.
    """
    v_z = ray.direction[2]
    if v_z == 0:
        return None
    return max(0.0, (z - ray.position[2]) / v_z)


def distance_to_cylinder(scene: Scene, ray: Ray) -> float | None:
    """Distance along the ray to the cylinder, or None if it misses it (fig. 3).

    In the cross section (x, z): x runs from the ray's origin to the circle's centre,
    m = x . v_par / |v_par| is the distance to half way along the circle, and
    h = sqrt(r^2 - |x|^2 + m^2) (the thesis misprints it) the rest of it. d' = m - h for a ray
    outside, m + h for one inside, and d = d' / |v_par|.
    """
    r = scene.radius
    x, z = -ray.position[0], scene.centre_z - ray.position[2]
    v_x, v_z = ray.direction[0], ray.direction[2]
    v_par = math.sqrt(v_x**2 + v_z**2)
    if v_par == 0:
        return None
    m = (x * v_x + z * v_z) / v_par
    if ray.medium == NEURON:
        # Inside, a ray always stands on the cylinder: |x| = r, so that h = |m|.
        h = abs(m)
        return (m + h) / v_par
    if ray.surface == CYLINDER:
        return None  # Outside and standing on a convex surface: it leaves it for good.
    h_squared = r**2 - (x**2 + z**2) + m**2
    if m <= 0 or h_squared < 0:
        return None
    # The ray is outside, so that m >= h but for rounding (a cylinder that touches the glass).
    return max(0.0, m - math.sqrt(h_squared)) / v_par


def next_surface(scene: Scene, ray: Ray, objective_z: float) -> tuple[str, float] | None:
    """Find the closest surface ahead and the distance to it, or None for a ray that meets none."""
    up = ray.direction[2] > 0
    candidates: list[tuple[str, float | None]] = []
    if ray.medium == GLASS:
        if up:
            candidates.append((PLANE, distance_to_plane(ray, 0.0)))
        else:
            candidates.append((OBJECTIVE, distance_to_plane(ray, objective_z)))
    elif ray.medium == WATER:
        if not up:
            candidates.append((PLANE, distance_to_plane(ray, 0.0)))
        candidates.append((CYLINDER, distance_to_cylinder(scene, ray)))
    else:
        candidates.append((CYLINDER, distance_to_cylinder(scene, ray)))
    ahead = [(surface, distance) for surface, distance in candidates if distance is not None]
    return min(ahead, key=lambda pair: pair[1], default=None)


def advance(scene: Scene, ray: Ray, surface: str, distance: float, objective_z: float) -> Ray:
    """Carry a ray to the surface it meets: n times the distance is added to its OPL."""
    x, y, z = add(ray.position, scale(distance, ray.direction))
    if surface == PLANE:
        z = 0.0
    elif surface == OBJECTIVE:
        z = objective_z
    return replace(
        ray,
        position=(x, y, z),
        optical_path_length=ray.optical_path_length + scene.index(ray.medium) * distance,
        surface=surface,
    )


def normal(scene: Scene, ray: Ray) -> Vector:
    """Return the unit normal where the ray stands, on the side it came from: v . n < 0."""
    if ray.surface == PLANE:
        n = (0.0, 0.0, 1.0)
    else:
        n = (ray.position[0], 0.0, ray.position[2] - scene.centre_z)
        n = scale(1 / norm(n), n)
    return scale(-1.0, n) if dot(ray.direction, n) > 0 else n


def medium_beyond(ray: Ray) -> str:
    """Name the medium across the surface that the ray stands on."""
    if ray.surface == PLANE:
        return WATER if ray.medium == GLASS else GLASS
    return NEURON if ray.medium == WATER else WATER


# ---------------------------------------------------------------------------------------------
# 4.3 Transmission and reflection
# ---------------------------------------------------------------------------------------------
def reflect(v_i: Vector, n: Vector) -> Vector:
    """v_r = v_i - 2 (v_i . n) n (fig. 4)."""
    return subtract(v_i, scale(2 * dot(v_i, n), n))


def refract(v_i: Vector, n: Vector, n_i: float, n_t: float) -> Vector | None:
    """Snell's law in vectors (fig. 5), or None beyond the critical angle.

    v_t is the sum of -sqrt(1 - (n_i/n_t)^2 (1 - (v_i . n)^2)) n along the normal and
    (n_i/n_t) n x (v_i x n) along the surface.
    """
    ratio = n_i / n_t
    cos_squared_t = 1 - ratio**2 * (1 - dot(v_i, n) ** 2)
    if cos_squared_t < 0:
        return None
    along_normal = scale(-math.sqrt(cos_squared_t), n)
    along_surface = scale(ratio, cross(n, cross(v_i, n)))
    return add(along_normal, along_surface)


def fresnel(cos_i: float, cos_t: float, n_i: float, n_t: float) -> tuple[float, float]:
    """Amplitude factors r and t of unpolarised light (section 4.3.2); r < 0 when n_t > n_i."""
    r_par = (n_t * cos_i - n_i * cos_t) / (n_t * cos_i + n_i * cos_t)
    r_perp = (n_i * cos_i - n_t * cos_t) / (n_i * cos_i + n_t * cos_t)
    t_par = 2 * n_i * cos_i / (n_t * cos_i + n_i * cos_t)
    t_perp = 2 * n_i * cos_i / (n_i * cos_i + n_t * cos_t)
    r = math.sqrt((r_par**2 + r_perp**2) / 2)
    t = math.sqrt((t_par**2 + t_perp**2) / 2)
    return (-r if n_t > n_i else r), t


def split(scene: Scene, ray: Ray) -> list[Ray]:
    """Split a ray standing on the plane or the cylinder: reflected child, then transmitted.

    Beyond the critical angle r = +1 and there is no transmitted child.
    """
    n = normal(scene, ray)
    beyond = medium_beyond(ray)
    n_i, n_t = scene.index(ray.medium), scene.index(beyond)
    v_t = refract(ray.direction, n, n_i, n_t)
    if v_t is None:
        r = 1.0
    else:
        r, t = fresnel(-dot(ray.direction, n), -dot(v_t, n), n_i, n_t)
    children = [
        replace(
            ray,
            direction=reflect(ray.direction, n),
            amplitude=r * ray.amplitude,
            meetings=(*ray.meetings, ray.surface + "R"),
        )
    ]
    if v_t is not None:
        children.append(
            replace(
                ray,
                direction=v_t,
                amplitude=t * ray.amplitude,
                medium=beyond,
                meetings=(*ray.meetings, ray.surface + "T"),
            )
        )
    return children


# ---------------------------------------------------------------------------------------------
# 4.4 Detection
# ---------------------------------------------------------------------------------------------
def detect(
    scene: Scene, instrument: Instrument, focus: float, ray: Ray, index: int
) -> Detection | str:
    """Return what the fibre sees of a ray on the objective plane, or why it sees nothing.

    The ray must be within the aperture. It is traced back, as if all were glass, to the
    projection of the fibre in the plane z = focus, which takes n_glass times that distance off
    its optical path length (rule 4: from the projection to the fibre all rays of a point are
    alike). Between focal point and detector the point at radius rho is
    M (sqrt(f^2 + rho^2) - f) further away than the centre.
    """
    x, y, _ = ray.position
    if math.hypot(x, y) > instrument.aperture_radius(scene.n_glass):
        return MISSED_OBJECTIVE
    distance_back = instrument.focus_distance / -ray.direction[2]
    x, y, _ = subtract(ray.position, scale(distance_back, ray.direction))
    at_projection = ray.optical_path_length - scene.n_glass * distance_back
    rho = math.hypot(x, y)
    if rho >= instrument.detector_radius:
        return MISSED_DETECTOR
    f = instrument.focal_length
    return Detection(
        ray=index,
        path=" ".join(ray.meetings),
        amplitude=ray.amplitude * (1 - (rho / instrument.detector_radius) ** 2),
        optical_path_length=at_projection
        + instrument.magnification * (math.sqrt(f**2 + rho**2) - f),
        rho=rho,
    )


# ---------------------------------------------------------------------------------------------
# The tree of rays
# ---------------------------------------------------------------------------------------------
def follow(
    scene: Scene,
    instrument: Instrument,
    settings: Settings,
    focus: float,
    ray: Ray,
    index: int,
    weakest: float,
    traced: Traced,
) -> None:
    """Trace one straight piece and, depth first, all that comes of it; adds to `traced`."""
    objective_z = focus - instrument.focus_distance
    traced.segments += 1
    ahead = next_surface(scene, ray, objective_z)
    if ahead is None:
        traced.fates[ESCAPED] += 1
        return
    surface, distance = ahead
    if surface == OBJECTIVE:
        ray = advance(scene, ray, surface, distance, objective_z)
        outcome = detect(scene, instrument, focus, ray, index)
        if isinstance(outcome, Detection):
            traced.detections.append(outcome)
            outcome = DETECTED
        traced.fates[outcome] += 1
        return
    if len(ray.meetings) == settings.max_intersections:
        traced.fates[EXHAUSTED] += 1
        return
    ray = advance(scene, ray, surface, distance, objective_z)
    for child in split(scene, ray):
        if abs(child.amplitude) < weakest:
            traced.not_traced += 1
        else:
            follow(scene, instrument, settings, focus, child, index, weakest, traced)


def trace_rays(
    scene: Scene, instrument: Instrument, settings: Settings, focus: float, rays: Iterable[Ray]
) -> Traced:
    """Trace the trees of given launched rays (`settings.rays` is not read)."""
    traced = Traced()
    for index, ray in enumerate(rays):
        weakest = settings.min_amplitude * abs(ray.amplitude)
        follow(scene, instrument, settings, focus, ray, index, weakest, traced)
    return traced


def trace_all(scene: Scene, instrument: Instrument, settings: Settings, focus: float) -> Traced:
    """Launch the sunflower of rays at the focus and trace it: detections, segments and fates."""
    points = vogel_points(settings.rays, instrument.aperture_radius(scene.n_glass))
    rays = launch(scene, instrument, focus, points)
    return trace_rays(scene, instrument, settings, focus, rays)


def trace(
    scene: Scene, instrument: Instrument, settings: Settings, focus: float
) -> list[Detection]:
    """Trace, for the detections alone; `trace_all` gives the number of segments too."""
    return trace_all(scene, instrument, settings, focus).detections


# ---------------------------------------------------------------------------------------------
# Spectrum (end of 4.4)
# ---------------------------------------------------------------------------------------------
def wavenumbers(lambda_min: float = 0.65, lambda_max: float = 0.9, samples: int = 1000) -> Array:
    """Wavenumbers 2 pi / lambda in 1/um, uniform, increasing, both ends included, (samples,)."""
    return np.linspace(2 * math.pi / lambda_max, 2 * math.pi / lambda_min, samples)


def field_at(detections: Iterable[Detection], k: float) -> complex:
    """Sum over rays of E exp(i k Lambda) at one wavenumber, in plain Python."""
    phases = [(d.amplitude, k * d.optical_path_length) for d in detections]
    return complex(
        math.fsum(amplitude * math.cos(phase) for amplitude, phase in phases),
        math.fsum(amplitude * math.sin(phase) for amplitude, phase in phases),
    )


def spectrum(detections: Sequence[Detection], k: Array) -> Array:
    """I(k) = |sum over rays of E exp(i k Lambda)|^2, shape (k,)."""
    amplitude = np.array([d.amplitude for d in detections], dtype=float)
    optical_path_length = np.array([d.optical_path_length for d in detections], dtype=float)
    field_of_k = np.array([np.sum(amplitude * np.exp(1j * k_ * optical_path_length)) for k_ in k])
    intensity: Array = np.abs(field_of_k) ** 2
    return intensity


def ideal_spectra(n_neuron: float, diameters: Sequence[float], k: Array) -> Array:
    """Spectra cos(2 n d k) of two parallel plates (section 2.2), shape (diameters, k)."""
    return np.array([np.cos(2 * n_neuron * d * k) for d in diameters])


# ---------------------------------------------------------------------------------------------
# 5 Signal processing
# ---------------------------------------------------------------------------------------------
def preprocess(intensity: Array) -> Array:
    """Fig. 8: minus the midpoint, times a Hamming window, minus the mean, shape (k,)."""
    midpoint = (np.max(intensity) + np.min(intensity)) / 2
    windowed = (intensity - midpoint) * np.hamming(len(intensity))
    processed: Array = windowed - np.mean(windowed)
    return processed


def fft_phase(intensity: Array) -> tuple[Array, Array]:
    """Magnitude and phase in (-pi, pi] of each Fourier component of a spectrum (figs. 9 to 11)."""
    components = np.fft.rfft(preprocess(intensity))
    return np.abs(components), np.angle(components)


@dataclass(frozen=True)
class PhaseSlopes:
    """Phase slopes over a range of diameters (fig. 12), in mrad/nm.

    Parameters
    ----------
    slope : ndarray, (diameters,)
        Of the component of greatest magnitude at each diameter.
    component : ndarray of int, (diameters,)
        Which component that is.
    component_slope : ndarray, (diameters, components)
        Of every component.
    """

    slope: Array
    component: Array
    component_slope: Array


def phase_slopes(spectra: Array, diameters: Sequence[float]) -> PhaseSlopes:
    """Phase of each component, unwrapped along diameter, differentiated by central differences.

    Parameters
    ----------
    spectra : ndarray, (diameters, k)
        Intensities.
    diameters : sequence of float
        In um, at least two.
    """
    magnitudes, phases = zip(*(fft_phase(intensity) for intensity in spectra), strict=True)
    unwrapped = np.unwrap(np.array(phases), axis=0)
    component_slope = np.gradient(unwrapped, np.asarray(diameters, dtype=float), axis=0)
    component = np.argmax(np.array(magnitudes), axis=1)
    slope = np.array([component_slope[i, c] for i, c in enumerate(component)])
    return PhaseSlopes(slope, component, component_slope)


def predicted_phase_slope(n_neuron: float, k: Array) -> float:
    """Eq. (2): n (k_min + k_max), in mrad/nm."""
    return float(n_neuron * (k[0] + k[-1]))


# ---------------------------------------------------------------------------------------------
# 6 Focus
# ---------------------------------------------------------------------------------------------
def focus_scan(
    scene: Scene,
    instrument: Instrument,
    settings: Settings,
    foci: Sequence[float],
    k: Array,
) -> tuple[Array, Array]:
    """Mean intensity over k, and the number of detections, at each focus position (fig. 6)."""
    intensities, counts = [], []
    for focus in foci:
        detections = trace(scene, instrument, settings, focus)
        intensities.append(np.mean(spectrum(detections, k)))
        counts.append(len(detections))
    return np.array(intensities), np.array(counts)


def gaussian(z: Array, centre: float, width: float, amplitude: float, offset: float) -> Array:
    """Gaussian of standard deviation `width`, plus a constant."""
    values: Array = amplitude * np.exp(-((z - centre) ** 2) / (2 * width**2)) + offset
    return values


@dataclass(frozen=True)
class GaussianFit:
    """A least-squares Gaussian plus constant; all NaN when there is no peak inside the foci."""

    centre: float
    width: float
    amplitude: float
    offset: float


def fit_gaussian(foci: Sequence[float], intensity: Sequence[float]) -> GaussianFit:
    """Unweighted least-squares fit of `gaussian` to intensity over focus position."""
    z, y = np.asarray(foci, dtype=float), np.asarray(intensity, dtype=float)
    guess = [z[np.argmax(y)], np.ptp(z) / 4, np.ptp(y), np.min(y)]
    try:
        (centre, width, amplitude, offset), _ = curve_fit(gaussian, z, y, p0=guess, maxfev=20000)
    except RuntimeError:
        return GaussianFit(math.nan, math.nan, math.nan, math.nan)
    if amplitude <= 0 or not z.min() < centre < z.max():
        return GaussianFit(math.nan, math.nan, math.nan, math.nan)
    return GaussianFit(float(centre), float(abs(width)), float(amplitude), float(offset))


def law(diameters: Sequence[float], centres: Sequence[float]) -> tuple[float, float]:
    """Slope and intercept (um) of the unweighted straight line through the centres (fig. 7)."""
    slope, intercept = np.polyfit(diameters, centres, 1)
    return float(slope), float(intercept)
