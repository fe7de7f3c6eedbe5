"""What a spectrometer's pixels have of a spectrum: its mean over the width of each."""

from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import make_interp_spline

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
_DEGREE = 5


def pixel_means(intensity: "Array", wavenumber: "Array", width: "Array") -> "Array":
    r"""Return the mean of a spectrum over pixels,

    .. math:: \frac{1}{w} \int_{k - w/2}^{k + w/2} I(k') \, dk',

    by a spline of the fifth degree. A fringe of optical depth z rolls off by sin(zw) / (zw).

    Parameters
    ----------
    intensity, wavenumber : ndarray, shape (K,)
        The spectrum, over increasing wavenumbers, 1/µm.
    width : ndarray, shape (K,)
        Width w of a pixel at each, 1/µm.
    """  # noqa: D400
    whole = make_interp_spline(wavenumber, intensity, k=_DEGREE).antiderivative()
    found: Array = (whole(wavenumber + width / 2) - whole(wavenumber - width / 2)) / width
    return found
