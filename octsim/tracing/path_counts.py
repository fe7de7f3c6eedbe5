"""How many light paths there are of each number of meetings: what numbers them without gaps.

A path's code is the number of shorter paths that reach the objective, plus that of those of its own
length before it, in the order of the faces that can come next, reflected light first.
"""

import numpy as np
from numpy.typing import NDArray

MOST_PATHS = 2**62
"""Paths that a code has room for."""
MOST_MEETINGS = 100
"""Of the longest path that is counted."""

Numbers = NDArray[np.int64]


def path_counts(
    first: Numbers,
    next_face: Numbers,
    after_reflection: Numbers,
    after_transmission: Numbers,
    to_objective: NDArray[np.bool_],
) -> Numbers:
    """Return the number of paths of each length from each departure to the objective, (L, D).

    Row l has those of l more meetings, up to the longest of which all paths have a code.

    Parameters
    ----------
    first, next_face, after_reflection, after_transmission, to_objective
        As `octsim.tracing.faces.Faces` has them.
    """
    rows = [[int(there) for there in to_objective.tolist()]]
    total = 0
    while len(rows) <= MOST_MEETINGS:
        last = rows[-1]
        row = [
            0 if to_objective[d] else sum(
                last[after_reflection[f]] + last[after_transmission[f]]
                for f in next_face[first[d] : first[d + 1]]
            )
            for d in range(len(last))
        ]  # fmt: skip
        total += row[0]
        if total >= MOST_PATHS or max(row) >= MOST_PATHS:
            break
        rows.append(row)
    return np.array(rows, np.int64)


def first_numbers(counts: Numbers) -> Numbers:
    """Return the code of the first path of each length, (L,), by the counts of paths."""
    return np.cumsum(np.concatenate(([0], counts[:-1, 0]))) if len(counts) else counts[:, 0]
