"""Recordings in MATLAB's files before v7.3."""

import warnings
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from octsim.measured.readers.blocks import Source
from octsim.measured.readers.failures import require_numbers
from octsim.measured.readers.inside import Container, Held, named_inside, recording_of
from octsim.measured.readers.zips import require_credible
from octsim.measured.recording import Recording, Wanted

_TYPES = {
    "double": "f8", "single": "f4", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2",
    "int32": "i4", "uint32": "u4", "int64": "i8", "uint64": "u8",
}  # fmt: skip
_LOGICAL = "logical"


def matlab_recording(path: Path, wanted: Wanted, stack: ExitStack) -> Recording:  # noqa: ARG001
    """Return the recording in a file of MATLAB's v4 to v7, an array of which is read whole.

    Fields of a structure are arrays too, as ``data.spectra``.
    """
    from scipy import io  # a third of a second that few need

    size = path.stat().st_size
    structures: dict[str, Any] = {}
    held: list[Held] = []
    for name, shape, kind in io.whosmat(str(path)):
        require_credible(f"{path}, {name}", 8 * int(np.prod(shape, dtype=object)), size)
        if kind == "struct" and shape == (1, 1):
            structures |= _fields(name, _loaded(path, name)[0, 0])
        elif kind in _TYPES:
            held.append(Held(name, tuple(shape), np.dtype(_TYPES[kind])))
        else:
            what = "truth values" if kind == _LOGICAL else f"MATLAB's {kind}"
            held.append(Held(name, tuple(shape), None, kind=what))
    held += [Held(name, one.shape, one.dtype) for name, one in structures.items()]

    def source(one: Held) -> Source:
        found = structures[one.name] if one.name in structures else _loaded(path, one.name)
        require_numbers(named_inside(path, one), found.dtype)  # complex, as no heading says
        numbers: Source = found
        return numbers

    return recording_of(Container(path, held, source), wanted)


def _loaded(path: Path, name: str) -> Any:
    from scipy import io

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of duplicate names, of which the last is taken
        return io.loadmat(str(path), variable_names=[name])[name]


def _fields(name: str, record: Any) -> dict[str, Any]:
    """Return the arrays in a structure, and in those within it, by their names."""
    found: dict[str, Any] = {}
    for field in record.dtype.names or ():
        value = record[field]
        if isinstance(value, np.ndarray) and value.dtype.names and value.shape == (1, 1):
            found |= _fields(f"{name}.{field}", value[0, 0])
        elif isinstance(value, np.ndarray):
            found[f"{name}.{field}"] = value
    return found
