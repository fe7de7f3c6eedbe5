"""Recordings in HDF5, of which MATLAB's v7.3 is one."""

from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from octsim.base.errors import FileError
from octsim.measured.readers.blocks import Source, Turned
from octsim.measured.readers.inside import Container, Held, recording_of
from octsim.measured.recording import Recording, Wanted

_OF_MATLAB = "MATLAB_class"
_OWN = ("#refs#", "#subsystem#")
"""Groups in which MATLAB keeps what is not a user's."""


def hdf5_recording(path: Path, wanted: Wanted, stack: ExitStack) -> Recording:
    """Return the recording in an HDF5 file, each block of which is read when it is asked for.

    Other files are never opened: what stands in them, by links, by external storage or as parts
    of a virtual dataset, is not read.
    """
    try:
        import h5py
    except ImportError:
        raise FileError(f"{path}: HDF5, which needs h5py; install octsim[lab] or h5py") from None
    file = stack.enter_context(h5py.File(path, "r"))
    datasets: dict[str, Any] = {}

    def note(name: str, one: Any) -> None:
        if isinstance(one, h5py.Dataset) and not name.startswith(_OWN):
            datasets[f"/{name}"] = one

    file.visititems(note)  # which follows neither soft nor external links
    matlab = any(_OF_MATLAB in one.attrs for one in datasets.values())
    held = [_held(name, one, matlab, h5py) for name, one in datasets.items()]

    def source(one: Held) -> Source:
        found: Source = datasets[one.name]
        return Turned(found) if matlab else found

    return recording_of(Container(path, held, source), wanted)


def _held(name: str, dataset: Any, matlab: bool, h5py: Any) -> Held:
    shape = tuple(dataset.shape or ())
    kind = _kind(dataset, h5py)
    if kind:
        return Held(name, shape, None, kind=kind)
    if matlab:  # which counts dimensions in the opposite order, and has no scales
        return Held(name, shape[::-1], dataset.dtype, _unit(dataset))
    if _text(dataset.attrs.get("CLASS")) == "DIMENSION_SCALE" and len(shape) == 1:
        return Held(name, shape, dataset.dtype, _unit(dataset), (name,))
    return Held(name, shape, dataset.dtype, _unit(dataset), _dims(dataset))


def _kind(dataset: Any, h5py: Any) -> str:
    """Return what a dataset holds, where that is no numbers."""
    try:
        dtype = np.dtype(dataset.dtype)
    except TypeError:
        return "a type that numpy has not"
    if dataset.shape is None or "MATLAB_empty" in dataset.attrs:
        return "nothing"
    if dataset.is_virtual or dataset.external:
        return "parts of other files, which are not opened"
    if _text(dataset.attrs.get(_OF_MATLAB)) in ("char", "cell", "function_handle"):
        return f"MATLAB's {_text(dataset.attrs[_OF_MATLAB])}"
    if h5py.check_string_dtype(dtype) is not None:
        return "text"
    if dtype.names and {one.casefold() for one in dtype.names} <= {"r", "i", "real", "imag"}:
        return "complex numbers"
    if dtype.kind in "iuf" and dataset.size and not dataset.id.get_storage_size():
        return "nothing that was written"
    return ""


def _text(value: Any) -> str:
    """Return an attribute as text."""
    value = value.item() if isinstance(value, np.ndarray) and value.size == 1 else value
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace").strip("\0 ")
    return value if isinstance(value, str) else ""


def _unit(dataset: Any) -> str:
    names = {name.casefold(): name for name in dataset.attrs}
    found = [names[name] for name in ("units", "unit") if name in names]
    return _text(dataset.attrs[found[0]]) if found else ""


def _dims(dataset: Any) -> tuple[str, ...]:
    """Return the names of dimensions: of the scale that is attached to each, or its label.

    They are read of their attributes, as the library's own functions end the process where one of
    these is damaged.
    """
    lists = [list(one) for one in dataset.attrs.get("DIMENSION_LIST", [])]
    labels = [_text(one) for one in dataset.attrs.get("DIMENSION_LABELS", [])]
    names = []
    for place in range(len(dataset.shape)):
        scales = lists[place] if place < len(lists) else []
        label = labels[place] if place < len(labels) else ""
        names.append(str(dataset.file[scales[0]].name) if scales else label)
    return tuple(names)
