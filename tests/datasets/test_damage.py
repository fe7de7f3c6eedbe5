"""One flipped bit of a dataset is found by whoever reads it, in one line."""

import random
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr
from made_runs import WHOLE

import octsim
from octsim.archive.compare import compare
from octsim.archive.pack import pack
from octsim.base.errors import UncheckedWarning
from octsim.base.file_digest import add_digest, is_as_written
from octsim.cli.main import main
from octsim.datasets.catalog import CATALOG
from octsim.datasets.files import opened, read, write
from octsim.datasets.writer import write_stream
from octsim.stages.job import Job, perform

DIGEST = 81
"""Bytes of the line at a file's end."""
TRIALS = 240
CONFIG = octsim.load_config(WHOLE)


@pytest.fixture
def run(stages: dict[str, xr.Dataset], tmp_path: Path) -> Path:
    """Write a small run, as its jobs write it."""
    folder = tmp_path / "whole"
    streamed = {
        "spectra": lambda: octsim.spectra.stream(CONFIG, stages["detections"]),
        "fourier": lambda: octsim.fourier.stream(CONFIG, stages["spectra"]),
    }
    for name, dataset in stages.items():
        if name in streamed:
            write_stream(streamed[name](), folder / f"{name}.nc")
        else:
            write(dataset, folder / f"{name}.nc")
    return folder


def flip(file: Path, bit: int) -> None:
    held = bytearray(file.read_bytes())
    held[bit // 8] ^= 1 << bit % 8
    file.write_bytes(held)


def read_or_refused(file: Path) -> tuple[xr.Dataset | None, str]:
    try:
        return read(file), ""
    except octsim.DatasetError as error:
        return None, str(error)


def test_of_240_flipped_bits_each_is_found_or_all_reads_equal(run: Path) -> None:
    draw, found = random.Random(18), 0
    files = sorted(run.glob("*.nc"))
    before = {file: read(file) for file in files}
    for _ in range(TRIALS):
        file = draw.choice(files)
        bit = draw.randrange(8 * file.stat().st_size)
        flip(file, bit)
        after, said = read_or_refused(file)
        if after is None:
            found += 1
            assert said.startswith(f"{file}: can't be read (it is damaged")
            assert "\n" not in said
        else:
            xr.testing.assert_identical(after, before[file])
            for name, variable in after.variables.items():
                assert variable.dtype == before[file].variables[name].dtype
        flip(file, bit)
        assert is_as_written(file)
    assert found >= TRIALS - 5, "all but what is flipped in the digest's own mark"


def test_each_bit_of_a_small_dataset_is_found(tmp_path: Path) -> None:
    file = tmp_path / "spectra.nc"
    xr.Dataset({"intensity": ("diameter", np.arange(40.0))}).to_netcdf(file, engine="netcdf4")
    add_digest(file)
    whole = file.read_bytes()
    end = len(whole) - DIGEST
    for bit in (*range(0, 8 * end, 97), 8 * end - 1):
        flip(file, bit)
        assert is_as_written(file) is False, bit
        file.write_bytes(whole)
    assert is_as_written(file)
    for other in (whole[:end] + b"\0" + whole[end:], whole[: end - 1] + whole[end:]):
        file.write_bytes(other)
        assert is_as_written(file) is False, "bytes that are added or left out"


@pytest.mark.parametrize("size", [0, 1, 7, 8, 4095, 4096, 131072, 131073, 300001])
def test_a_digest_is_of_every_byte_whatever_the_size(size: int, tmp_path: Path) -> None:
    file = tmp_path / "bytes"
    file.write_bytes(np.random.default_rng(size).bytes(size))
    assert is_as_written(file) is None
    add_digest(file)
    assert is_as_written(file) is True
    for place in {0, size // 2, size - 1} if size else ():
        flip(file, 8 * place)
        assert is_as_written(file) is False
        flip(file, 8 * place)


def test_parts_that_change_places_are_found(tmp_path: Path) -> None:
    file = tmp_path / "bytes"
    held = np.random.default_rng(1).bytes(16384)
    file.write_bytes(held)
    add_digest(file)
    written = file.read_bytes()
    file.write_bytes(held[4096:8192] + held[:4096] + written[8192:])
    assert is_as_written(file) is False


def test_who_reads_a_damaged_dataset_refuses_it_in_a_line(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    slope = read(run / "phase_slope.nc")
    file = run / "spectra.nc"
    flip(file, 8 * (file.stat().st_size // 2))
    said = r"^[^\n]*spectra\.nc: can't be read \(it is damaged: [^\n]*$"
    job = Job((CATALOG["fourier"],), {"spectra": file}, {"fourier": tmp_path / "fourier.nc"})
    for who in (
        lambda: read(file),
        lambda: opened(file).__enter__(),
        lambda: perform(job, CONFIG),
        lambda: compare(run, run),
        lambda: compare(file, file),
        lambda: pack(run, CONFIG, tmp_path / "a.zip"),
    ):
        with pytest.raises(octsim.DatasetError, match=said):
            who()
    assert not (tmp_path / "fourier.nc").exists()
    assert not (tmp_path / "a.zip").exists()
    capsys.readouterr()
    assert main(["compare", str(run), str(run), "--no-figure"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"octsim: {file}: can't be read (it is damaged")
    xr.testing.assert_identical(read(run / "phase_slope.nc"), slope)  # those beside it are read


def test_verify_looks_at_a_run_and_at_a_dataset(
    run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    count = len(list(run.glob("*.nc")))
    assert main(["verify", str(run)]) == 0
    assert capsys.readouterr().out == f"{run}: as it was written, {count} datasets\n"
    assert main(["verify", str(run / "spectra.nc")]) == 0
    assert capsys.readouterr().out == f"{run / 'spectra.nc'}: as it was written\n"
    flip(run / "spectra.nc", 8000)
    flip(run / "detections.nc", 9000)
    assert main(["verify", str(run)]) == 1
    shown = capsys.readouterr()
    assert shown.out == ""
    first, second = shown.err.splitlines()
    assert first.startswith(f"octsim: {run / 'detections.nc'}: damaged: its bytes are not those")
    assert second.startswith(f"octsim: {run / 'spectra.nc'}: damaged: its bytes are not those")


def without_digest(file: Path) -> None:
    file.write_bytes(file.read_bytes()[:-DIGEST])


def test_a_dataset_without_a_digest_is_read_with_a_word(
    run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = read(run / "spectra.nc")
    for name in ("spectra", "fourier"):
        without_digest(run / f"{name}.nc")
    said = rf"^{run}: has datasets without a digest .* damage can't be seen; run again to make them"
    with pytest.warns(UncheckedWarning, match=said) as warned:
        xr.testing.assert_identical(read(run / "spectra.nc"), before)
    assert len(warned) == 1
    assert main(["verify", str(run)]) == 0
    shown = capsys.readouterr()
    assert shown.out.endswith("datasets\n")
    (line,) = shown.err.splitlines()
    assert line.startswith(f"octsim: warning: {run}: not known of fourier.nc, spectra.nc, without")
    assert main(["verify", str(run / "spectra.nc")]) == 2, "of which nothing is known"


@pytest.mark.filterwarnings("default::octsim.base.errors.OctsimWarning")
def test_a_command_says_once_of_a_folder_that_damage_is_not_seen(
    run: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for file in run.glob("*.nc"):
        without_digest(file)
    assert main(["compare", str(run), str(run), "--no-figure"]) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"octsim: warning: {run}: has datasets without a digest of their bytes")


def test_what_another_program_changes_in_its_place_has_no_digest(run: Path) -> None:
    with netCDF4.Dataset(run / "spectra.nc", "a") as file:
        file.setncattr("note", "mine")
    with pytest.warns(UncheckedWarning):
        assert read(run / "spectra.nc").attrs["note"] == "mine"


def test_other_programs_read_a_dataset_with_its_digest(run: Path) -> None:
    h5py = pytest.importorskip("h5py")
    expected = read(run / "spectra.nc")
    with xr.open_dataset(run / "spectra.nc") as found:
        xr.testing.assert_identical(found.load(), expected)
    with h5py.File(run / "spectra.nc") as file:
        assert np.array_equal(file["intensity"][:], expected["intensity"])
