"""What becomes of an amplitude, or of a field, at a surface and at the lens (for literal_effects).

The three directions (R, 3) are of the incident, the reflected and the transmitted ray; normals
(R, 3) are on the incident side; the cosines (R,) are cos_i and a complex cos_t; the indices (R,)
are n_i and n_t.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Three = tuple[Array, Array, Array]
Two = tuple[Array, Array]


def fresnel(cosines: Two, indices: Two) -> tuple[Array, Array, Array, Array]:
    """Return Hecht's r_s, r_p, t_s, t_p (R,), complex where cos_t is: r_p = -r_s at cos_i = 1."""
    cos_i, cos_t = cosines
    n_i, n_t = indices
    r_s = (n_i * cos_i - n_t * cos_t) / (n_i * cos_i + n_t * cos_t)
    r_p = (n_t * cos_i - n_i * cos_t) / (n_t * cos_i + n_i * cos_t)
    t_s = 2 * n_i * cos_i / (n_i * cos_i + n_t * cos_t)
    t_p = 2 * n_i * cos_i / (n_t * cos_i + n_i * cos_t)
    return r_s, r_p, t_s, t_p


def split_thesis(
    carried: Array, directions: Three, normal: Array, cosines: Two, indices: Two
) -> Two:
    """Split amplitudes (R,) by section 4.3.2; r = +1 and t = 0 beyond the critical angle."""
    del directions, normal
    n_i, n_t = indices
    through = cosines[1].imag == 0
    r_s, r_p, t_s, t_p = fresnel((cosines[0], cosines[1].real), indices)
    r = np.sqrt((r_s**2 + r_p**2) / 2)
    r = np.where(n_t > n_i, -r, r)
    t = np.sqrt((t_s**2 + t_p**2) / 2)
    return carried * np.where(through, r, 1.0), carried * np.where(through, t, 0.0)


def split_polarised(
    carried: Array, directions: Three, normal: Array, cosines: Two, indices: Two
) -> Two:
    """Split fields (R, 3, 2) along s = v x n, and p = v x s of each ray's own v."""
    r_s, r_p, t_s, t_p = fresnel(cosines, indices)
    s = crosswise(directions[0], normal)
    p_i, p_r, p_t = (np.cross(v, s) for v in directions)
    of_s = np.einsum("ri,rij->rj", s, carried)
    of_p = np.einsum("ri,rij->rj", p_i, carried)

    def field(along_s: Array, p: Array, along_p: Array) -> Array:
        of_both: Array = (
            s[:, :, np.newaxis] * (along_s[:, np.newaxis] * of_s)[:, np.newaxis, :]
            + p[:, :, np.newaxis] * (along_p[:, np.newaxis] * of_p)[:, np.newaxis, :]
        )
        return of_both

    return field(r_s, p_r, r_p), field(t_s, p_t, t_p)


def crosswise(v: Array, normal: Array) -> Array:
    """Return the unit vectors s along v x n, square to v to rounding; any at normal incidence."""
    s = np.cross(v, normal)
    none = np.linalg.norm(s, axis=1) < 1e-12
    other = np.where(np.abs(v[:, 1:2]) < 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    s[none] = np.cross(v[none], other[none])
    for _ in range(2):
        s /= np.linalg.norm(s, axis=1, keepdims=True)
        s -= np.sum(s * v, axis=1, keepdims=True) * v
    s /= np.linalg.norm(s, axis=1, keepdims=True)
    return s


def least_rotation(a: Array, b: Array) -> Array:
    """Return the rotations (R, 3, 3) about a x b that turn a into b; a = -b never comes."""
    w = np.cross(a, b)
    cosine = np.sum(a * b, axis=1)[:, np.newaxis, np.newaxis]
    turn = np.zeros((len(w), 3, 3))
    turn[:, 0, 1], turn[:, 0, 2], turn[:, 1, 2] = -w[:, 2], w[:, 1], -w[:, 0]
    turn -= np.swapaxes(turn, 1, 2)
    rotation: Array = np.eye(3) + turn + turn @ turn / (1 + cosine)
    return rotation


def enter_lens(v: Array) -> Array:
    """Return the fields (R, 3, 2) of rays along v that came in collimated, as x and as y."""
    return least_rotation(np.broadcast_to([0.0, 0.0, 1.0], v.shape), v)[:, :, :2]


def leave_lens(v: Array, carried: Array) -> Array:
    """Return the Jones matrices (R, 2, 2) of fields once the lens has turned v into -z."""
    rotation = least_rotation(v, np.broadcast_to([0.0, 0.0, -1.0], v.shape))
    turned: Array = (rotation @ carried)[:, :2, :]
    return turned
