"""Files that hold arrays by name: which are the spectra, and what stands along them."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from octsim.base.errors import DatasetError
from octsim.base.failures import said_in_a_line
from octsim.measured.readers.blocks import Blocks, Sides, Source
from octsim.measured.readers.failures import is_numbers, require_numbers, sizes
from octsim.measured.readers.names import AXES, known, last_of, told_as, with_unit
from octsim.measured.readers.sides import Signs, told
from octsim.measured.recording import Recording, Values, Wanted
from octsim.phase.measured_headings import Heading, listed

_SPECTRA = {
    "spectra", "spectrum", "counts", "intensity", "raw", "interferogram", "interferograms",
    "fringes", "signal", "data",
}  # fmt: skip
"""Names by which spectra are told from other arrays beside them."""


class Held(NamedTuple):
    """An array that a file holds."""

    name: str
    shape: tuple[int, ...]
    dtype: np.dtype[Any] | None
    unit: str = ""
    dims: tuple[str, ...] = ()
    """Names of its dimensions, "" of one without; one along itself has its own."""
    rows: bool = False
    """Whether spectra are its rows, if nothing else tells."""
    kind: str = ""
    """What it holds, where that is no numbers."""

    @property
    def length(self) -> int | None:
        """How many numbers stand in it, where it has one dimension longer than one."""
        long = [size for size in self.shape if size > 1]
        return None if len(long) > 1 or 0 in self.shape else int(np.prod(self.shape))


class Container(NamedTuple):
    """A file that holds arrays by name."""

    path: Path
    held: Sequence[Held]
    source: Callable[[Held], Source]
    """Opens one, without reading it."""


def _numeric(one: Held) -> bool:
    return is_numbers(one.dtype) and not one.kind


def _quantity(one: Held) -> Heading | None:
    return known(last_of(one.name)) if _numeric(one) and one.length is not None else None


def named_inside(path: Path, held: Held) -> str:
    """Return the name of an array and of its file, for what is said of it."""
    return f"{path}, {held.name}" if held.name else str(path)


def recording_of(container: Container, wanted: Wanted) -> Recording:
    """Return the recording that stands in a file of arrays.

    Raises
    ------
    DatasetError
        If there is none, or more than one might be it, or its dimensions can't be told.
    """
    path = container.path
    spectra = _chosen(path, container.held, wanted.at)
    if spectra is None:
        return _axis_alone(container, wanted)
    name = named_inside(path, spectra)
    require_numbers(name, spectra.dtype, spectra.kind)
    notes: list[str] = []
    axis = _beside(container.held, spectra, AXES)
    dated = _beside(container.held, spectra, ("time",))
    if axis is not None and not _along(axis, spectra):
        if wanted.samples is None:
            raise DatasetError(
                f"{named_inside(path, axis)}: has {axis.length} numbers, and {spectra.name} is "
                f"{sizes(spectra.shape)}; give one for each sample"
            )
        notes.append(f"{axis.name} is not read, as it has {axis.length} numbers")
        axis = None
    signs = Signs(
        samples=_place(spectra, axis, AXES),
        time=_place(spectra, dated, ("time",)),
        axis=axis.length if axis else None,
        times=dated.length if dated else None,
        rows=spectra.rows,
    )
    found = told(container.source(spectra), signs, wanted.samples, wanted.x, name)
    counts = Blocks(found.source, found.sides, name)
    along = _values(container, axis, wanted.samples is None, notes)
    times = _values(container, dated, False, notes)
    if times is not None and times.values.size != counts.shape[0]:
        notes.append(f"these are {times.values.size}, and not read as the times of the spectra")
        times = None
    what = f"{spectra.name or 'it'} is {sizes(spectra.shape)}, {counts.dtype}"
    return Recording(
        counts, along, times, name, (f"{what}: {described(counts.shape, found.by)}", *notes)
    )


def described(shape: tuple[int, int], by: str) -> str:
    """Return how many spectra there are, and what tells their samples, in words."""
    spectra = "1 spectrum" if shape[0] == 1 else f"{shape[0]} spectra"
    return f"{spectra} of {shape[1]} samples, told by {by}"


def _chosen(path: Path, held: Sequence[Held], at: str | None) -> Held | None:
    """Return the spectra among arrays; None where there is nothing but an axis."""
    if at is not None:
        every, wanted = held, at.strip("/")
        exact = [one for one in held if one.name.strip("/") == wanted]
        if exact:
            return exact[0]
        within = (f"{wanted}/", f"{wanted}.")
        held = [one for one in held if one.name.strip("/").startswith(within)]
        if not held:
            raise DatasetError(
                f"{path}: holds no {at!r}; give measured.at as one of {_listed(every) or 'none'}"
            )
    free = [one for one in held if _numeric(one) and _quantity(one) is None]
    candidates = [one for one in free if one.length is None and 0 not in one.shape] or free
    if len(candidates) > 1:
        spoken = [one for one in candidates if last_of(one.name).casefold() in _SPECTRA]
        candidates = spoken if len(spoken) == 1 else candidates
    if len(candidates) > 1:
        raise DatasetError(
            f"{path}: more than one array may be the spectra, {_listed(candidates)}; give "
            "measured.at, the name of one"
        )
    if candidates:
        return candidates[0]
    if any(_quantity(one) is not None for one in held):
        return None
    if not held:
        raise DatasetError(f"{path}: holds no arrays; give a file with spectra")
    return held[0]


def _listed(held: Sequence[Held]) -> str:
    return listed([f"{one.name} ({sizes(one.shape)})" for one in held])


def _axis_alone(container: Container, wanted: Wanted) -> Recording:
    """Return a recording without spectra, as a file of a calibration is one."""
    path = container.path
    axes = [one for one in container.held if (_quantity(one) or Heading("", None)).name in AXES]
    if wanted.samples is not None or not axes:
        raise DatasetError(
            f"{path}: holds no spectra, but {_listed(container.held)}; give a file with both"
        )
    notes: list[str] = []
    axis = _values(container, axes[0], True, notes)
    assert axis is not None, "as it is needed"
    return empty(axis, named_inside(path, axes[0]), notes)


def empty(axis: Values, name: str, notes: Sequence[str]) -> Recording:
    """Return a recording of an axis without a spectrum."""
    counts = Blocks(np.empty((0, axis.values.size)), Sides(1, 0, {}), name)
    return Recording(counts, axis, None, name, (*notes, "there are no spectra beside the axis"))


def _beside(held: Sequence[Held], spectra: Held, names: Sequence[str]) -> Held | None:
    """Return the array of some name that is along spectra: attached, else nearest in the file."""
    found = [
        (one, heading.name)
        for one in held
        if one is not spectra and (heading := _quantity(one)) and heading.name in names
    ]

    def farness(pair: tuple[Held, str]) -> tuple[bool, bool, int, int]:
        one, name = pair
        folder, own = one.name.rpartition("/")[0], spectra.name.rpartition("/")[0]
        apart = 0 if folder == own else 1 if own.startswith(folder) else 2
        return not _attached(one, spectra), not _along(one, spectra), apart, names.index(name)

    return min(found, key=farness)[0] if found else None


def _attached(one: Held, spectra: Held) -> bool:
    return bool(one.dims and one.dims[0] and one.dims[0] in spectra.dims)


def _along(one: Held, spectra: Held) -> bool:
    """Whether an array is as long as spectra are along something, or as parts of a long row."""
    if one.length in spectra.shape:
        return True
    return bool(spectra.length and one.length and spectra.length % one.length == 0)


def _place(spectra: Held, beside: Held | None, names: Sequence[str]) -> int | None:
    """Return the dimension that is along an array beside spectra, or is named as such a one."""
    if beside is not None and _attached(beside, spectra):
        return spectra.dims.index(beside.dims[0])
    headings = [known(last_of(dim)) if dim else None for dim in spectra.dims]
    places = [place for place, one in enumerate(headings) if one and one.name in names]
    return places[0] if len(places) == 1 else None


def _values(
    container: Container, one: Held | None, needed: bool, notes: list[str]
) -> Values | None:
    """Return the numbers of an array along spectra; None where they can be done without."""
    heading = _quantity(one) if one is not None else None
    if one is None or heading is None:
        return None
    where = named_inside(container.path, one)
    with said_in_a_line(where, "give measured.axis, or measured.rate, and a name that is neither"):
        found = np.asarray(container.source(one)[(slice(None),) * len(one.shape)], float).ravel()
    try:
        values, unsaid = with_unit(found, Heading(heading.name, one.unit or heading.unit), where)
    except DatasetError as error:
        if needed:
            raise
        notes.append(f"not read: {error}")
        return None
    notes.append(told_as(one.name, values, unsaid))
    return values
