"""The public names, in a fresh interpreter: all there, and light until one of them is used."""

import json
import subprocess
import sys
from typing import Any

PUBLIC = [
    "ArchiveError", "CacheError", "Config", "ConfigError", "DatasetError", "FileError",
    "OctsimError", "OctsimWarning", "action_potential", "calibration", "combinations", "compare",
    "detections", "expansion", "fields", "focus_law", "focus_scan", "focus_sweep", "fourier",
    "gaussian_fits", "light_paths", "load_config", "phase_of", "phase_slope",
    "ray_focus_sweep", "read", "read_series", "read_spectra", "run", "series_expansion",
    "spectra",
]  # fmt: skip
COMPUTING = {"numpy", "scipy", "numba", "xarray", "netCDF4", "matplotlib", "pandas"}


def fresh(code: str) -> Any:
    """Return what a fresh interpreter has as ``found`` once it has run the code."""
    lines = f"import json, sys, octsim\n{code}\nprint(json.dumps(found))"
    done = subprocess.run([sys.executable, "-c", lines], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def test_the_public_names_are_these_and_no_others() -> None:
    assert fresh("found = sorted(octsim.__all__)") == PUBLIC
    assert set(PUBLIC) <= set(fresh("found = dir(octsim)"))


def test_every_public_name_can_be_got_and_says_what_it_is() -> None:
    got = fresh("found = {name: getattr(octsim, name).__doc__ for name in octsim.__all__}")
    assert sorted(got) == PUBLIC
    assert all(got.values())


def test_the_package_is_imported_without_what_computes() -> None:
    assert not COMPUTING & set(fresh("found = list(sys.modules)"))


def test_a_config_is_loaded_without_what_computes() -> None:
    assert not COMPUTING & set(fresh("octsim.load_config()\nfound = list(sys.modules)"))
