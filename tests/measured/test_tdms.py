"""Channels of LabVIEW are spectra, one each or one after the other."""

from pathlib import Path

import numpy as np
import pytest
from recordings import COUNTS, MS, NM, K, T, write_tdms

from octsim.measured.open import opened_recording

pytest.importorskip("nptdms")


def test_channels_may_be_of_samples(tmp_path: Path) -> None:
    pixels = [("camera", f"pixel {at}", COUNTS[:, at].copy()) for at in range(K)]
    write_tdms(tmp_path / "a", *pixels)
    with opened_recording(tmp_path / "a", samples=K) as found:
        np.testing.assert_array_equal(found.counts[3:6], COUNTS[3:6])
    with opened_recording(tmp_path / "a", samples=T) as found:
        np.testing.assert_array_equal(found.counts[3:6], COUNTS.T[3:6])


def test_channels_are_spectra_if_nothing_else_tells(tmp_path: Path) -> None:
    write_tdms(
        tmp_path / "a", *(("camera", f"{at}s", row) for at, row in zip(MS, COUNTS, strict=True))
    )
    with opened_recording(tmp_path / "a") as found:
        np.testing.assert_array_equal(found.counts[:], COUNTS)
        assert found.time is not None
        assert (found.time.values.tolist(), found.time.unit) == (MS.tolist(), "s")
        assert found.understood[-1] == "headings are times in s: 0 to 1.375"


def test_channels_of_other_names_say_nothing_of_times(tmp_path: Path) -> None:
    write_tdms(tmp_path / "a", *(("camera", f"line {at}", row) for at, row in enumerate(COUNTS)))
    with opened_recording(tmp_path / "a") as found:
        assert found.time is None
        assert all(found.understood)
        assert not any("times" in line for line in found.understood)


def test_an_index_beside_a_file_is_not_read(tmp_path: Path) -> None:
    write_tdms(tmp_path / "b.tdms", ("other", "stream", NM))
    write_tdms(tmp_path / "a.tdms", ("camera", "stream", COUNTS.ravel()))
    (tmp_path / "a.tdms_index").write_bytes((tmp_path / "b.tdms").read_bytes())
    with opened_recording(tmp_path / "a.tdms", samples=K) as found:
        np.testing.assert_array_equal(found.counts[:], COUNTS)


def test_a_channel_in_segments_is_one(tmp_path: Path) -> None:
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(tmp_path / "a") as writer:
        for part in np.split(COUNTS.ravel(), [7, 90, 333]):
            writer.write_segment([ChannelObject("camera", "stream", part)])
    with opened_recording(tmp_path / "a", samples=K) as found:
        assert found.counts.dtype == np.uint16
        np.testing.assert_array_equal(found.counts[:], COUNTS)
        np.testing.assert_array_equal(found.counts[1:4], COUNTS[1:4])
