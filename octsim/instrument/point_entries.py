"""The bytes of one point's light, and back: numbers in a fixed order, nothing that could run."""

import struct

import numpy as np

from octsim.schemes.light import AccuracyStatus, Light

_HEADER = struct.Struct("<qqqqd")
"""Rays, outcomes, segments, status; the field that is missing."""
_NUMBER = 8
_ARRAYS = 4


def light_to_bytes(light: Light) -> bytes:
    """Write light as bytes: a header, then its arrays one after the other, little-endian.

    Parameters
    ----------
    light : Light
        Of D rays; its arrays are path, amplitude, rough_amplitude and optical_path_length, (D,),
        and outcomes, if they were counted.

    Raises
    ------
    ValueError
        If the arrays of rays are not equally long.
    """
    floats = (light.amplitude, light.rough_amplitude, light.optical_path_length)
    rays = len(light.path)
    if any(values.shape != (rays,) for values in (light.path, *floats)):
        raise ValueError("light's arrays must be of one length")
    outcomes = np.empty(0, np.int64) if light.outcomes is None else light.outcomes
    return b"".join(
        (
            _HEADER.pack(rays, len(outcomes), light.segments, light.status, light.missing),
            light.path.astype("<i8", copy=False).tobytes(),
            *(values.astype("<f8", copy=False).tobytes() for values in floats),
            outcomes.astype("<i8", copy=False).tobytes(),
        )
    )


def light_from_bytes(body: bytes) -> Light:
    """Read light from bytes.

    Raises
    ------
    ValueError
        If these are not the bytes of one light, no more and no less.
    """
    if len(body) < _HEADER.size:
        raise ValueError(f"{len(body)} bytes are too few for light")
    rays, counted, segments, status, missing = _HEADER.unpack_from(body)
    expected = _HEADER.size + _NUMBER * (_ARRAYS * rays + counted)
    if min(rays, counted) < 0 or len(body) != expected:
        raise ValueError(f"{len(body)} bytes are not light of {rays} rays, {counted} outcomes")
    held = bytearray(body)  # arrays that can't be written would need machine code of their own
    path, amplitude, rough, optical_path_length = (
        np.frombuffer(held, kind, rays, _HEADER.size + _NUMBER * rays * place)
        for place, kind in enumerate(("<i8", "<f8", "<f8", "<f8"))
    )
    outcomes = np.frombuffer(held, "<i8", counted, expected - _NUMBER * counted)
    return Light(
        path,
        amplitude,
        rough,
        optical_path_length,
        missing,
        segments,
        AccuracyStatus(status),
        outcomes if counted else None,
    )
