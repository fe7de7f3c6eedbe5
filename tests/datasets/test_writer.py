"""Files that are written part by part."""

from pathlib import Path

import pytest
import xarray as xr
from gridded import GRIDS, run_of_grid

import octsim
from octsim.datasets.writer import write_stream


@pytest.mark.parametrize("name", GRIDS)
def test_a_file_holds_what_memory_does(name: str, tmp_path: Path) -> None:
    config, held = run_of_grid(name)
    streams = {
        "detections": octsim.detections.stream(config, held["focus_law"]),
        "spectra": octsim.spectra.stream(config, held["detections"], fields=held.get("fields")),
        "fourier": octsim.fourier.stream(config, held["spectra"]),
    }
    for stage, stream in streams.items():
        write_stream(stream, tmp_path / f"{stage}.nc")
        with xr.open_dataset(tmp_path / f"{stage}.nc") as stored:
            xr.testing.assert_identical(stored.load(), held[stage])
