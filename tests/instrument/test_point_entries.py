"""A point's bytes hold all of its light to the bit, and its key all that decides it."""

import json
import math
import struct
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import version

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from llvmlite.binding.targets import FeatureMap

from octsim.config.load import load_config
from octsim.instrument import point_keys
from octsim.instrument.instrument import Instrument
from octsim.instrument.point_entries import light_from_bytes, light_to_bytes
from octsim.instrument.point_keys import instrument_key, point_key
from octsim.schemes.light import AccuracyStatus, Found, Light, Sampled, Waves

LONG = st.integers(-(2**63), 2**63 - 1)


@st.composite
def lights(draw: st.DrawFn) -> Light:
    rays = draw(st.integers(0, 5))
    return Light(
        draw(arrays(np.int64, rays, elements=LONG)),
        draw(arrays(np.float64, rays)),
        draw(arrays(np.float64, rays)),
        draw(arrays(np.float64, rays)),
        draw(st.floats()),
        draw(LONG),
        draw(st.sampled_from(AccuracyStatus)),
        draw(st.none() | arrays(np.int64, 7, elements=LONG)),
        draw(st.none() | arrays(np.float64, (3, rays))),
    )


def bits(light: Found) -> list[object]:
    """Give all that light holds, so that NaN is NaN and −0 is not 0."""
    return [
        bits(value) if isinstance(value, Light)
        else value.tobytes() if isinstance(value, np.ndarray)
        else struct.pack("d", value) if isinstance(value, float) else value
        for value in light
    ]  # fmt: skip


@st.composite
def sampled(draw: st.DrawFn) -> Sampled:
    samples, fields = draw(st.integers(0, 5)), draw(st.integers(1, 4))
    return Sampled(
        draw(lights()), draw(arrays(np.float64, samples)),
        draw(arrays(np.complex128, (fields, samples))), draw(st.floats()),
    )  # fmt: skip


@st.composite
def waves(draw: st.DrawFn) -> Waves:
    nodes = draw(st.integers(0, 5))
    return Waves(
        draw(arrays(np.float64, nodes)),
        draw(arrays(np.complex128, (2, nodes))),
        draw(arrays(np.complex128, (3, 2, nodes))),
        draw(st.floats()), draw(st.floats()), draw(st.floats()), draw(LONG),
        draw(st.sampled_from(AccuracyStatus)),
    )  # fmt: skip


@given(lights() | sampled() | waves())
def test_light_comes_back_to_the_bit(light: Found) -> None:
    again = light_from_bytes(light_to_bytes(light))
    assert bits(again) == bits(light)
    assert [type(value) for value in again] == [type(value) for value in light]
    for one, other in zip(again, light, strict=True):
        if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
            assert one.dtype == other.dtype
            assert one.flags.aligned
            assert one.flags.writeable


@given(lights() | waves(), st.data())
def test_bytes_of_another_length_are_refused(light: Found, data: st.DataObject) -> None:
    body = light_to_bytes(light)
    size = data.draw(st.integers(0, len(body) - 1))
    for wrong in (body[:size], body + b"\0", body + bytes(8)):
        with pytest.raises(ValueError, match="light"):
            light_from_bytes(wrong)


@pytest.mark.parametrize(
    ("rays", "counted", "status"), [(-1, 4, 0), (1, -4, 0), (2**60, 0, 0), (0, 0, 9)]
)
def test_counts_and_statuses_that_cannot_be_are_refused(
    rays: int, counted: int, status: int
) -> None:
    with pytest.raises(ValueError, match=r"light|AccuracyStatus"):
        light_from_bytes(struct.pack("<qqqqqd", rays, counted, 0, 1, status, 0.0))


def test_arrays_of_different_lengths_are_refused() -> None:
    one, two = np.ones(1), np.ones(2)
    with pytest.raises(ValueError, match="one length"):
        light_to_bytes(Light(np.ones(2, np.int64), two, one, two, 0.0, 1, AccuracyStatus.REACHED))


def test_kept_light_sums_to_the_same_spectrum() -> None:
    config = load_config({"tracing": {"rays": 300}, "spectrum": {"samples": 50}})
    light = Instrument(config).rays(1.4, 0.9)
    assert light.amplitude.size > 0
    spectrum, error, _ = Instrument(config).sum(light)
    again, error_again, _ = Instrument(config).sum(light_from_bytes(light_to_bytes(light)))
    assert again.tobytes() == spectrum.tobytes()
    assert error_again == error


PARTS = {"scene": {"gap": 0.005, "index": {"glass": 1.52}}, "tracing": {"rays": 3000}}


def test_a_key_is_the_same_in_any_order_and_process() -> None:
    turned = {"tracing": {"rays": 3000}, "scene": {"index": {"glass": 1.52}, "gap": 0.005}}
    key = instrument_key(PARTS, "1a2b")
    assert instrument_key(turned, "1a2b") == key
    assert len(key) == 32
    code = (
        "import json, sys; from octsim.instrument.point_keys import instrument_key;"
        "print(instrument_key(json.loads(sys.argv[1]), '1a2b').hex())"
    )
    command = [sys.executable, "-c", code, json.dumps(PARTS)]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert said.strip() == key.hex()


@pytest.mark.parametrize(
    "parts",
    [
        {**PARTS, "tracing": {"rays": 3001}},
        {**PARTS, "scene": {"gap": math.nextafter(0.005, 1), "index": {"glass": 1.52}}},
        {**PARTS, "scene": {"gap": 0.005, "index": {"glass": "1.52"}}},
        {**PARTS, "more": None},
        {"scene": PARTS["scene"]},
    ],
)
def test_whatever_differs_makes_another_key(parts: dict[str, object]) -> None:
    assert instrument_key(parts, "1a2b") != instrument_key(PARTS, "1a2b")


def test_other_code_or_another_library_or_processor_makes_another_key(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    key = instrument_key(PARTS, "1a2b")
    assert instrument_key(PARTS, "1a2c") != key
    monkeypatch.setattr("octsim.instrument.point_keys._machine_code", lambda: {"numpy": "0"})
    assert instrument_key(PARTS, "1a2b") != key


@pytest.mark.parametrize(
    ("of", "name", "other"),
    [
        ("llvmlite.binding", "get_host_cpu_name", lambda: "another"),
        ("llvmlite.binding", "get_host_cpu_features", lambda: FeatureMap({"avx512f": False})),
        ("platform", "libc_ver", lambda: ("glibc", "0.0")),
    ],
    ids=["processor", "what it can do", "libc"],
)
def test_whatever_machine_code_hangs_on_makes_another_key(
    of: str, name: str, other: Callable[..., object], monkeypatch: pytest.MonkeyPatch
) -> None:
    point_keys._machine_code.cache_clear()
    key = instrument_key(PARTS, "1a2b")
    monkeypatch.setattr(f"{of}.{name}", other)
    point_keys._machine_code.cache_clear()
    changed = instrument_key(PARTS, "1a2b")
    monkeypatch.undo()
    point_keys._machine_code.cache_clear()
    assert changed != key
    assert instrument_key(PARTS, "1a2b") == key


@pytest.mark.parametrize("library", ["numpy", "numba", "llvmlite"])
def test_another_version_of_a_library_makes_another_key(
    library: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    point_keys._machine_code.cache_clear()
    key = instrument_key(PARTS, "1a2b")
    monkeypatch.setattr(
        "octsim.instrument.point_keys.version",
        lambda name: "0.0" if name == library else version(name),
    )
    point_keys._machine_code.cache_clear()
    changed = instrument_key(PARTS, "1a2b")
    monkeypatch.undo()
    point_keys._machine_code.cache_clear()
    assert changed != key


@pytest.mark.parametrize("part", [math.nan, math.inf, {1, 2}, np.ones(2)])
def test_what_has_no_one_text_is_refused(part: object) -> None:
    with pytest.raises((TypeError, ValueError)):
        instrument_key({"part": part}, "1a2b")


@given(st.floats(allow_nan=False), st.floats(allow_nan=False))
def test_points_share_a_key_if_they_are_equal(one: float, other: float) -> None:
    for again in (one, math.nextafter(one, 0.0), other):
        same = point_key(b"i", one, 1.0) == point_key(b"i", again, 1.0)
        assert same == (one == again)
        assert (point_key(b"i", 1.0, one) == point_key(b"i", 1.0, again)) == same
    assert point_key(b"i", 1.0, 2.0) != point_key(b"j", 1.0, 2.0)


def test_minus_nought_is_nought() -> None:
    assert point_key(b"i", -0.0, -0.0) == point_key(b"i", 0.0, 0.0)
