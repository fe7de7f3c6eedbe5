"""Measure what Maxwell's equations cost beside counted rays, for `make bench`."""

import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import octsim
from octsim.config.derive import by_waves, counting_rays
from octsim.config.models import Config
from octsim.instrument.instrument import Instrument

DIAMETERS = (1.0, 1.5, 2.0)
BAR_OF_A_POINT, BAR_OF_A_SCAN, BAR_OF_ALL = 40, 12, 60


def of_a_point(rounds: int) -> dict[float, float]:
    """Measure a point at each diameter (µm): processor time by waves over that by 3000 rays.

    Nothing is kept from point to point.
    """
    config = octsim.load_config()
    waves, rays = by_waves(config), counting_rays(config)
    return {
        diameter: statistics.median(
            _processor_time(lambda d=diameter: _alone(waves, d))
            / _processor_time(lambda d=diameter: _alone(rays, d))
            for _ in range(rounds)
        )
        for diameter in DIAMETERS
    }


def of_a_scan() -> float:
    """Measure the scan of foci through one neuron (figure 6) by waves: processor time, s."""
    config = by_waves(octsim.load_config())
    instrument, scan = Instrument(config), config.focus_scan
    foci = scan.focus.values().tolist()
    return _processor_time(lambda: [instrument.spectrum(scan.diameter, z) for z in foci])


def of_the_pipeline(folder: Path) -> float:
    """Measure all of the thesis's results by preset exact in a copy of the workflow, s."""
    shutil.rmtree(folder / ".octsim", ignore_errors=True)
    with tempfile.NamedTemporaryFile("w", suffix=".yaml", dir=folder) as chosen:
        chosen.write("tracing: {preset: exact}\n")
        chosen.flush()
        began = time.perf_counter()
        subprocess.run(
            [
                sys.executable, "-m", "snakemake", "--cores", "2", "--configfile", chosen.name,
                "--config", "run=exact",
            ],
            cwd=folder, check=True, capture_output=True,
        )  # fmt: skip
        return time.perf_counter() - began


def _alone(config: Config, diameter: float) -> object:
    return Instrument(config).spectrum(diameter, 0.581 * diameter + 0.069)


def _processor_time(work: Callable[[], object]) -> float:
    """Time a work, in seconds of all of this process's threads."""
    began = time.process_time()
    work()
    return time.process_time() - began
