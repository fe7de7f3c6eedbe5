"""The light of a reference arm, added to what a scheme detects of a scene."""

import numpy as np
from numpy.typing import NDArray

from octsim.optics.effects import ReferenceArm
from octsim.schemes.light import Field


def with_reference(
    field: Field,
    arm: ReferenceArm | None,
    wavenumber: NDArray[np.float64],
    share: NDArray[np.complex128] | float = 1.0,
) -> Field:
    r"""Return a field with the light of a reference arm, if there is one.

    .. math:: E(k) + a\, e^{2 i k L}

    (thesis eq. (1), with L one way from the focus).

    Parameters
    ----------
    field : Field
        Of a scene.
    arm : ReferenceArm or None
    wavenumber : ndarray, shape (K,)
        Those of the field, 1/µm.
    share : ndarray, shape (C,)
        What each of the field's parts has of light whose polarisation has not changed.
    """
    if arm is None:
        return field
    mirrored = arm.amplitude * np.exp(2j * wavenumber * arm.length)
    return field._replace(values=field.values + np.multiply.outer(share, mirrored))
