"""A process of octsim's own goes without what a user's environment holds for other programs."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from octsim.base.carried import PACKAGE
from octsim.base.surroundings import settled

SETTLED = "from octsim.base.surroundings import settle; settle(); "


def said(code: str, cwd: Path, *options: str, **environment: str) -> str:
    done = subprocess.run(
        [sys.executable, *options, "-c", code], cwd=cwd, env=os.environ | environment,
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return done.stdout + done.stderr


def foreign(folder: Path, *modules: str) -> str:
    folder.mkdir(exist_ok=True)
    for name in modules:
        (folder / f"{name}.py").write_text(f"raise ImportError('{name} of the cluster')\n")
    return str(folder)


def test_libraries_installed_come_before_those_of_the_user(tmp_path: Path) -> None:
    path = foreign(tmp_path / "cluster", "scipy", "xarray")
    (tmp_path / "cluster" / "alone.py").write_text("print('found')\n")
    foreign(tmp_path, "scipy", "numba")
    code = "import scipy, xarray, numba, alone; print(scipy.__file__)"
    shown = said(SETTLED + code, tmp_path, PYTHONPATH=path)
    assert str(tmp_path) not in shown
    assert "found" in shown
    # and so do the processes that it starts
    child = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {code!r}], check=True)"
    assert "found" in said(SETTLED + child, tmp_path, PYTHONPATH=path)


def test_the_package_stays_the_one_that_is_loaded(tmp_path: Path) -> None:
    copy = tmp_path / "copy" / "octsim"
    copy.mkdir(parents=True)
    for part in ("__init__.py", "__init__.pyi"):
        (copy / part).write_text((PACKAGE / part).read_text())
    (copy / "base").symlink_to(PACKAGE / "base")
    child = "import octsim; print(octsim.__file__)"
    code = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {child!r}], check=True)"
    shown = said(SETTLED + code, tmp_path, PYTHONPATH=str(copy.parent))
    assert shown.strip() == str(copy / "__init__.py")


def test_warnings_are_no_errors_and_any_text_can_be_said(tmp_path: Path) -> None:
    code = "import warnings; warnings.warn('seen'); print('Ångström')"
    shown = said(SETTLED + code, tmp_path, PYTHONWARNINGS="error", PYTHONIOENCODING="ascii")
    assert "UserWarning: seen" in shown
    assert r"\xc5ngstr\xf6m" in shown


def test_variables_of_other_programs_are_left_out() -> None:
    given = {
        "PATH": "/bin", "MPLBACKEND": "TkAgg", "MATPLOTLIBRC": "/mine", "PYTHONOPTIMIZE": "2",
        "PYTHONWARNINGS": "error", "PYTHONHOME": "/other", "PYTHONDONTWRITEBYTECODE": "1",
    }  # fmt: skip
    assert settled(given) | {"PYTHONPATH": ""} == {
        "PATH": "/bin", "MPLBACKEND": "agg", "MATPLOTLIBRC": os.devnull, "PYTHONPATH": "",
        "PYTHONDONTWRITEBYTECODE": "1", "PYTHONSAFEPATH": "1", "PYTHONUTF8": "1",
    }  # fmt: skip


@pytest.mark.parametrize("backend", ["nonsense", "TkAgg", "module://not_installed"])
def test_figures_load_whatever_the_backend(backend: str, tmp_path: Path) -> None:
    code = "import os, octsim.figures.style; print(os.environ['MPLBACKEND'])"
    assert said(code, tmp_path, MPLBACKEND=backend).strip() == backend


def test_a_matplotlibrc_that_is_no_text_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "matplotlibrc").write_bytes(b"\xff\xfe\xb9")
    code = "import octsim.base.errors\ntry: import octsim.figures.style\n"
    code += "except octsim.base.errors.OctsimError as error: print(error)"
    assert "matplotlibrc: is no text (" in said(code, tmp_path)


def test_threads_and_switches_of_numba_are_those_of_others() -> None:
    theirs = {"NUMBA_NUM_THREADS": "0", "NUMBA_ENABLE_AVX": "0", "NUMBA_BOUNDSCHECK": "1"}
    ours = {"NUMBA_CACHE_DIR": "/caches", "NUMBA_CPU_NAME": "x86-64", "NUMBA_OPT": "1"}
    found = settled(theirs | ours)
    assert {name: found.get(name) for name in theirs | ours} == dict.fromkeys(theirs) | ours
