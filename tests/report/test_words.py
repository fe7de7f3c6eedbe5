"""Numbers as a reader expects them."""

from math import inf, nan

import pytest

from octsim.report.words import command, share, signed, with_error


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (23.2191, 0.2203, "23.22 ± 0.22"), (23.2191, 0.00312, "23.2191 ± 0.0031"),
        (-23.2191, 1.26, "−23.2 ± 1.3"), (1234.5, 67.8, "1234 ± 68"), (23.2191, 0.0, "23.219 ± 0"),
        (23.2191, nan, "23.219 ± not known"), (nan, nan, "not known ± not known"),
        (1.0, inf, "1.000 ± not known"),
    ],
)  # fmt: skip
def test_an_error_has_two_digits_and_its_number_as_many_places(
    value: float, error: float, text: str
) -> None:
    assert with_error(value, error) == text


def test_what_is_not_known_is_said() -> None:
    assert [signed(nan), share(nan), signed(-0.5), share(0.0123)] == [
        "not known", "not known", "−0.500", "1.2 %",
    ]  # fmt: skip


def test_a_command_names_its_target() -> None:
    assert command("effects") == "snakemake effects --cores 2 --configfile config.yaml"
    assert command("") == "snakemake --cores 2 --configfile config.yaml"
