"""What all tests share."""

import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import xarray as xr
from checkout import Finished, finished_in
from hypothesis import settings
from made_once import Once
from made_runs import BY_RAYS, CALIBRATED, SWEEP, WHOLE, as_calibrated, every_stage

import octsim
from octsim.base.code_folder import places
from octsim.config.load import load_config
from octsim.studies.calibration.study import calibration

# The same draws every time: a failure on a contributor's machine is a failure on every machine.
settings.register_profile("octsim", derandomize=True, deadline=None)
settings.load_profile("octsim")
ROOT = Path(__file__).parent.parent
# where a shell began the suite with `&`, or nohup, processes would ignore what tests send them
for number, handler in (
    (signal.SIGINT, signal.default_int_handler),
    (signal.SIGHUP, signal.SIG_DFL),
):
    if signal.getsignal(number) is signal.SIG_IGN:
        signal.signal(number, handler)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the rooms whose modules take longest, so that none is left at the end alone."""
    items.sort(key=lambda item: item.path.parent.name not in {"workflow", "cli"})


@pytest.fixture
def planned(tmp_path: Path) -> Callable[..., str]:
    """Tell what snakemake would do for some targets, in an empty folder."""

    def planned(*targets: str) -> str:
        snakemake = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile")]
        done = subprocess.run(
            [*snakemake, *targets, "--dry-run", "--cores", "1"],
            cwd=tmp_path, capture_output=True, text=True, check=True,
        )  # fmt: skip
        return done.stdout + done.stderr

    return planned


@pytest.fixture
def compiled(tmp_path: Path) -> Path:
    """Give a folder for compiled code, with what is there: a copy of the package has the same."""
    folder = tmp_path / "compiled"
    folder.mkdir()
    for one in places()[0].glob("numba-*"):
        (folder / one.name).symlink_to(one)
    return folder


@pytest.fixture(scope="session")
def once(tmp_path_factory: pytest.TempPathFactory, worker_id: str) -> Once:
    """Give what makes a thing in one worker for all."""
    own = tmp_path_factory.getbasetemp()
    return Once(own if worker_id == "master" else own.parent)


@pytest.fixture(scope="session")
def stages(once: Once) -> dict[str, xr.Dataset]:
    """Make every dataset of a small run, once: no test changes them in place."""
    return once.made("stages", lambda _: every_stage(load_config(WHOLE), 2))


@pytest.fixture(scope="session")
def spectra(once: Once) -> xr.Dataset:
    """Make the spectra of an accurate sweep, once: no test changes them in place."""
    return once.made("spectra", lambda _: octsim.spectra(SWEEP, octsim.detections(SWEEP)))


@pytest.fixture(scope="session")
def finished(once: Once) -> Finished:
    """Give the folder of a whole run by snakemake; tests change copies of it."""
    return once.made("finished", finished_in)


@pytest.fixture(scope="session")
def calibrated(once: Once) -> xr.Dataset:
    """Calibrate the thesis's instrument at a few diameters, focused by a given law."""
    with as_calibrated():
        return once.made("calibrated", lambda _: calibration(load_config(CALIBRATED), None, 2))


@pytest.fixture(scope="session")
def calibrated_by_rays(once: Once) -> xr.Dataset:
    """Calibrate it by light paths with every parameter, over more diameters."""
    return once.made("calibrated_by_rays", lambda _: calibration(load_config(BY_RAYS), None, 2))
