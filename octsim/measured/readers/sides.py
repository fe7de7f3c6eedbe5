"""Which dimension of an array is time and which the samples of a spectrum."""

from typing import NamedTuple

from octsim.base.errors import DatasetError
from octsim.measured.readers.blocks import Folded, Sides, Source
from octsim.measured.readers.failures import sizes

CAMERAS = frozenset({512, 1024, 2048, 3648, 4096, 8192})
"""How many pixels the lines of cameras have, most of them."""
_REMEDY = "give measured.axis with a file, whose length tells"


class Signs(NamedTuple):
    """What a file says of the dimensions of an array."""

    samples: int | None = None
    """Dimension that is by its name, or by what is attached to it, along the axis."""
    time: int | None = None
    """Dimension that is by its name, or by what is attached to it, along time."""
    axis: int | None = None
    """Length of an axis beside the array."""
    times: int | None = None
    """Length of times beside the array."""
    rows: bool = False
    """Whether spectra are rows by the kind of file, if nothing else tells."""


class Told(NamedTuple):
    """Spectra in an array."""

    source: Source
    sides: Sides
    by: str
    """What the samples are told by, in words."""


def told(source: Source, signs: Signs, samples: int | None, x: int | None, name: str) -> Told:
    """Tell which dimension of an array is what.

    The samples are, in this order: what the file names so; what is as long as the axis that it
    holds, else as the one that is given; what is left beside the time, or beside dimensions of
    length one; the rows of a kind of file that has them so; and the last of two dimensions if
    cameras have so many pixels, and not as many as the other has. Where none of it tells, and
    where it tells two, nothing is guessed.

    Parameters
    ----------
    source : Source
    signs : Signs
    samples : int or None
        K, if it is known.
    x : int or None
        Index along the dimension that is neither time nor samples.
    name : str
        Of the array, for what is said of it.

    Raises
    ------
    DatasetError
        If the dimensions can't be told, or are not as they are asked for.
    """
    shape = tuple(int(size) for size in source.shape)
    if 0 in shape or not shape:
        raise DatasetError(f"{name}: holds no spectra, with the size {sizes(shape)}; give others")
    places = [place for place, size in enumerate(shape) if size > 1]
    length = signs.axis if signs.axis is not None else samples
    if len(places) <= 1:
        place = places[0] if places else len(shape) - 1
        _refuse_x(x, len(shape) > 2, name)
        return _of_a_row(source, place, length, samples, name)
    along, by = _along(shape, places, signs, length, name)
    if samples is not None and shape[along] != samples:
        raise DatasetError(
            f"{name}: is {sizes(shape)} and has {shape[along]} samples by {by}, but {samples} are "
            "given; give the axis of this spectrometer, or spectra of that one"
        )
    others = [place for place in range(len(shape)) if place != along]
    while len(others) > 2 and any(shape[place] == 1 for place in others):
        others.remove(next(place for place in reversed(others) if shape[place] == 1))
    if len(others) > 2:
        raise DatasetError(
            f"{name}: has {len(places)} dimensions, {sizes(shape)}; give spectra over time and one "
            "place at most"
        )
    time = _time(shape, others, signs)
    held = {place: 0 for place in range(len(shape)) if place not in (along, time)}
    across = [place for place in others if place != time]
    if across and shape[across[0]] > 1:
        held[across[0]] = _index(x, shape, across[0], name)
    else:
        _refuse_x(x, len(shape) > 2, name)
    return Told(source, Sides(along, time, held), by)


def _of_a_row(
    source: Source, place: int, length: int | None, samples: int | None, name: str
) -> Told:
    """Return a single spectrum, or one after the other in a long row."""
    count = int(source.shape[place])
    if samples is not None and length != samples:
        raise DatasetError(
            f"{name}: has an axis of {length} samples, but {samples} are given; give the axis of "
            "this spectrometer"
        )
    if length is not None and count != length:
        if count % length:
            raise DatasetError(
                f"{name}: holds {count} numbers in a row, which are no spectra of {length} "
                "samples; give the axis of this spectrometer, or whole spectra"
            )
        return Told(Folded(source, place, length), Sides(1, 0, {}), "the length of the axis")
    held = {other: 0 for other in range(len(source.shape)) if other != place}
    return Told(source, Sides(place, None, held), "its only dimension")


def _along(
    shape: tuple[int, ...], places: list[int], signs: Signs, length: int | None, name: str
) -> tuple[int, str]:
    """Return the dimension of the samples, and what tells."""
    if signs.samples in places:
        return places[places.index(signs.samples)], "what it is named"
    if length is not None:
        fits = [place for place in places if shape[place] == length and place != signs.time]
        if len(fits) == 1:
            return fits[0], "the length of the axis"
        if not fits:
            raise DatasetError(
                f"{name}: is {sizes(shape)}, and the axis has {length} samples, as no dimension "
                "has; give the axis of this spectrometer"
            )
        if signs.rows and fits[-1] == len(shape) - 1:
            return fits[-1], "standing last, as they do in a file of this kind"
        raise DatasetError(
            f"{name}: is {sizes(shape)}, and more than one dimension is as long as the axis, "
            f"{length}; leave a spectrum out, or name the dimensions in the file"
        )
    beside = [place for place in places if place != _dated(shape, places, signs)]
    if len(beside) == 1:
        return beside[0], "not being the time"
    if signs.rows:
        return len(shape) - 1, "standing last, as they do in a file of this kind"
    usual = [place for place in places if shape[place] in CAMERAS]
    if usual == [len(shape) - 1]:
        return usual[0], f"standing last, and {shape[-1]} being as many as lines of cameras have"
    raise DatasetError(
        f"{name}: is {sizes(shape)}, and nothing says which of {_or(shape, places)} are the "
        f"samples of a spectrum; {_REMEDY}"
    )


def _or(shape: tuple[int, ...], places: list[int]) -> str:
    *first, last = (str(shape[place]) for place in places)
    return f"{', '.join(first)} and {last}"


def _dated(shape: tuple[int, ...], places: list[int], signs: Signs) -> int | None:
    """Return the dimension that is time by its name, or by the length of times alone."""
    if signs.time in places:
        return signs.time
    fits = [place for place in places if shape[place] == signs.times]
    return fits[0] if len(fits) == 1 else None


def _time(shape: tuple[int, ...], others: list[int], signs: Signs) -> int:
    """Return the dimension of time among those that are not the samples."""
    dated = _dated(shape, others, signs)
    return others[0] if dated is None else dated


def _index(x: int | None, shape: tuple[int, ...], place: int, name: str) -> int:
    if x is None:
        raise DatasetError(
            f"{name}: has three dimensions, {sizes(shape)}; give measured.x, from 0 to "
            f"{shape[place] - 1}, of the one with {shape[place]}"
        )
    if not 0 <= x < shape[place]:
        raise DatasetError(
            f"{name}: is {sizes(shape)}, and measured.x is {x}; give it from 0 to "
            f"{shape[place] - 1}"
        )
    return x


def _refuse_x(x: int | None, single: bool, name: str) -> None:
    if x is not None and not (single and x == 0):
        raise DatasetError(f"{name}: has no third dimension with a place {x}; leave measured.x out")
