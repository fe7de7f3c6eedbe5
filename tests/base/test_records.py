"""Records hold what their classes say, the same for Python and for compiled code."""

from typing import Generic, TypeVar

import numba
import numpy as np
import pytest
from numpy.typing import NDArray

from octsim.base.records import layout, room


class Inner:
    """Of a record within another."""

    marks: NDArray[np.bool_]
    values: NDArray[np.float64]


class Outer:
    """Of a record with another."""

    counts: NDArray[np.int64]
    inner: Inner
    one: float


INNER = layout(Inner, marks=(3,), values=(2, 5))
OUTER = layout(Outer, counts=(7,), inner=INNER)


def fill(outer: Outer) -> float:
    outer.inner.marks[:] = False
    outer.inner.marks[1] = True
    outer.inner.values[1, 4] = 0.5
    outer.counts[6] = 2
    return float(outer.inner.values[1, 4] + outer.counts[6] + outer.inner.marks[1])


def test_fields_have_the_shapes_and_numbers_of_their_class() -> None:
    made: Outer = room(OUTER)
    assert made.counts.dtype == np.int64
    assert made.counts.shape == (7,)
    assert made.inner.values.shape == (2, 5)
    assert OUTER.isalignedstruct


def test_arrays_are_understood_as_each_numpy_annotates_them() -> None:
    """From 2.5 on NDArray[number] stays as it is written, before it is ndarray[shape, dtype]."""
    written = TypeVar("written", bound=np.generic)

    class Kept(Generic[written]):
        pass

    class Both:
        early: np.ndarray[tuple[int, ...], np.dtype[np.int64]]
        late: Kept[np.int64]

    made = layout(Both, early=(2,), late=(2,))
    assert made["early"] == made["late"] == np.dtype((np.int64, (2,)))


def test_a_name_that_numpy_has_for_something_else_is_refused() -> None:
    class Sized:
        size: NDArray[np.int64]

    with pytest.raises(ValueError, match="size"):
        layout(Sized, size=(1,))


def test_python_and_compiled_code_see_the_same_memory() -> None:
    by_python, compiled = room(OUTER), room(OUTER)
    assert [fill(by_python), numba.njit(fill)(compiled)] == [3.5, 3.5]
    for made in (by_python, compiled):
        assert made.inner.values[1, 4] == 0.5
        assert made.inner.marks.tolist() == [0, 1, 0]
