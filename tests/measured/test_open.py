"""The same spectra are read of every kind of file."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from recordings import COUNTS, KINDS, MS, NM, K

from octsim.config.units import find_unit
from octsim.measured.open import opened_recording
from octsim.measured.recording import Values


def in_unit(values: Values, size: float) -> NDArray[np.float64]:
    unit = find_unit(values.unit)
    assert unit is not None
    return values.values * float(unit.size) / size


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_of_each_kind_holds_the_same_spectra(kind: str, tmp_path: Path) -> None:
    write, has = KINDS[kind]
    path = tmp_path / "recording"
    write(path)
    counts = COUNTS[: has.spectra, :: -1 if has.reverse else 1]
    with opened_recording(path, **has.asked) as found:
        assert found.counts.shape == (has.spectra, K)
        assert found.counts.dtype == np.dtype(np.uint16 if has.whole else np.float64)
        np.testing.assert_array_equal(found.counts[:], counts)
        np.testing.assert_array_equal(found.counts[2:5], counts[2:5])
        assert found.counts[:1].flags.writeable
        assert (found.axis is not None, found.time is not None) == (has.axis, has.time)
        if found.axis is not None:
            assert found.axis.name == "wavelength"
            nm = NM[:: -1 if has.reverse else 1]
            np.testing.assert_allclose(in_unit(found.axis, 1e-3), nm, rtol=1e-5)
        if found.time is not None:
            np.testing.assert_allclose(in_unit(found.time, 1e-3), MS, rtol=1e-9, atol=1e-9)
        assert str(path) in found.name
        assert all(found.understood)
        assert "\n" not in "".join(found.understood)
