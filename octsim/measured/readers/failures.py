"""What an array holds, where it holds no counts, in words."""

from typing import Any

import numpy as np

from octsim.base.errors import DatasetError

_OTHERS = {
    "b": "truth values", "c": "complex numbers", "M": "dates", "m": "durations", "O": "objects",
    "S": "text", "T": "text", "U": "text", "V": "records",
}  # fmt: skip
"""What an array holds that holds no numbers, by the kind of its dtype."""


def is_numbers(dtype: np.dtype[Any] | None) -> bool:
    """Return whether numbers of a type may be counts: whole ones, or real ones."""
    return dtype is not None and dtype.kind in "iuf"


def require_numbers(name: str, dtype: np.dtype[Any] | None, kind: str = "") -> None:
    """Check that an array holds numbers that may be counts.

    Parameters
    ----------
    name : str
    dtype : dtype or None
    kind : str
        What it holds instead, if that is known without a dtype.

    Raises
    ------
    DatasetError
        If it holds others, or none.
    """
    if is_numbers(dtype) and not kind:
        return
    held = kind or (_OTHERS.get(dtype.kind, str(dtype)) if dtype is not None else "no numbers")
    as_written = f" ({dtype})" if dtype is not None and dtype.kind in "bc" and not kind else ""
    raise DatasetError(f"{name}: holds {held}{as_written}; give counts, as whole or real numbers")


def sizes(shape: tuple[int, ...]) -> str:
    """Return the sizes of an array as a part of a line."""
    return " x ".join(map(str, shape)) or "a single number"
