"""Units: their sizes beside those of others, and what is said of one that can't be taken."""

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import constants

from octsim.config.units import (
    _PLAIN,
    _PREFIXED,
    PREFIXES,
    Unit,
    find_unit,
    inverted,
    known_units,
    parse_length,
)

SI = """quecto q -30, ronto r -27, yocto y -24, zepto z -21, atto a -18, femto f -15, pico p -12,
nano n -9, micro µ -6, milli m -3, centi c -2, deci d -1, deca da 1, hecto h 2, kilo k 3, mega M 6,
giga G 9, tera T 12, peta P 15, exa E 18, zetta Z 21, yotta Y 24, ronna R 27, quetta Q 30"""
"""Table 7 of the SI brochure (9th edition, version 2.01)."""

# what the library pint 0.25 makes of each name, in micrometres
PINT = {
    "1E+6": "m meter metre meters metres",
    "1E-18": "ym",
    "1E-15": "zm",
    "1E-12": "am",
    "1E-9": "fm femtometer",
    "0.000001": "pm picometre",
    "0.001": "nm nanometer nanometers nanometre nanometres",
    "1": "um µm μm micrometer micrometers micrometre micrometres micron microns µ μ",
    "1E+3": "mm millimeter millimetres",
    "1E+4": "cm centimetre",
    "1E+5": "dm decimeter",
    "1E+7": "dam",
    "1E+8": "hm",
    "1E+9": "km kilometer",
    "1E+12": "Mm",
    "1E+15": "Gm",
    "1E+18": "Tm",
    "1E+21": "Pm",
    "1E+24": "Em",
    "1E+27": "Zm",
    "1E+30": "Ym",
    "0.0001": "angstrom angstroms Å Å ångström",
    "2.54E+4": "in inch inches",
    "25.4": "thou",
    "3.048E+5": "ft foot feet",
    "9.144E+5": "yd yard yards",
}


def size(name: str) -> Decimal:
    unit = find_unit(name)
    assert unit is not None
    return unit.size


def test_prefixes_are_those_of_the_si() -> None:
    written = [row.split() for row in SI.replace("\n", " ").split(",")]
    assert {long: power for long, (_, power) in PREFIXES.items()} == {
        long: int(power) for long, _, power in written
    }
    assert all(symbol in PREFIXES[long][0] for long, symbol, _ in written)
    for long, symbol, power in written:
        for name in (f"{symbol}m", f"{long}meter", f"{long}metres"):
            assert size(name) == Decimal(10) ** (6 + int(power))
        assert size(f"{symbol}Hz") == size(f"{symbol}s") == Decimal(10) ** int(power)


@pytest.mark.parametrize(("factor", "names"), PINT.items())
def test_lengths_are_those_of_a_library_of_units(factor: str, names: str) -> None:
    for name in names.split():
        assert parse_length(f"1 {name}") == float(factor), name
        assert size(name) == Decimal(factor)


def test_sizes_are_those_of_scipy() -> None:
    for name, metres in {
        "inch": constants.inch, "ft": constants.foot, "yard": constants.yard,
        "mil": constants.mil, "angstrom": constants.angstrom, "micron": constants.micron,
    }.items():  # fmt: skip
        np.testing.assert_allclose(parse_length(f"1 {name}"), metres * 1e6, rtol=1e-15)
    assert float(size("eV")) == constants.eV
    assert float(size("deg")) == constants.degree == math.radians(1)
    assert (size("min"), size("h")) == (constants.minute, constants.hour)


def test_no_name_means_two_units() -> None:
    counted = sum(
        len(names) * (1 + len(PREFIXES)) + 1 + sum(len(symbols) for symbols, _ in PREFIXES.values())
        for _, _, names, _ in _PREFIXED
    )
    assert len(known_units()) == counted + sum(len(names) for _, names, _ in _PLAIN)


@given(st.integers(1, 10**9), st.integers(-3, 3))
def test_a_length_is_the_same_float_in_every_unit(number: int, power: int) -> None:
    shifted = {"nm": -3, "um": 0, "mm": 3, "angstrom": -4, "m": 6}
    lengths = {
        parse_length(f"{Decimal(number).scaleb(power - exponent)} {unit}")
        for unit, exponent in shifted.items()
    }
    assert lengths == {float(Decimal(number).scaleb(power))}


@pytest.mark.parametrize("unit", ["1/um", "1 / um", "rad/um", "um-1", "um^-1", "um**-1", "um -1"])
def test_an_inverse_length_is_known_by_each_way_to_write_it(unit: str) -> None:
    assert inverted(unit) == "um"
    assert find_unit(unit) == Unit("inverse length", Decimal(1))
    assert find_unit("1/cm") == Unit("inverse length", Decimal("1e-4"))
    assert find_unit("1/s") is None


@pytest.mark.parametrize(
    ("name", "dimension", "size"),
    [
        ("um/um", "ratio", "1"),
        ("nm/um", "ratio", "0.001"),
        ("um / nm", "ratio", "1000"),
        ("um/um^2", "inverse length", "1"),
        ("nm/um**2", "inverse length", "0.001"),
        ("nm/nm²", "inverse length", "1000"),
        ("um/mm2", "inverse length", "0.000001"),
    ],
)
def test_a_length_over_a_length_is_a_unit(name: str, dimension: str, size: str) -> None:
    assert find_unit(name) == Unit(dimension, Decimal(size))
    for other in ("um/s", "s/um", "um/", "um/um^3", "um/um/um", "furlong/um"):
        assert find_unit(other) is None


OTHERS = "s ms us µs Hz kHz MHz GHz rad mrad deg kg g K V W J eV N Pa A %"


@pytest.mark.parametrize("unit", OTHERS.split())
def test_a_unit_of_something_else_is_said_to_be_none_of_length(unit: str) -> None:
    with pytest.raises(ValueError, match="is not a unit of length; write it with its") as said:
        parse_length(f"5 {unit}")
    assert str(said.value).startswith(f"'{unit}' ")


@pytest.mark.parametrize(
    ("text", "nearest"),
    [("5 UM", "um"), ("5 Micron", "micron"), ("5 nanometr", "nanometre"), ("5 nm,", "nm")],
)
def test_the_nearest_unit_is_named_where_one_is_close(text: str, nearest: str) -> None:
    with pytest.raises(ValueError, match="is not a unit that is known; did you mean ") as said:
        parse_length(text)
    assert f"did you mean '{nearest}'? " in str(said.value).replace("?;", "? ")


NONE = ["5 m m", "nm", "five nm", "51/um", "1_0 um", "5 6 um", "", "5e um"]


@pytest.mark.parametrize("text", NONE)
def test_what_is_no_number_with_a_unit_is_no_length(text: str) -> None:
    with pytest.raises(ValueError, match=r"^not a length; "):
        parse_length(text)


def test_an_angstrom_has_two_signs_and_a_name() -> None:
    assert parse_length("+.5e1 \u212b") == parse_length("5. \u00c5") == 5e-4
    assert parse_length("5 ångström") == 5e-4


@pytest.mark.parametrize("unit", ["1/um", "/cm", "um-1"])
def test_an_inverse_length_for_a_length_is_called_what_it_is(unit: str) -> None:
    with pytest.raises(ValueError, match="is an inverse length; give a length, as 5 nm"):
        parse_length(f"5 {unit}")


def test_a_decimal_comma_is_named() -> None:
    with pytest.raises(ValueError, match=r"write it with a point, as 1\.4 um"):
        parse_length("1,4 um")
