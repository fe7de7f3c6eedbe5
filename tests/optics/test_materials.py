"""Materials: indices that are known, their exact derivatives, and tables between their rows."""

from math import isnan, pi

import numpy as np
import pytest

from octsim.optics.materials import (
    Cauchy,
    Constant,
    Material,
    Sellmeier,
    Table,
    group_index,
    rows_within,
)
from octsim.optics.shipped_materials import SHIPPED
from octsim.optics.two_beams import aliasing_step, ideal_spectra, indices, predicted_phase_slope

WATER = SHIPPED["water"].material
BAND = np.linspace(2 * pi / 0.9, 2 * pi / 0.65, 101)


def table(step: float, first: float = 0.6, last: float = 0.95, kappa: bool = False) -> Table:
    """Return a table of water's indices, wavelengths in µm."""
    wavelengths = np.arange(first, last + step / 2, step).tolist()
    n = tuple(WATER.index(2 * pi / wavelength).real for wavelength in wavelengths)
    return Table(tuple(wavelengths), n, tuple(0.01 * w for w in wavelengths) if kappa else ())


MATERIALS: dict[str, Material] = {
    **{name: shipped.material for name, shipped in SHIPPED.items()},
    "constant": Constant(1.39),
    "table": table(0.05),
    "two rows": Table((0.6, 1.0), (1.4, 1.38)),
    "three rows": Table((0.6, 0.7, 1.0), (1.4, 1.39, 1.38)),
}


@pytest.mark.parametrize(
    ("name", "wavelength", "n"),
    [
        # Schott's data sheet: n_d, n_F' and n_C'
        ("N-BK7", 0.5875618, 1.51680),
        ("N-BK7", 0.4799914, 1.52283),
        ("N-BK7", 0.6438469, 1.51472),
        # 1.33299 relative to air, sodium light, 20 °C, is 1.33335 relative to vacuum
        ("water", 0.5893, 1.33335),
        ("cytoplasm", 0.755, 1.38889),
    ],
)
def test_indices_are_the_known_ones(name: str, wavelength: float, n: float) -> None:
    assert SHIPPED[name].material.index(2 * pi / wavelength) == pytest.approx(n, abs=1e-5)


def test_shipped_materials_say_what_they_are_relative_to() -> None:
    assert {name: shipped.reference for name, shipped in SHIPPED.items()} == {
        "water": "vacuum", "N-BK7": "air", "cytoplasm": "vacuum",
    }  # fmt: skip
    assert "4e-4" in SHIPPED["N-BK7"].origin
    assert "not measured" in SHIPPED["cytoplasm"].origin
    assert all(name == shipped.name for name, shipped in SHIPPED.items())


@pytest.mark.parametrize("name", MATERIALS)
def test_slope_and_group_index_are_the_derivatives(name: str) -> None:
    material, step = MATERIALS[name], 1e-4
    for k in BAND[1:-1].tolist():
        below, above = (material.index(k + off).real for off in (-step, step))
        assert material.slope(k) == pytest.approx((above - below) / (2 * step), abs=1e-9)
        group = (above * (k + step) - below * (k - step)) / (2 * step)
        assert group_index(material, k) == pytest.approx(group, abs=2e-8)


def test_a_constant_is_exactly_one_number() -> None:
    constant = Constant(1.39)
    assert (constant.index(7.0), group_index(constant, 7.0)) == (1.39, 1.39)
    assert [one.dispersive for one in (constant, Cauchy((1.4,)), WATER)] == [False, True, True]
    assert constant == Constant(1.39)
    assert len({constant, Constant(1.39), table(0.05), table(0.05)}) == 2


def test_a_table_every_50_nm_is_within_3e_7_of_water() -> None:
    off = [abs(table(0.05).index(k) - WATER.index(k)) for k in BAND.tolist()]
    assert max(off) < 3.1e-7


def test_two_rows_are_a_line_and_three_a_parabola() -> None:
    assert MATERIALS["two rows"].index(2 * pi / 0.7).real == pytest.approx(1.395, abs=1e-12)
    rows = (0.6, 0.7, 1.0)
    parabola = Table(rows, tuple(1.5 - 0.1 * w + 0.05 * w**2 for w in rows))
    assert parabola.index(2 * pi / 0.9).real == pytest.approx(1.5 - 0.09 + 0.0405, abs=1e-12)


def test_absorption_goes_no_way_that_its_rows_do_not() -> None:
    steep = Table((0.6, 0.7, 0.8, 0.9), (1.3,) * 4, (0.0, 0.0, 1e-3, 1e-3))
    kappas = [steep.index(k).imag for k in np.linspace(2 * pi / 0.9, 2 * pi / 0.6, 99).tolist()]
    assert 0.0 <= min(kappas) <= max(kappas) <= 1e-3
    assert table(0.05, kappa=True).index(2 * pi / 0.7).imag == pytest.approx(0.007)
    assert table(0.05).index(2 * pi / 0.7).imag == 0.0


def test_a_table_is_refused_outside_and_not_at_its_ends() -> None:
    rows = table(0.05, 0.65, 0.9)
    for k in (2 * pi / 0.65, 2 * pi / 0.9):
        assert rows.index(k) == pytest.approx(WATER.index(k), abs=1e-12)
    for wavelength in (0.6499, 0.9001):
        with pytest.raises(ValueError, match=r"wavelengths from 0\.65 to 0\.9 um, and 0\."):
            rows.index(2 * pi / wavelength)
        with pytest.raises(ValueError, match="is asked for"):
            rows.slope(2 * pi / wavelength)


def test_a_resonance_has_no_index() -> None:
    resonant = Sellmeier((0.5,), (0.25,))
    assert isnan(resonant.index(2 * pi / 0.5).real)
    assert isnan(resonant.index(2 * pi / 0.49).real)  # n² is negative below it
    assert resonant.index(2 * pi / 0.6).real > 1


def test_the_prediction_is_that_of_the_ends_of_the_band() -> None:
    k_min, k_max = float(BAND[0]), float(BAND[-1])
    for neuron in (1.39, Constant(1.39)):
        assert predicted_phase_slope(neuron, k_min, k_max) == 1.39 * (k_min + k_max)
        assert (ideal_spectra(neuron, BAND, BAND) == ideal_spectra(1.39, BAND, BAND)).all()
    cytoplasm = SHIPPED["cytoplasm"].material
    expected = cytoplasm.index(k_min).real * k_min + cytoplasm.index(k_max).real * k_max
    assert predicted_phase_slope(cytoplasm, k_min, k_max) == expected
    assert aliasing_step(cytoplasm, k_min, k_max) == pi / expected


def test_ideal_spectra_have_the_index_of_each_wavenumber() -> None:
    neuron, diameter = SHIPPED["cytoplasm"].material, np.array([1.0, 1.4])
    n = indices(neuron, BAND)
    assert n == pytest.approx([neuron.index(k).real for k in BAND.tolist()])
    expected = np.cos(2 * diameter[:, np.newaxis] * n * BAND)
    np.testing.assert_allclose(ideal_spectra(neuron, diameter, BAND), expected, atol=1e-12)


def test_rows_of_a_table_count_between_two_wavenumbers_and_not_at_their_ends() -> None:
    rows = 0.6, 0.7, 0.8, 0.9
    some = Table(rows, (1.3,) * 4)
    between = [2 * pi / one for one in (0.85, 0.75, 0.65)]
    assert rows_within(some, between[0], between[2]) == 2
    assert rows_within(some, between[1], between[2]) == 1
    assert rows_within(some, 2 * pi / 0.8, between[2]) == 1
    assert rows_within(some, between[0], 2 * pi / 0.7) == 1
    assert rows_within(some, 1.0, 20.0) == 4
    assert rows_within(WATER, 1.0, 20.0) == rows_within(Constant(1.3), 1.0, 20.0) == 0
