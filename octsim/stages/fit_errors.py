"""Whether the standard errors of a fit over the focus are known, and why not."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray


class StandardErrorStatus(IntEnum):
    """Whether the standard errors of a Gaussian fit are known."""

    KNOWN = 0
    NOT_FITTED = 1
    """There is no fit; its own status says why."""
    TOO_FEW = 2
    """The foci do not tell: none is left over, or one alone is on the peak."""


def error_status(errors: NDArray[np.float64], *, fitted: bool) -> StandardErrorStatus:
    """Return whether the standard errors of a fit are known, NaN where they are not."""
    if not fitted:
        return StandardErrorStatus.NOT_FITTED
    known = bool(np.isfinite(errors).all())
    return StandardErrorStatus.KNOWN if known else StandardErrorStatus.TOO_FEW
