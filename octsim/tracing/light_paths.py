"""Light paths: which surfaces light meets, in order, and whether it is reflected at each.

A path's code is a number whose digits, in base 2 S for S surfaces, are its meetings: twice the
surface's number, plus one if the light goes through. A leading 1 keeps the zeros. Those of general
scenes are counted instead (`octsim.tracing.path_codes`).
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numba.extending import overload, register_jitable
from numpy.typing import NDArray

from octsim.optics.scene import Scene
from octsim.tracing.faces import AnyFaces, Faces, faces_at
from octsim.tracing.path_codes import steps_of_code
from octsim.tracing.path_counts import MOST_MEETINGS

LONGEST = MOST_MEETINGS
"""Most meetings of a path that has a code."""


def first_rays(path: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the first ray of each light path, (P,), of rays with codes (N,), sorted by them."""
    return np.flatnonzero(np.diff(path, prepend=-1))


def path_name(code: int, surfaces: Sequence[str]) -> str:
    """Return the name of a light path: its surfaces in order, R reflected or T transmitted at each.

    Parameters
    ----------
    code : int
        Of the path.
    surfaces : sequence of str
        Names of the scene's surfaces, in its order.

    Examples
    --------
    >>> path_name(0b1_01_11, ("P", "C"))
    'PT CT'
    """
    meetings = []
    while code > 1:
        code, digit = divmod(code, 2 * len(surfaces))
        meetings.append(surfaces[digit // 2] + "RT"[digit % 2])
    return " ".join(reversed(meetings))


def names_of_paths(scene: Scene, wavenumber: float, codes: Iterable[int]) -> list[str]:
    """Return the names of the light paths of some codes in a scene, as ``glass T axon R glass T``.

    The scene's topology has them; the wavenumber is any that its materials are known at, 1/µm.
    """
    faces, names = faces_at(scene, wavenumber), scene.surface_names
    if not isinstance(faces, AnyFaces) or not len(faces.counts):
        return [path_name(code, names) for code in codes]
    said = [name if len(name) == 1 else f"{name} " for name in names]
    return [
        " ".join(said[step // 4] + "RT"[step % 2] for step in steps_of_code(faces, code))
        for code in codes
    ]


@register_jitable
def _by_digits(faces: Faces, code: int, face: NDArray[np.int64], through: NDArray[np.bool_]) -> int:
    base, num = faces.kind.size, 0
    rest = code
    while rest > 1:
        rest //= base
        num += 1
    departure = 0
    for m in range(num):
        digit = (code // base ** (num - 1 - m)) % base
        for choice in range(faces.first[departure], faces.first[departure + 1]):
            if faces.surface[faces.next_face[choice]] == digit // 2:
                face[m] = faces.next_face[choice]
        through[m] = digit % 2 == 1
        after = faces.after_transmission if through[m] else faces.after_reflection
        departure = after[face[m]]
    return num


@register_jitable
def _by_count(
    faces: AnyFaces, code: int, face: NDArray[np.int64], through: NDArray[np.bool_]
) -> int:
    if faces.counts.shape[0] == 0:
        return _by_digits(faces, code, face, through)
    num = 0
    while num + 1 < faces.numbers.size and faces.numbers[num + 1] <= code:
        num += 1
    rest, departure = code - faces.numbers[num], 0
    for m in range(num):
        here = departure
        for choice in range(faces.first[here], faces.first[here + 1]):
            f = faces.next_face[choice]
            back, beyond = faces.after_reflection[f], faces.after_transmission[f]
            reflected, transmitted = (
                faces.counts[num - 1 - m, back],
                faces.counts[num - 1 - m, beyond],
            )
            if rest < reflected + transmitted:
                face[m], through[m] = f, rest >= reflected
                rest -= reflected if through[m] else 0
                departure = beyond if through[m] else back
                break
            rest -= reflected + transmitted
    return num


def steps_of(faces: Faces, code: int, face: NDArray[np.int64], through: NDArray[np.bool_]) -> int:
    """Read a path's code into the faces that it meets, and how it leaves each; return how many.

    `face` and `through` have room for `LONGEST` meetings.
    """
    by = _by_count if isinstance(faces, AnyFaces) else _by_digits
    return by(faces, code, face, through)  # type: ignore[arg-type]


@overload(steps_of, strict=False)
def _compile_steps(
    faces: Any, code: Any, face: Any, through: Any  # noqa: ARG001
) -> Callable[..., int]:  # fmt: skip
    return _by_count if faces.instance_class is AnyFaces else _by_digits
