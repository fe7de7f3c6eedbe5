"""The aberration of a slide whose index is another than that of the objective's immersion."""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    # numpy is imported where it is used, as most configs have no immersion of its own
    import numpy as np
    from numpy.typing import NDArray

_DEGREES = (2, 4, 6, 8, 10)
_NODES = 128


class SlideAberration(NamedTuple):
    """What a slide adds to the wavefront that passes it once, refocused."""

    terms: tuple[tuple[int, float], ...]
    """Noll's number of each Zernike polynomial about the axis, and its rms over the pupil, µm."""
    rms: float
    """Of all of it over the pupil, µm."""
    remainder: float
    """Rms of what the terms leave out, µm."""
    focus: float
    """How much farther up the slide moves the focus, in a medium of its own index, µm."""


def slide_aberration(
    numerical_aperture: float, immersion: float, slide: float, thickness: float
) -> SlideAberration:
    r"""Return the aberration of a slide of another index than the immersion before it.

    .. math:: W(s) = t \left(\sqrt{n_s^2 - s^2} - \sqrt{n_i^2 - s^2}\right)
        - a - b \sqrt{n_s^2 - s^2}

    with s = n sin θ up to the numerical aperture (Török, Varga, Laczik and Booker, J. Opt. Soc. Am.
    A 12, 325 (1995)), in Zernike polynomials about the axis as Booth, Neil and Wilson have it
    (J. Microsc. 192, 90 (1998)). A piston a and a focus that is moved by b are such that the least
    rms over the pupil is left.

    Parameters
    ----------
    numerical_aperture : float
        Below both indices.
    immersion, slide : float
        Refractive indices n_i and n_s.
    thickness : float
        Of the slide t, µm.

    Examples
    --------
    >>> slide_aberration(1.2, immersion=1.515, slide=1.52, thickness=170.0).rms  # µm
    0.018902372278212...
    """
    import numpy as np

    x, weight = np.polynomial.legendre.leggauss(_NODES)
    weight = weight / 2
    s2 = numerical_aperture**2 * (1 + x) / 2  # even steps of it are even areas of the pupil

    def varying(values: NDArray[np.float64]) -> NDArray[np.float64]:
        level: NDArray[np.float64] = values - weight @ values
        return level

    within = np.sqrt(slide**2 - s2)
    added, refocused = varying(thickness * (within - np.sqrt(immersion**2 - s2))), varying(within)
    way = float(weight @ (added * refocused)) / float(weight @ refocused**2)
    left = added - way * refocused
    legendre = np.polynomial.legendre.legvander(x, max(_DEGREES) // 2)
    terms = tuple(
        # Z(n, 0) is √(n + 1) times Legendre's polynomial of half its degree, in 2 ρ² - 1
        (n * (n + 1) // 2 + 1, float(sqrt(n + 1) * (weight * left) @ legendre[:, n // 2]))
        for n in _DEGREES
    )
    whole = float(weight @ left**2)
    remainder = max(0.0, whole - sum(rms**2 for _, rms in terms))
    return SlideAberration(terms, sqrt(whole), sqrt(remainder), -way)
