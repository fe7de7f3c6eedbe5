"""The thesis's spiral at one wavenumber, past everything that the objective does to light."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.optics.beam import (
    Beam,
    DisplacedBeam,
    vogel_beam,
)
from octsim.optics.detector import RIM, Acceptance, Detector, lens_correction
from octsim.optics.polarisation import detected_fields
from octsim.optics.rulings import rulings
from octsim.optics.scene import Scene
from octsim.optics.turned_rays import displacement
from octsim.schemes.light import Optics, Options
from octsim.schemes.ray_trees import rays_at_once
from octsim.schemes.through_objective import passed
from octsim.tracing.carry import AMPLITUDE
from octsim.tracing.jones import FIELD, jones_of
from octsim.tracing.kernel import make_tree
from octsim.tracing.lengths import with_lengths
from octsim.tracing.tree import Arrivals, arrivals

X, Y, RIM_SQUARED, LENGTH, SINE, FIRST_FIELD = range(6)
"""Numbers of a ray that comes back; those of its field follow, and of its ways in the regions."""
_EVERYWHERE = Acceptance(np.inf, np.inf)


class Returned(NamedTuple):
    """Rays that come back at one wavenumber, D of them; not weighed by the detector."""

    ray: NDArray[np.int64]
    """Number of the launched ray, (D,); of rulings those of the second family count on."""
    path: NDArray[np.int64]
    """Code of the light path, (D,)."""
    numbers: NDArray[np.float64]
    """(Q, D): where it leaves the focal plane (x, y, µm), its squared radius at the objective over
    that of the rim, its optical path to the fibre (µm), n sin θ at launch over the numerical
    aperture, real and imaginary parts of what it has in each detected field (real parts alone of
    the thesis's light), and the lengths of its way in each region (µm), where asked for."""
    segments: int
    outcomes: NDArray[np.int64]


@dataclass(frozen=True)
class Spiral:
    """A spiral of rays through a scene, at any wavenumber.

    Parameters
    ----------
    optics : Optics
        What it is sent through.
    options : mapping
        ``rays``, their number, and ``min_amplitude``, below which a ray is dropped.
    scene : Scene
    focus : float
        Height of the focus above z = 0 as if all were glass, µm.
    lengths : bool
        Whether the lengths of ways are asked for.
    """

    optics: Optics
    options: Options
    scene: Scene
    focus: float
    lengths: bool

    @property
    def parts(self) -> int:
        """Numbers that a ray's part in the detected fields is: one, or two for each field."""
        if not self.optics.effects.vectorial:
            return 1
        return 2 * len(detected_fields(self.optics.polarisation, np.eye(2, dtype=complex)[None]))

    @property
    def brightest(self) -> float:
        """Field that a ray may have at most, by what it is launched with."""
        return 1 / float(self.options["rays"])

    def index(self, wavenumber: float) -> float:
        """Return the refractive index around the objective at a wavenumber, 1/µm."""
        return self.scene.objective.material.index(wavenumber).real

    def at(self, wavenumber: float, only: NDArray[np.int64] | None = None) -> Returned:
        """Trace the spiral, or only the rays of some numbers, at a wavenumber, 1/µm."""
        optics = self.optics
        detector = optics.detector_at(self.scene, wavenumber)
        beam = self._beam(detector, wavenumber, only)
        focus = optics.focus_at(self.focus, wavenumber)
        found = arrivals(
            self.scene, beam, detector, focus, optics.max_intersections,
            self.options["min_amplitude"], wavenumber, self._tree, self._within(detector),
        )  # fmt: skip
        return self._past_objective(found, beam, detector, wavenumber)

    def shares(self, nodes: int) -> list[NDArray[np.int64] | None]:
        """Return the numbers of rays that are traced one share after the other; None is all.

        Parameters
        ----------
        nodes : int
            Wavenumbers at which what comes back is held together.
        """
        optics, rays = self.optics, self.options["rays"]
        carried = self.parts + (len(self.scene.regions) if self.lengths else 0)
        families = 2 if optics.effects.waist else 1
        most = rays_at_once(
            self.scene, optics.max_intersections, self.options["min_amplitude"],
            families * nodes * (FIRST_FIELD + carried),
        )  # fmt: skip
        if rays <= most:
            return [None]
        detector = optics.detector
        every = vogel_beam(rays, detector.objective_radius, detector.focus_distance).number
        return list(np.array_split(every, int(np.ceil(rays / most))))

    @property
    def _tree(self) -> Callable[..., tuple[object, ...]]:
        carry = FIELD if self.optics.effects.vectorial else AMPLITUDE
        if self.lengths:
            carry = with_lengths(carry, len(self.scene.regions))
        return make_tree(carry)

    def _within(self, detector: Detector) -> Acceptance:
        """Return where rays are accepted: everywhere, if that is known only past the objective."""
        effects = self.optics.effects
        if self.optics.way_varies or (effects.aberration and effects.turned):
            return _EVERYWHERE
        reach = effects.falloff.reach(self.optics.band[0]) * detector.radius
        return Acceptance(detector.objective_radius, reach)

    def _beam(
        self, detector: Detector, wavenumber: float, only: NDArray[np.int64] | None
    ) -> Beam | DisplacedBeam:
        optics, effects, rays = self.optics, self.optics.effects, self.options["rays"]
        launched = None if only is None else np.unique(only % rays)
        beam = vogel_beam(rays, detector.objective_radius, detector.focus_distance, launched)
        if not effects.displaces:
            return beam
        none = np.zeros(beam.vx.size)
        displaced = DisplacedBeam(*beam, none, none, none)
        if effects.waist:
            reach = effects.waist.rayleigh_range(
                self.scene.objective.material, optics.numerical_aperture, wavenumber
            )
            x, y = rulings(beam.vx, beam.vy, beam.vz, reach)
            both = DisplacedBeam._make(np.concatenate((one, one)) for one in displaced)
            second = np.repeat([0, rays], beam.vx.size)
            displaced = both._replace(
                amplitude=both.amplitude / 2, number=both.number + second,
                x=np.concatenate((x, -x)), y=np.concatenate((y, -y)),
            )  # fmt: skip
        if effects.aberration and effects.turned:
            over = -self.index(wavenumber) / optics.numerical_aperture
            x, y, path = _turned(optics, over * displaced.vx, over * displaced.vy)
            displaced = displaced._replace(
                x=displaced.x + x, y=displaced.y + y,
                optical_path_length=displaced.optical_path_length + path,
            )  # fmt: skip
        return displaced

    def _past_objective(
        self, found: Arrivals, beam: Beam | DisplacedBeam, detector: Detector, wavenumber: float
    ) -> Returned:
        optics, effects = self.optics, self.optics.effects
        over = self.index(wavenumber) / optics.numerical_aperture
        vx, vy = beam.vx[found.ray], beam.vy[found.ray]
        through = passed(optics, self.index(wavenumber), (vx, vy), (found.vx, found.vy))
        x, y, length = found.x, found.y, found.optical_path_length + through.path
        if effects.aberration and effects.turned:
            to_fibre = detector.magnification, detector.focal_length
            across, along, path = _turned(optics, over * found.vx, over * found.vy)
            length = length + path - lens_correction(x * x + y * y, *to_fibre)
            x, y = x - across, y - along
            length += lens_correction(x * x + y * y, *to_fibre)
        far = detector.focus_distance / np.sqrt(1 - found.vx**2 - found.vy**2)
        rim = np.hypot(x + far * found.vx, y + far * found.vy)
        amplitude = beam.amplitude[found.ray] * through.factor
        regions = len(self.scene.regions) if self.lengths else 0
        carried = found.carried[: len(found.carried) - regions]
        if effects.vectorial:
            fields = detected_fields(optics.polarisation, jones_of(carried, found.vx, found.vy))
            carried = np.concatenate((fields.real, fields.imag))
        ways = found.carried[len(found.carried) - regions :]
        if regions:
            ways = ways.copy()
            ways[0] += through.in_glass
        numbers = (
            x, y, (rim / detector.objective_radius) ** 2, length, over * np.hypot(vx, vy),
            *(amplitude * carried), *ways,
        )  # fmt: skip
        return Returned(
            beam.number[found.ray], found.path, np.stack(numbers), found.segments, found.outcomes
        )


def _turned(
    optics: Optics, px: NDArray[np.float64], py: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return where rays normal to an aberrated wavefront cross the focal plane, and their path.

    Parameters
    ----------
    optics : Optics
        Whose objective has an aberration W(p).
    px, py : ndarray, shape (D,)
        Their points of the pupil, in units of its radius.
    """
    aberration = optics.effects.aberration
    assert aberration is not None
    across, along = aberration.slopes(px, py)
    return displacement(
        aberration.wavefront(px, py), across, along, px, py, optics.numerical_aperture
    )


def weights(
    optics: Optics, numbers: NDArray[np.float64], wavenumber: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the factors that the pupil and the detector put on rays that come back, (K, D).

    Parameters
    ----------
    optics : Optics
    numbers : ndarray, shape (Q, K, D)
        Of the rays at each wavenumber, as `Returned` has them.
    wavenumber : ndarray, shape (K,)
        1/µm.
    """
    falloff, aperture = optics.effects.falloff, optics.numerical_aperture
    x, y, rim, _, sine = numbers[:FIRST_FIELD]
    squared = (x * x + y * y) / optics.detector.radius**2
    accepted = (squared < falloff.reach(optics.band[0]) ** 2) & (rim <= RIM**2)
    if falloff.dispersive:
        rows = zip(squared, wavenumber.tolist(), strict=True)
        collected = np.stack([falloff.amplitude(row, k) for row, k in rows])
    else:
        collected = falloff.amplitude(squared, float(wavenumber[0]))
    pupil = optics.pupil.amplitude(sine * aperture, aperture, wavenumber[:, np.newaxis])
    return np.where(accepted, collected * pupil, 0.0)
