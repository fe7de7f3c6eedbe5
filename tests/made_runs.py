"""Small runs, made in memory and written to a folder."""

from pathlib import Path

import octsim
from octsim.datasets.files import write

TINY = {
    "run": "tiny",
    "tracing": {"rays": 200},
    "focus_scan": {"focus": {"num": 5}},
    "spectrum": {"samples": 64},
    "sweep": {"diameters": {"num": 9}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
}


def make(folder: Path, *overlays: dict[str, object], scan: bool = True) -> octsim.Config:
    config = octsim.load_config(TINY, *overlays)
    if scan:
        write(octsim.focus_scan(config), folder / "focus_scan.nc")
        return config
    spectra = octsim.spectra(config, octsim.detections(config))
    write(spectra, folder / "spectra.nc")
    write(octsim.phase_slope(config, octsim.fourier(config, spectra)), folder / "phase_slope.nc")
    return config
