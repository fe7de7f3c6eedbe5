"""Stages part by part: combination after combination, block after block, in a fixed order."""

import inspect
from collections.abc import Callable, Iterator, Mapping
from functools import update_wrapper
from typing import Any, Generic, NamedTuple, ParamSpec, Protocol

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.given import with_config, with_named_config
from octsim.config.grid import Combination
from octsim.datasets.files import attributes
from octsim.datasets.layout import Layout, filling
from octsim.datasets.statuses import statuses_of
from octsim.datasets.variables import meaning

Parameters = ParamSpec("Parameters")


class Part(NamedTuple):
    """What a stage found for one combination, or for some of its points."""

    at: Combination
    """The combination."""
    first: int
    """First of the points along the swept dimension."""
    points: int
    """Number of points, for what tells of progress."""
    variables: Mapping[str, Any]
    """As `xarray.Dataset` takes them, of this combination and these points alone."""


class Stream(NamedTuple):
    """A stage's dataset to be."""

    layout: Layout
    """What it looks like."""
    parts: Iterator[Part]
    """What it holds, made when it is asked for."""


class Sink(Protocol):
    """Where parts are put together."""

    def create(
        self,
        name: str,
        dimensions: tuple[str, ...],
        dtype: np.dtype[Any],
        attributes: Mapping[str, Any],
    ) -> None:
        """Make room for a variable."""

    def put(self, name: str, place: tuple[Any, ...], values: NDArray[Any]) -> None:
        """Set some of its values."""

    def append(self, name: str, values: NDArray[Any]) -> None:
        """Add values to a ragged variable."""


def pour(stream: Stream, sink: Sink) -> None:
    """Put every part of a stage where it belongs.

    A variable along a dimension without a coordinate is ragged: its values stand one after the
    other in the order of the parts.
    """
    layout, known = stream.layout, set[str]()
    for part in stream.parts:
        for name, (own, values, *rest) in arrays(part.variables):
            named = tuple(map(layout.dimension, own))
            ragged = layout.is_ragged(named)
            if name not in known:
                known.add(name)
                whole = named if ragged else (*layout.grid_dimensions, *named)
                said = meaning(name) | statuses_of(layout.stage, name)
                sink.create(name, whole, values.dtype, said | (rest[0] if rest else {}))
            if ragged:
                sink.append(name, values)
                continue
            spans = [
                slice(first := part.first if d == layout.swept else 0, first + size)
                for d, size in zip(own, values.shape, strict=True)
            ]
            sink.put(name, (*part.at.position, *spans), values)


def arrays(variables: Mapping[str, Any]) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """Return a part's variables, each as its dimensions, its array and maybe its attributes."""
    for name, given in variables.items():
        own, values, *rest = given if isinstance(given, tuple) else ((), given)
        yield name, ((own,) if isinstance(own, str) else own, np.asarray(values), *rest)


class _Memory:
    """Arrays of a dataset in memory."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._named: dict[str, tuple[tuple[str, ...], Mapping[str, Any]]] = {}
        self._arrays: dict[str, NDArray[Any]] = {}
        self._ragged: dict[str, list[NDArray[Any]]] = {}

    def create(
        self,
        name: str,
        dimensions: tuple[str, ...],
        dtype: np.dtype[Any],
        attributes: Mapping[str, Any],
    ) -> None:
        self._named[name] = dimensions, attributes
        if not self._layout.is_ragged(dimensions):
            shape = [self._layout.sizes[d] for d in dimensions]
            self._arrays[name] = np.full(shape, filling(dtype), dtype)

    def put(self, name: str, place: tuple[Any, ...], values: NDArray[Any]) -> None:
        self._arrays[name][place] = values

    def append(self, name: str, values: NDArray[Any]) -> None:
        self._ragged.setdefault(name, []).append(values)

    def variables(self) -> dict[str, xr.Variable]:
        arrays = self._arrays | {name: np.concatenate(v) for name, v in self._ragged.items()}
        return {
            name: xr.Variable(dimensions, arrays[name], attributes)
            for name, (dimensions, attributes) in self._named.items()
        }


def in_memory(stream: Stream) -> xr.Dataset:
    """Put a stage's parts together in memory."""
    layout = stream.layout
    memory = _Memory(layout)
    pour(stream, memory)
    described = {**attributes(layout.stage, layout.config, layout.title), **layout.further}
    return xr.Dataset(memory.variables(), layout.coordinates, described)


class Streamed(Generic[Parameters]):
    """A stage: called, it gives its dataset in memory; `stream` gives it part by part."""

    __name__: str

    def __init__(self, stream: Callable[Parameters, Stream]) -> None:
        self.stream = stream
        update_wrapper(self, stream)

    def __call__(self, *arguments: Parameters.args, **keywords: Parameters.kwargs) -> xr.Dataset:
        """Return the stage's dataset, in memory; its config may be a file's name or a mapping."""
        given, named = with_config(arguments), with_named_config(keywords)
        return in_memory(self.stream(*given, **named))

    def __repr__(self) -> str:
        own = inspect.signature(self.stream).parameters.values()
        plain = inspect.Signature([one.replace(annotation=one.empty) for one in own])
        purpose = (self.__doc__ or "").strip().partition("\n")[0]
        return f"<stage {self.__name__}{plain}: {purpose} Returns its Dataset.>"
