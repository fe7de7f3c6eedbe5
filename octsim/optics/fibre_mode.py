"""The fundamental mode LP01 of a fibre whose index has a step (weakly guiding)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import exp, log, log1p, sqrt

import numpy as np
from numpy.typing import NDArray

FAINTEST_GUIDING = 0.1
"""Least V: there the mode is 10⁸⁶ times as wide as the core, and so it is no fibre's."""
MARCUSE = (0.8, 2.5)
"""Least and largest V of Marcuse's formula."""


@dataclass(frozen=True)
class LP01:
    r"""The mode's field against the distance u from the axis, over the core's radius.

    .. math:: E(u) = \begin{cases} J_0(U u) & u \le 1 \\
        J_0(U) K_0(W u) / K_0(W) & u > 1 \end{cases}

    (Gloge, Appl. Opt. 10, 2252 (1971)), 1 on the axis.
    """

    radius: float
    """Of the core, µm."""
    v: float
    """V = k a NA, the normalised frequency."""
    u: float
    """U, the transverse wavenumber in the core times its radius."""
    w: float
    """W, the decay constant in the cladding times the core's radius; U² + W² = V²."""

    def amplitude(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the field at distances from the axis, over the core's radius, of any shape."""
        from scipy.special import j0, k0e  # here, as it takes long to import

        inside, outside = np.minimum(u, 1), np.maximum(u, 1)
        # both factors are 1 where they do not apply; scaled K₀, which would underflow by itself
        decay = k0e(self.w * outside) / k0e(self.w) * np.exp(-self.w * (outside - 1))
        amplitude: NDArray[np.float64] = j0(self.u * inside) * decay
        return amplitude

    def reach(self, level: float) -> float:
        """Return the distance, over the core's radius, beyond which the field is below a level.

        Parameters
        ----------
        level : float
            Of the field on the axis, positive and below what the field is at the core's edge.
        """
        from scipy.optimize import brentq
        from scipy.special import j0, k0e

        edge = log(j0(self.u)) - log(level)
        if edge < 0:
            raise ValueError(f"the mode is down to {level} inside its core")

        def excess(u: float) -> float:
            decay: float = log(k0e(self.w * u) / k0e(self.w))
            return edge + decay - self.w * (u - 1)

        # the exponential alone has brought it down at the other end
        found: float = brentq(excess, 1, 1 + edge / self.w, rtol=1e-14)
        return found

    @property
    def mode_field_diameter(self) -> float:
        r"""Diameter at 1/e² of intensity of the Gaussian that couples best to the mode, µm.

        .. math:: 2 a (0.65 + 1.619 / V^{3/2} + 2.879 / V^6)

        (Marcuse, Bell Syst. Tech. J. 56, 703 (1977)), for V from 0.8 to 2.5. It is within 1 % from
        V = 1 on, and 13 % too small at 0.8.
        """
        least, most = MARCUSE
        if not least <= self.v <= most:
            raise ValueError(f"Marcuse's formula is for V from {least} to {most}, not {self.v:.3g}")
        return 2 * self.radius * (0.65 + 1.619 / (self.v * sqrt(self.v)) + 2.879 / self.v**6)


@lru_cache(maxsize=4096)  # a mode at each wavenumber of a band serves all points
def lp01(radius: float, numerical_aperture: float, wavenumber: float) -> LP01:
    r"""Return the fundamental mode of a step-index fibre.

    .. math:: U \frac{J_1(U)}{J_0(U)} = W \frac{K_1(W)}{K_0(W)}, \quad
        U^2 + W^2 = V^2 = (k a \cdot NA)^2

    (Gloge, Appl. Opt. 10, 2252 (1971)), with U below the first zero of J₀.

    Parameters
    ----------
    radius : float
        Of the core, a, µm.
    numerical_aperture : float
        Of the fibre, NA.
    wavenumber : float
        In vacuum, k, 1/µm.
    """
    from scipy.optimize import brentq
    from scipy.special import j0, j1, jn_zeros, k0e, k1e

    v = wavenumber * radius * numerical_aperture
    if not v >= FAINTEST_GUIDING:
        raise ValueError(f"a fibre of V = {v:.3g} hardly guides; V is at least {FAINTEST_GUIDING}")

    # log(W / U) gives both to all digits, however weak (W tiny) or strong (U / V tiny) the guiding
    def split(log_ratio: float) -> tuple[float, float]:
        return v * exp(-log1p(exp(2 * log_ratio)) / 2), v * exp(-log1p(exp(-2 * log_ratio)) / 2)

    def mismatch(log_ratio: float) -> float:  # multiplied out: it has no poles
        u, w = split(log_ratio)
        difference: float = u * j1(u) * k0e(w) - w * k1e(w) * j0(u)
        return difference

    zero = float(jn_zeros(0, 1)[0])
    least = -200.0 if v <= zero else log(sqrt((v - zero) * (v + zero)) / zero)
    u, w = split(brentq(mismatch, least, 200.0, xtol=1e-15, maxiter=1000))
    return LP01(radius, v, u, w)
