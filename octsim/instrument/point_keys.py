"""Keys by content: points whose light is the same to the bit, and no others, share one."""

import json
import platform
import struct
from collections.abc import Mapping
from functools import cache
from hashlib import blake2b
from importlib.metadata import version

import llvmlite.binding

_POINT = struct.Struct("<dd")


@cache
def _machine_code() -> Mapping[str, str]:
    """Return what turns the sources into numbers: its last bits may differ with any of these."""
    libraries = {name: version(name) for name in ("numpy", "numba", "llvmlite")}
    processor = llvmlite.binding.get_host_cpu_name()
    features = llvmlite.binding.get_host_cpu_features().flatten()
    return {**libraries, "processor": f"{processor} {features}", "libc": str(platform.libc_ver())}


def instrument_key(parts: Mapping[str, object], code: str) -> bytes:
    """Digest an instrument: all that light depends on but for the diameter and the focus.

    Parameters
    ----------
    parts : mapping
        What the tracer reads of a config: numbers, text, lists and mappings of them, in any order.
        Floats count to the last bit.
    code : str
        Digest of the sources that trace.

    Returns
    -------
    bytes
        32 of them, of BLAKE2b.

    Raises
    ------
    TypeError, ValueError
        If a part is something else, or is not finite.
    """
    text = json.dumps(
        {"parts": parts, "code": code, "machine_code": _machine_code()},
        sort_keys=True, separators=(",", ":"), allow_nan=False,
    )  # fmt: skip
    return blake2b(text.encode(), digest_size=32).digest()


def point_key(instrument: bytes, diameter: float, focus: float) -> bytes:
    """Return the key of a point of an instrument: diameter and focus, µm, follow its digest.

    Equal numbers are equal keys: −0 is 0.
    """
    return instrument + _POINT.pack(diameter + 0.0, focus + 0.0)
