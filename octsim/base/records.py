"""Records: room that compiled code works in, as one block of memory.

A named tuple of arrays reaches a compiled function as seven numbers for each array, and whoever
holds it counts references to each; the compiler takes most of its time over that. A record is one
address, and where its arrays lie and how large they are is known when the code is compiled.
"""

from typing import Any, get_args, get_type_hints

import numpy as np

_ARRAYS = {np.dtype(np.bool_): np.dtype(np.int8)}  # numba has no arrays of bool in a record


def layout(of: type, **shapes: "tuple[int, ...] | np.dtype[Any]") -> "np.dtype[Any]":
    """Return the layout of a record.

    Parameters
    ----------
    of : type
        A class whose annotations name the fields: arrays, numbers and other records.
    **shapes : tuple of int or dtype
        Shape of each array, and layout of each record within this one.

    Raises
    ------
    ValueError
        If a field has the name of something else that records of numpy have.
    """
    fields: list[tuple[Any, ...]] = []
    for name, kind in get_type_hints(of).items():
        shape = shapes.get(name)
        if hasattr(np.record, name):
            raise ValueError(f"{of.__name__}.{name}: numpy's records have another {name}")
        if isinstance(shape, tuple):
            number = _number_of(kind)
            fields.append((name, _ARRAYS.get(number, number), shape))
        else:
            fields.append((name, np.dtype(kind) if shape is None else shape))
    return np.dtype(fields, align=True)


def _number_of(kind: Any) -> "np.dtype[Any]":
    """Return the number of an annotation NDArray[number]."""
    given = get_args(kind)
    # ndarray[shape, dtype[number]]; from numpy 2.5 on it stays as it is written
    number: np.dtype[Any] = np.dtype(get_args(given[1])[0] if len(given) > 1 else given[0])
    return number


def room(dtype: "np.dtype[Any]") -> Any:
    """Make a record of some layout, whose numbers are any."""
    return np.recarray(1, dtype)[0]
