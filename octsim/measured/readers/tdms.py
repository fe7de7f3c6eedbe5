"""Recordings of LabVIEW, in TDMS: channels in groups."""

import logging
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from octsim.base.errors import FileError
from octsim.measured.readers.blocks import Block, Source
from octsim.measured.readers.failures import is_numbers
from octsim.measured.readers.inside import Container, Held, recording_of
from octsim.measured.readers.names import known, times_of
from octsim.measured.recording import Recording, Wanted


class _Channel:
    """A channel as a source, (N,).

    The library reads a whole chunk, which may be as long as the channel: the last one is kept, as
    blocks are read one after the other.
    """

    def __init__(self, channel: Any) -> None:
        self._channel = channel
        self._chunks: Iterator[Any] = iter(())
        self._begin, self._chunk = 0, np.empty(0)
        self.shape, self.dtype = (len(channel),), np.dtype(channel.dtype)

    def __getitem__(self, key: tuple[slice], /) -> Block:
        """Read a part of it."""
        first, last, _ = key[0].indices(self.shape[0])
        if first < self._begin or not self._chunk.size:
            self._begin, self._chunk = 0, np.empty(0)
            self._chunks = self._channel.data_chunks()
        parts = [np.empty(0, self.dtype)]
        while first < last:
            while first >= self._begin + len(self._chunk):
                chunk = np.asarray(self._next()[:], self.dtype)
                self._begin, self._chunk = self._begin + len(self._chunk), chunk
            part = self._chunk[first - self._begin : last - self._begin]
            parts.append(part)
            first += len(part)
        return np.concatenate(parts)

    def _next(self) -> Any:
        try:
            return next(self._chunks)
        except StopIteration:
            raise EOFError(f"the channel {self._channel.name!r} is cut short") from None


class _Group:
    """Channels of one length as a source, (channels, N)."""

    def __init__(self, channels: Sequence[Any]) -> None:
        self._channels = channels
        self.shape = (len(channels), len(channels[0]))
        self.dtype = np.dtype(channels[0].dtype)

    def __getitem__(self, key: tuple[slice, slice], /) -> Block:
        """Read a part of some of them."""
        first, last, _ = key[1].indices(self.shape[1])
        size = max(last - first, 0)
        found = [channel.read_data(first, size) for channel in self._channels[key[0]]]
        if any(len(one) != size for one in found):
            raise EOFError("a channel is cut short")
        return np.array(found, self.dtype).reshape(len(found), size)


def tdms_recording(path: Path, wanted: Wanted, stack: ExitStack) -> Recording:
    """Return the recording in a TDMS file, parts of whose channels are read when asked for.

    Spectra are a group's channels of one length, one each; or one long channel, one after the
    other.
    """
    try:
        from nptdms import TdmsFile, log
    except ImportError:
        raise FileError(
            f"{path}: TDMS, which needs npTDMS; install octsim[lab] or npTDMS"
        ) from None
    log.log_manager.set_level(logging.ERROR)  # what it warns of is refused below
    # of a path the library would read a file beside it, .tdms_index, that may be of another
    stream = stack.enter_context(path.open("rb"))
    file = stack.enter_context(TdmsFile.open(stream))
    if file.file_status.incomplete_final_segment:
        raise FileError(f"{path}: its last segment is cut short; copy it anew, or defragment it")
    sources: dict[str, Source] = {}
    held: list[Held] = []
    headings: dict[str, list[str]] = {}
    for group in file.groups():
        channels = [one for one in group.channels() if len(one)]
        for one in channels:
            name = f"{group.name}/{one.name}"
            dtype = np.dtype(one.dtype)
            held.append(Held(name, (len(one),), dtype, str(one.properties.get("unit_string", ""))))
            sources[name] = _Channel(one)
        spectra = list(_spectra(channels))
        if len(spectra) > 1:
            found = _Group(spectra)
            held.append(Held(group.name, found.shape, found.dtype, rows=True))
            sources[group.name] = found
            headings[group.name] = [str(one.name) for one in spectra]
    recording = recording_of(Container(path, held, lambda one: sources[one.name]), wanted)
    return _with_times(recording, headings, path)


def _spectra(channels: Sequence[Any]) -> Iterator[Any]:
    """Return the channels of a group that are spectra, where they are of one length and type."""
    free = [one for one in channels if is_numbers(np.dtype(one.dtype)) and known(one.name) is None]
    if len({(len(one), np.dtype(one.dtype)) for one in free}) == 1:
        yield from free


def _with_times(recording: Recording, headings: dict[str, list[str]], path: Path) -> Recording:
    """Return a recording with the times that its channels are named, if they are."""
    names = headings.get(recording.name.removeprefix(f"{path}, "), [])
    if recording.time is not None or recording.counts.shape[0] != len(names):
        return recording
    times, said = times_of(names)
    return recording._replace(
        time=times, understood=(*recording.understood, *([said] if said else []))
    )
