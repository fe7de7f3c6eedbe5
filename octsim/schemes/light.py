"""The light of one point, as rays whose fields add up or as a field, and how sure it is."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.optics.beam import aperture_radius
from octsim.optics.detector import Detector
from octsim.optics.effects import NO_EFFECTS, Effects
from octsim.optics.polarisation import Polarisation
from octsim.optics.pupil import Pupil, UniformPupil
from octsim.optics.scene import Scene


class AccuracyStatus(IntEnum):
    """Whether the accuracy that was asked for is reached."""

    REACHED = 0
    """By the estimate of the error."""
    BUDGET_SPENT = 1
    """Stopped at the most segments that are traced for one point, or at the most partial waves,
    nodes or wavenumbers that are solved for; NaN where it had to stop before it began."""
    NOT_REACHED = 2
    """The estimate of the error stays above what was asked for."""
    NOT_CONTROLLED = 3
    """The scheme has a number of rays, and no accuracy to reach."""
    AT_AN_EDGE = 4
    """Reached by the estimate, but part of the light misses a cylinder, and what returns from near
    its edge can be missing from both."""
    NO_FOCUS = 5
    """Not traced: the focus law, which the focus was to follow, could not be fitted."""

    @property
    def remedy(self) -> str:
        """What a user can do about it; empty where nothing is amiss."""
        return _REMEDIES[self]


_COMPARE = "compare with tracing.scheme vogel, or ask for less by tracing.accuracy"
_REMEDIES: Mapping[AccuracyStatus, str] = {
    AccuracyStatus.REACHED: "",
    AccuracyStatus.BUDGET_SPENT: _COMPARE,
    AccuracyStatus.NOT_REACHED: _COMPARE,
    AccuracyStatus.NOT_CONTROLLED: "raise tracing.rays, or give tracing.preset",
    AccuracyStatus.AT_AN_EDGE: _COMPARE,
    AccuracyStatus.NO_FOCUS: "give focus_law.fraction a wider range or more steps",
}


class Light(NamedTuple):
    """Weighted rays that reach the detector, D of them, always in the same order."""

    path: NDArray[np.int64]
    """Code of the light path, (D,); `octsim.tracing.light_paths.path_name` reads it."""
    amplitude: NDArray[np.float64]
    """Amplitude times weight, (D,)."""
    rough_amplitude: NDArray[np.float64]
    """The same by a rougher rule, (D,): the difference of their sums estimates the error."""
    optical_path_length: NDArray[np.float64]
    """Path from the focus to the fibre, (D,), µm."""
    missing: float
    """Estimate of the field of what was left out."""
    segments: int
    """Straight pieces of ray that were traced."""
    status: AccuracyStatus
    outcomes: NDArray[np.int64] | None = None
    """How often each `octsim.optics.detector.Outcome` came about, (7,), where rays are counted."""
    lengths: NDArray[np.float64] | None = None
    """Lengths of each ray's way in the scene's regions, (R, D), µm, where one attenuates: what that
    takes is not taken from the amplitudes yet."""


class Sampled(NamedTuple):
    """Rays that differ from wavenumber to wavenumber, or in polarisation, and their field."""

    rays: Light
    """Those at the middle of the band; of polarised light with the magnitudes of their fields."""
    wavenumber: NDArray[np.float64]
    """Samples of the band, (K,), 1/µm."""
    values: NDArray[np.complex128]
    """Complex fields whose intensities have the detected one as their mean, (C, K)."""
    error: float
    """Estimate of the error of the field, as a magnitude; the largest over the band."""

    def field_at(self, wavenumber: NDArray[np.float64]) -> "Field":
        """Return the field at some of the samples.

        Raises
        ------
        ValueError
            If another wavenumber is asked for.
        """
        place = np.searchsorted(self.wavenumber, wavenumber).clip(max=self.wavenumber.size - 1)
        if not np.array_equal(self.wavenumber[place], wavenumber):
            raise ValueError("the field is known at the samples of its spectrum, and nowhere else")
        return Field(self.values[:, place], self.error)

    @property
    def status(self) -> AccuracyStatus:
        """Whether the accuracy that was asked for is reached."""
        return self.rays.status

    @property
    def segments(self) -> int:
        """Straight pieces of ray that were traced."""
        return self.rays.segments


class Waves(NamedTuple):
    r"""The field that the detector collects, at N nodes over the band.

    It is smooth in k, as the phase :math:`e^{i k \Lambda_0}` of the far side's light is taken out:
    the Chebyshev series through the nodes gives it anywhere in the band.
    """

    wavenumber: NDArray[np.float64]
    """Chebyshev nodes of the first kind, increasing, (N,), 1/µm."""
    values: NDArray[np.complex128]
    """Field without that phase, (2, N): of light polarised across the cylinder, and along it; 1 is
    a perfect mirror in the focus."""
    terms: NDArray[np.complex128]
    """The parts of it in `TERMS`, (3, 2, N); what they leave is the rest."""
    optical_path_length: float
    """Λ₀, µm."""
    azimuth: float
    """Of the cylinder: angle from the y axis to its axis, rad."""
    error: float
    """Estimate of the error of the field, the largest over band and polarisations."""
    order: int
    """Largest order of the partial waves."""
    status: AccuracyStatus

    @property
    def segments(self) -> int:
        """Straight pieces of ray that were traced: none."""
        return 0


def attenuated(light: Light, scene: Scene, wavenumber: float) -> Light:
    """Return light without what the regions of its scene take of it, at a wavenumber, 1/µm."""
    if light.lengths is None:
        return light
    (left,) = scene.transmission(light.lengths[:, np.newaxis], np.array([wavenumber]))
    # what is missing goes as far as what is there
    return light._replace(
        amplitude=light.amplitude * left, rough_amplitude=light.rough_amplitude * left,
        missing=light.missing * float(left.max(initial=0.0)), lengths=None,
    )  # fmt: skip


TERMS = ("plane", "near_side", "far_side")
"""Parts of a `Waves` field: reflection off the plane, and off the cylinder's near side and far side
(the Debye series' p = 0 and p = 2)."""


class Field(NamedTuple):
    """The detected field over the wavenumbers, and how sure it is."""

    values: NDArray[np.complex128]
    """Complex fields whose intensities have the detected one as their mean, (C, K): of rays one,
    of unpolarised light two."""
    error: float
    """Estimate of its error, as a magnitude; the largest over the band."""


class Optics(NamedTuple):
    """What an instrument is made of besides its scene: the same for every scheme."""

    detector: Detector
    """Objective and fibre."""
    band: tuple[float, float]
    """Smallest and largest wavenumber, 1/µm."""
    max_intersections: int
    """Surfaces that one ray may meet."""
    numerical_aperture: float
    """Of the objective."""
    pupil: Pupil
    """What weighs the light over it."""
    polarisation: Polarisation
    """What goes in, and what is detected of it."""
    wavenumber: NDArray[np.float64]
    """Samples of the band, (K,), 1/µm."""
    effects: Effects = NO_EFFECTS
    """What else it does to rays."""
    dispersive: bool = False
    """Whether an index depends on the wavenumber."""
    azimuth: float = 0.0
    """Angle by which the axes that light is described in are turned from x to y, rad."""

    def turned(self, angle: float) -> "Optics":
        """Return the same, to be described in axes that are turned from x to y by an angle, rad."""
        effects = self.effects
        if angle == 0:
            return self
        if effects.aberration is not None:
            effects = replace(effects, aberration=effects.aberration.turned(angle))
        return self._replace(effects=effects, azimuth=angle)

    def detector_at(self, scene: Scene, wavenumber: float) -> Detector:
        """Return the receiver at a wavenumber, 1/µm: its angle follows the objective's index."""
        index = scene.objective.material.index(wavenumber).real
        radius = aperture_radius(self.numerical_aperture, index, self.detector.focus_distance)
        return self.detector._replace(objective_radius=radius)

    def focus_at(self, focus: float, wavenumber: float) -> float:
        """Return the height of the focus at a wavenumber (1/µm) for that at the reference, µm."""
        shift = self.effects.focal_shift
        return focus + shift.at(wavenumber) if shift else focus

    @property
    def way_varies(self) -> bool:
        """Whether a ray's way depends on the wavenumber."""
        return self.dispersive or self.effects.way_varies

    @property
    def varies(self) -> bool:
        """Whether a ray's way or weight depends on the wavenumber."""
        return self.way_varies or self.pupil.varies or self.effects.falloff.dispersive

    @property
    def scene_varies(self) -> bool:
        """Whether what light is sent through depends on the wavenumber: an index, or the focus."""
        return self.dispersive or self.effects.focal_shift is not None

    @property
    def sampled(self) -> bool:
        """Whether the light of rays is a field at samples, and no rays that serve all of them."""
        return self.varies or self.effects.vectorial

    @property
    def plain(self) -> bool:
        """Whether rays are the thesis's, with nothing added."""
        own = replace(self.effects, reference=None)  # is added to the sum of any rays
        return not self.dispersive and own == NO_EFFECTS and self.pupil == UniformPupil()


Options = Mapping[str, Any]
"""Values of a scheme's own keys of the config's section ``tracing``, by their names there."""
Found = Light | Sampled | Waves
"""The light of a point, in the form that its scheme has it."""
LightAt = Callable[[Scene, float], Found]
"""Returns the detected light of a scene, for a height of the focus, µm."""
