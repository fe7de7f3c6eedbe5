"""The bytes of one point's light, and back: numbers in a fixed order, nothing that could run."""

import struct

import numpy as np

from octsim.schemes.light import TERMS, AccuracyStatus, Found, Light, Waves

_RAYS = struct.Struct("<qqqqd")
"""Rays, outcomes, segments, status; the field that is missing."""
_WAVES = struct.Struct("<qqqqddd")
"""What no number of rays is, nodes, order, status; optical path length, azimuth, error."""
_NO_RAYS = -1
_NUMBER = 8
_ARRAYS = 4
_POLARISATIONS = 2
_NODE_NUMBERS = 1 + 2 * _POLARISATIONS * (1 + len(TERMS))
"""Of each node: its wavenumber, and fields of two numbers each."""


def light_to_bytes(light: Found) -> bytes:
    """Write light as bytes: a header, then its arrays one after the other, little-endian.

    Parameters
    ----------
    light : Light or Waves
        Of D rays, or at N nodes.

    Raises
    ------
    ValueError
        If the arrays are not of one length.
    """
    return _of_waves(light) if isinstance(light, Waves) else _of_rays(light)


def _of_rays(light: Light) -> bytes:
    floats = (light.amplitude, light.rough_amplitude, light.optical_path_length)
    rays = len(light.path)
    if any(values.shape != (rays,) for values in (light.path, *floats)):
        raise ValueError("light's arrays must be of one length")
    outcomes = np.empty(0, np.int64) if light.outcomes is None else light.outcomes
    return b"".join(
        (
            _RAYS.pack(rays, len(outcomes), light.segments, light.status, light.missing),
            light.path.astype("<i8", copy=False).tobytes(),
            *(values.astype("<f8", copy=False).tobytes() for values in floats),
            outcomes.astype("<i8", copy=False).tobytes(),
        )
    )


def _of_waves(light: Waves) -> bytes:
    nodes = len(light.wavenumber)
    shapes = (_POLARISATIONS, nodes), (len(TERMS), _POLARISATIONS, nodes)
    if (light.values.shape, light.terms.shape) != shapes:
        raise ValueError("light's arrays must be of one length")
    header = _WAVES.pack(
        _NO_RAYS, nodes, light.order, light.status, light.optical_path_length, light.azimuth,
        light.error,
    )  # fmt: skip
    fields = (light.values, light.terms)
    return b"".join(
        (
            header,
            light.wavenumber.astype("<f8", copy=False).tobytes(),
            *(values.astype("<c16", copy=False).tobytes() for values in fields),
        )
    )


def light_from_bytes(body: bytes) -> Found:
    """Read light from bytes.

    Raises
    ------
    ValueError
        If these are not the bytes of one light, no more and no less.
    """
    if len(body) < _RAYS.size:
        raise ValueError(f"{len(body)} bytes are too few for light")
    (first,) = struct.unpack_from("<q", body)
    return _waves_from(body) if first == _NO_RAYS else _rays_from(body)


def _rays_from(body: bytes) -> Light:
    rays, counted, segments, status, missing = _RAYS.unpack_from(body)
    expected = _RAYS.size + _NUMBER * (_ARRAYS * rays + counted)
    if min(rays, counted) < 0 or len(body) != expected:
        raise ValueError(f"{len(body)} bytes are not light of {rays} rays, {counted} outcomes")
    held = bytearray(body)  # arrays that can't be written would need machine code of their own
    path, amplitude, rough, optical_path_length = (
        np.frombuffer(held, kind, rays, _RAYS.size + _NUMBER * rays * place)
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


def _waves_from(body: bytes) -> Waves:
    if len(body) < _WAVES.size:
        raise ValueError(f"{len(body)} bytes are too few for light")
    _, nodes, order, status, optical_path_length, azimuth, error = _WAVES.unpack_from(body)
    if nodes < 0 or len(body) != _WAVES.size + _NUMBER * _NODE_NUMBERS * nodes:
        raise ValueError(f"{len(body)} bytes are not light at {nodes} nodes")
    held = bytearray(body)
    wavenumber = np.frombuffer(held, "<f8", nodes, _WAVES.size)
    at = _WAVES.size + _NUMBER * nodes
    fields = np.frombuffer(held, "<c16", -1, at).reshape(1 + len(TERMS), _POLARISATIONS, nodes)
    return Waves(
        wavenumber, fields[0], fields[1:], optical_path_length, azimuth, error, order,
        AccuracyStatus(status),
    )  # fmt: skip
