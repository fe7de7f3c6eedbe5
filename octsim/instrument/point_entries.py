"""The bytes of one point's light, and back: numbers in a fixed order, nothing that could run."""

import struct

import numpy as np

from octsim.schemes.light import TERMS, AccuracyStatus, Found, Light, Sampled, Waves

_RAYS = struct.Struct("<qqqqqd")
"""Rays, outcomes, regions of known lengths, segments, status; the field that is missing."""
_WAVES = struct.Struct("<qqqqddd")
"""What no number of rays is, nodes, order, status; optical path length, azimuth, error."""
_SAMPLED = struct.Struct("<qqqd")
"""What no number of rays is, samples, fields; error."""
_NO_RAYS, _RAYS_AFTER = -1, -2
_NUMBER = 8
_ARRAYS = 4
_POLARISATIONS = 2
_NODE_NUMBERS = 1 + 2 * _POLARISATIONS * (1 + len(TERMS))
"""Of each node: its wavenumber, and fields of two numbers each."""


def light_to_bytes(light: Found) -> bytes:
    """Write light as bytes: a header, then its arrays one after the other, little-endian.

    Parameters
    ----------
    light : Light, Sampled or Waves
        Of D rays, those with their field at K samples, or at N nodes.

    Raises
    ------
    ValueError
        If the arrays are not of one length.
    """
    if isinstance(light, Waves):
        return _of_waves(light)
    return _of_samples(light) if isinstance(light, Sampled) else _of_rays(light)


def _of_rays(light: Light) -> bytes:
    floats = (light.amplitude, light.rough_amplitude, light.optical_path_length)
    rays = len(light.path)
    if any(values.shape != (rays,) for values in (light.path, *floats)):
        raise ValueError("light's arrays must be of one length")
    outcomes = np.empty(0, np.int64) if light.outcomes is None else light.outcomes
    lengths = np.empty((0, rays)) if light.lengths is None else light.lengths
    if lengths.shape[1:] != (rays,):
        raise ValueError("light's arrays must be of one length")
    header = _RAYS.pack(
        rays, len(outcomes), len(lengths), light.segments, light.status, light.missing
    )
    return b"".join(
        (
            header,
            light.path.astype("<i8", copy=False).tobytes(),
            *(values.astype("<f8", copy=False).tobytes() for values in (*floats, *lengths)),
            outcomes.astype("<i8", copy=False).tobytes(),
        )
    )


def _of_samples(light: Sampled) -> bytes:
    samples = len(light.wavenumber)
    if light.values.shape[1:] != (samples,):
        raise ValueError("light's arrays must be of one length")
    return b"".join(
        (
            _SAMPLED.pack(_RAYS_AFTER, samples, len(light.values), light.error),
            light.wavenumber.astype("<f8", copy=False).tobytes(),
            light.values.astype("<c16", copy=False).tobytes(),
            _of_rays(light.rays),
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
    if len(body) < _SAMPLED.size:
        raise ValueError(f"{len(body)} bytes are too few for light")
    (first,) = struct.unpack_from("<q", body)
    if first == _NO_RAYS:
        return _waves_from(body)
    return _samples_from(body) if first == _RAYS_AFTER else _rays_from(body)


def _samples_from(body: bytes) -> Sampled:
    _, samples, fields, error = _SAMPLED.unpack_from(body)
    end = _SAMPLED.size + _NUMBER * samples * (1 + 2 * fields)
    if min(samples, fields) < 0 or len(body) < end:
        raise ValueError(f"{len(body)} bytes are not light at {samples} samples")
    held = bytearray(body[_SAMPLED.size : end])
    wavenumber = np.frombuffer(held, "<f8", samples)
    values = (
        np.frombuffer(held, "<c16", -1, _NUMBER * samples)
        if samples * fields
        else (np.empty(0, np.complex128))
    )
    rays = _rays_from(body[end:])
    return Sampled(rays, wavenumber, values.reshape(fields, samples), error)


def _rays_from(body: bytes) -> Light:
    if len(body) < _RAYS.size:
        raise ValueError(f"{len(body)} bytes are too few for light")
    rays, counted, regions, segments, status, missing = _RAYS.unpack_from(body)
    expected = _RAYS.size + _NUMBER * ((_ARRAYS + regions) * rays + counted)
    if min(rays, counted, regions) < 0 or len(body) != expected:
        raise ValueError(f"{len(body)} bytes are not light of {rays} rays, {counted} outcomes")
    held = bytearray(body)  # arrays that can't be written would need machine code of their own
    path, amplitude, rough, optical_path_length, *lengths = (
        np.frombuffer(held, kind, rays, _RAYS.size + _NUMBER * rays * place)
        for place, kind in enumerate(("<i8", *(_ARRAYS - 1 + regions) * ("<f8",)))
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
        np.stack(lengths) if regions else None,
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
