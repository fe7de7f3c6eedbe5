"""What the error of a light path may be, and how far its integration has come."""

from typing import NamedTuple

from numba.extending import register_jitable

SPARE = 2.5
"""What may be left out of all paths, over the error that one path may have."""


class PathGoal(NamedTuple):
    """A light path to be integrated, and what its error may be."""

    code: int
    relative: float
    """Error over the field."""
    scale: float
    """Field of all paths, as far as it is known."""
    left_out: float
    """Field left out already, of other paths."""
    extrapolation: float
    """How far quantities may go on past known corners; see `patch_by_corners`."""
    orders: tuple[int, int]
    """Numbers of nodes along s and v to begin with."""
    budget: int
    """Segments that may be traced."""


class Progress(NamedTuple):
    """What has become of a path so far."""

    nodes: int
    """Nodes kept, of all paths."""
    size: float
    """Sum of the tiles' fields, as magnitudes."""
    filled: float
    """Integral of the falloff over the patch."""
    error: float
    """Sum of the tiles' error estimates."""
    missing: float
    """Field that was left out."""
    segments: int
    """Traced."""


@register_jitable(forceinline=True)
def spare(goal: PathGoal, progress: Progress) -> float:
    """Return what may still be left out."""
    may = SPARE * goal.relative * max(goal.scale, progress.size)
    return max(may - goal.left_out - progress.missing, 0.0)


@register_jitable(forceinline=True)
def left_out(progress: Progress, field: float) -> Progress:
    """Return the progress after some more of the field is left out."""
    return Progress(
        progress.nodes, progress.size, progress.filled, progress.error, progress.missing + field,
        progress.segments,
    )  # fmt: skip


@register_jitable(forceinline=True)
def traced(progress: Progress, segments: int) -> Progress:
    """Return the progress after some more segments."""
    return Progress(
        progress.nodes, progress.size, progress.filled, progress.error, progress.missing,
        progress.segments + segments,
    )  # fmt: skip
