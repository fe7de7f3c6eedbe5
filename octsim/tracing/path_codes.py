"""How a tree numbers its light paths, by the kind of scene when code is compiled.

Of the thesis's scene, and of plates, a code has a digit for each meeting, as
`octsim.tracing.light_paths` says, and grows on the way. Paths of a general scene would not fit:
they are counted, and their numbers found when light arrives, from the steps that it has made. A
step is twice the face, plus one if the light goes through.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba.extending import overload, register_jitable
from numpy.typing import NDArray

from octsim.tracing.faces import AnyFaces, Faces, PlainFaces

Steps = NDArray[np.int64]


@register_jitable(forceinline=True)
def _digits(faces: Faces, code: int, f: int) -> int:
    return int(code * faces.kind.size + 2 * faces.surface[f])


@register_jitable(forceinline=True)
def _step(faces: AnyFaces, code: int, f: int) -> int:
    return 2 * f if faces.counts.shape[0] > 0 else _digits(faces, code, f)


def code_behind(faces: Faces, code: int, f: int) -> int:
    """Return what a block of light that a face reflects is labelled with; one more beyond it."""
    return _step(faces, code, f) if isinstance(faces, AnyFaces) else _digits(faces, code, f)


@overload(code_behind, strict=False, jit_options={"forceinline": True})
def _compile_behind(faces: Any, code: Any, f: Any) -> Callable[..., int]:  # noqa: ARG001
    return _step if faces.instance_class is AnyFaces else _digits


@register_jitable(forceinline=True)
def _no_note(faces: PlainFaces, steps: Steps, meetings: int, code: int) -> None:
    pass


@register_jitable(forceinline=True)
def _note(faces: AnyFaces, steps: Steps, meetings: int, code: int) -> None:  # noqa: ARG001
    if meetings > 0:
        steps[meetings - 1] = code


def note_step(faces: Faces, steps: Steps, meetings: int, code: int) -> None:
    """Note the last step of a block that is traced next, after those before it on its way."""
    if isinstance(faces, AnyFaces):
        _note(faces, steps, meetings, code)


@overload(note_step, strict=False, jit_options={"forceinline": True})
def _compile_note(
    faces: Any, steps: Any, meetings: Any, code: Any  # noqa: ARG001
) -> Callable[..., None]:  # fmt: skip
    return _note if faces.instance_class is AnyFaces else _no_note


@register_jitable(forceinline=True)
def _code_itself(faces: PlainFaces, steps: Steps, meetings: int, code: int) -> int:  # noqa: ARG001
    return code


@register_jitable
def _counted(faces: AnyFaces, steps: Steps, meetings: int, code: int) -> int:
    if faces.counts.shape[0] == 0:
        return code
    number, departure = faces.numbers[meetings], 0
    for m in range(meetings):
        left, taken = meetings - 1 - m, steps[m]
        for choice in range(faces.first[departure], faces.first[departure + 1]):
            f = faces.next_face[choice]
            if taken == 2 * f:
                break
            number += faces.counts[left, faces.after_reflection[f]]
            if taken == 2 * f + 1:
                break
            number += faces.counts[left, faces.after_transmission[f]]
        after = faces.after_transmission if taken % 2 == 1 else faces.after_reflection
        departure = after[taken // 2]
    return int(number)


def path_code(faces: Faces, steps: Steps, meetings: int, code: int) -> int:
    """Return the code of the path of a block that arrives, by its steps or its label."""
    if isinstance(faces, AnyFaces):
        return _counted(faces, steps, meetings, code)
    return code


@overload(path_code, strict=False, jit_options={"forceinline": True})
def _compile_path_code(
    faces: Any, steps: Any, meetings: Any, code: Any  # noqa: ARG001
) -> Callable[..., int]:  # fmt: skip
    return _counted if faces.instance_class is AnyFaces else _code_itself


def steps_of_code(faces: AnyFaces, code: int) -> list[int]:
    """Return the steps of a path that was counted."""
    meetings = int(np.searchsorted(faces.numbers, code, side="right")) - 1
    rest, departure, steps = code - int(faces.numbers[meetings]), 0, []
    for left in range(meetings - 1, -1, -1):
        departure, rest, step = _next_step(faces, departure, rest, left)
        steps.append(step)
    return steps


def _next_step(faces: AnyFaces, departure: int, rest: int, left: int) -> tuple[int, int, int]:
    for f in faces.next_face[faces.first[departure] : faces.first[departure + 1]].tolist():
        for through, after in enumerate((faces.after_reflection[f], faces.after_transmission[f])):
            there = int(faces.counts[left, after])
            if rest < there:
                return int(after), rest, 2 * f + through
            rest -= there
    raise ValueError("a path's code is beyond those of its scene")
