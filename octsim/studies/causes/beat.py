"""What beats in a spectrum: the field from the cylinder's near side with that from its far side."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import OctsimError
from octsim.base.threads import each
from octsim.instrument.instrument import Instrument
from octsim.schemes.field_sum import field
from octsim.schemes.light import Light
from octsim.studies.sides import GLASS, SIDES, rays_on

NEAR = (GLASS, SIDES["near"])
"""Light paths off the glass and the near side, a gap apart."""


class Fields(NamedTuple):
    """Fields of D spectra at K wavenumbers, by where the light comes from; their sum is whole."""

    near: NDArray[np.complex128]
    """Off the glass and the near side, (D, K)."""
    far: NDArray[np.complex128]
    """Off the far side, (D, K)."""
    other: NDArray[np.complex128]
    """All else: light reflected more than once, (D, K)."""


class Parts(NamedTuple):
    r"""Intensity of D spectra at K wavenumbers in parts.

    .. math:: I = \mathrm{Re}(2 E_n^* E_f) + (|E_n|^2 + |E_f|^2) + \text{rest}
    """

    beat: NDArray[np.complex128]
    """2 E_n* E_f: its real part oscillates as cos(2ndk), (D, K)."""
    still: NDArray[np.float64]
    """What of near and far side does not oscillate: a level and a slow envelope, (D, K)."""
    rest: NDArray[np.float64]
    """What all other light adds, (D, K)."""

    def intensity(self) -> NDArray[np.float64]:
        """Return the parts together, (D, K)."""
        whole: NDArray[np.float64] = self.beat.real + self.still + self.rest
        return whole

    def take(self, rows: NDArray[np.int64]) -> "Parts":
        """Return some of the spectra."""
        return Parts(self.beat[rows], self.still[rows], self.rest[rows])


def parts(fields: Fields) -> Parts:
    """Return the parts of the intensity that fields multiply out to."""
    near, far, other = fields
    beat = 2 * near.conj() * far
    still = np.abs(near) ** 2 + np.abs(far) ** 2
    both = near + far
    rest = np.abs(other) ** 2 + 2 * (both.conj() * other).real
    return Parts(beat, still, rest)


def _summed(light: Light, wavenumber: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Return the fields of near side, far side and all else, (3, K), of a light's rays."""
    near = rays_on(light, NEAR.__contains__)
    far = rays_on(light, SIDES["far"].__eq__)
    return np.stack(
        [
            field(light.amplitude[rays], light.optical_path_length[rays], wavenumber)
            for rays in (near, far, ~(near | far))
        ]
    )


def fields_at(
    instrument: Instrument,
    diameters: NDArray[np.float64],
    foci: NDArray[np.float64],
    threads: int = 1,
) -> Fields:
    """Return what comes from near side, far side and elsewhere, seen by an instrument.

    Parameters
    ----------
    instrument : Instrument
    diameters, foci : ndarray, shape (D,)
        Diameters, and a focus for each, µm.
    threads : int
        Points traced at once.

    Raises
    ------
    OctsimError
        If no light comes back from one of the sides: nothing beats then.
    """

    def at(place: tuple[float, float]) -> NDArray[np.complex128]:
        return _summed(instrument.rays(*place), instrument.wavenumber)

    places = zip(diameters.tolist(), foci.tolist(), strict=True)
    fields = Fields(*np.stack(list(each(at, places, threads)), axis=1))
    for side in ("near", "far"):
        dark = ~getattr(fields, side).any(axis=1)
        if dark.any():
            raise OctsimError(
                f"sweep: at a diameter of {diameters[dark][0]:.6g} um no light comes back from the "
                f"cylinder's {side} side, so that no beat has a phase; change sweep.diameters, "
                "sweep.focus, tracing.max_intersections or scene.refractive_index"
            )
    return fields
