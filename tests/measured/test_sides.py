"""Dimensions are told by what a file says of them, and refused where nothing does."""

from typing import Any

import numpy as np
import pytest

from octsim.base.errors import DatasetError
from octsim.measured.readers.blocks import Folded
from octsim.measured.readers.sides import Signs, told


def sides(shape: tuple[int, ...], signs: Signs, **asked: Any) -> tuple[Any, ...]:
    """Return the dimensions of time and samples, and the others with their index."""
    found = told(np.empty(shape), signs, asked.get("samples"), asked.get("x"), "it").sides
    return found.time, found.samples, dict(found.held)


@pytest.mark.parametrize(
    ("shape", "signs", "asked", "expected"),
    [((9, 40), Signs(), {"samples": 40}, (0, 1, {})),
     ((40, 9), Signs(), {"samples": 40}, (1, 0, {})),
     ((40, 9), Signs(axis=40), {}, (1, 0, {})),
     ((40, 40), Signs(samples=0), {}, (1, 0, {})),
     ((40, 40), Signs(time=1, axis=40), {}, (1, 0, {})),
     ((9, 40), Signs(times=9), {}, (0, 1, {})),
     ((9, 40), Signs(time=1), {}, (1, 0, {})),
     ((40, 9), Signs(rows=True), {}, (0, 1, {})),
     ((40, 9), Signs(rows=True), {"samples": 40}, (1, 0, {})),
     ((40, 40), Signs(rows=True), {"samples": 40}, (0, 1, {})),
     ((1, 40), Signs(), {}, (None, 1, {0: 0})),
     ((40, 1), Signs(), {}, (None, 0, {1: 0})),
     ((40,), Signs(), {}, (None, 0, {})),
     ((900, 2048), Signs(), {}, (0, 1, {})),
     ((9, 3, 40), Signs(), {"samples": 40, "x": 2}, (0, 2, {1: 2})),
     ((40, 9, 3), Signs(), {"samples": 40, "x": 2}, (1, 0, {2: 2})),
     ((3, 40, 9), Signs(times=9), {"samples": 40, "x": 2}, (2, 1, {0: 2})),
     ((3, 40, 9), Signs(time=2), {"samples": 40, "x": 2}, (2, 1, {0: 2})),
     ((9, 1, 40), Signs(), {"samples": 40}, (0, 2, {1: 0})),
     ((9, 1, 40), Signs(), {"samples": 40, "x": 0}, (0, 2, {1: 0})),
     ((1, 3, 40), Signs(), {"samples": 40, "x": 1}, (0, 2, {1: 1})),
     ((9, 1, 3, 40), Signs(), {"samples": 40, "x": 1}, (0, 3, {1: 0, 2: 1}))],
)  # fmt: skip
def test_dimensions_are_told(
    shape: tuple[int, ...], signs: Signs, asked: dict[str, int], expected: tuple[Any, ...]
) -> None:
    assert sides(shape, signs, **asked) == expected


@pytest.mark.parametrize("pixels", [512, 1024, 2048, 3648, 4096, 8192])
def test_a_last_dimension_as_long_as_a_camera_s_line_is_the_samples(pixels: int) -> None:
    assert sides((9, pixels), Signs()) == (0, 1, {})
    for others in (pixels - 1, pixels + 1):
        with pytest.raises(DatasetError, match=f"nothing says which of 9 and {others}"):
            sides((9, others), Signs())


def test_a_long_row_is_of_spectra_one_after_the_other() -> None:
    found = told(np.arange(60.0), Signs(), 20, None, "it")
    assert isinstance(found.source, Folded)
    np.testing.assert_array_equal(found.source[slice(1, 3), slice(None)][:, 0], [20, 40])


@pytest.mark.parametrize(
    ("shape", "signs", "asked", "said"),
    [((9, 41), Signs(), {}, "is 9 x 41, and nothing says which of 9 and 41 are .*measured.axis"),
     ((2048, 900), Signs(), {}, "which of 2048 and 900"),  # a camera's, but not last
     ((1024, 2048), Signs(), {}, "which of 1024 and 2048"),  # both a camera's
     ((40, 40), Signs(), {"samples": 40}, "more than one dimension is as long"),
     ((9, 41), Signs(), {"samples": 40}, "40 samples, as no dimension has"),
     ((9, 41), Signs(axis=41), {"samples": 40}, "has 41 samples by .* but 40 are given"),
     ((41,), Signs(axis=41), {"samples": 40}, "axis of 41 samples, but 40 are given"),
     ((1, 3, 40), Signs(), {"samples": 40}, "1 x 3 x 40; give measured.x, from 0 to 2"),
     ((9, 40), Signs(), {"samples": 40, "x": 0}, "no third dimension"),
     ((1, 40), Signs(), {"x": 0}, "no third dimension"),
     ((40,), Signs(), {"x": 0}, "no third dimension"),
     ((9, 1, 40), Signs(), {"samples": 40, "x": 1}, "no third dimension")],
)  # fmt: skip
def test_what_is_not_told_is_refused(
    shape: tuple[int, ...], signs: Signs, asked: dict[str, int], said: str
) -> None:
    with pytest.raises(DatasetError, match=said) as refused:
        sides(shape, signs, **asked)
    assert str(refused.value).startswith("it: ")
