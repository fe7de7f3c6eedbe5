"""What made a dataset: a digest of its sources, and the environment that they ran in."""

import hashlib
import platform
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path

from octsim.base.carried import PACKAGE
from octsim.base.kept_syntax import KeptSyntax

_COMPUTE = ("numpy", "scipy", "numba", "llvmlite", "xarray", "netCDF4")
LOCK = "requirements.lock"
"""Pinned versions of what octsim needs, in a checkout."""


def lock_file() -> Path | None:
    """Return the pinned versions, where the package stands in a checkout of octsim."""
    checkout = PACKAGE.parent
    file = checkout / LOCK
    return file if file.is_file() and (checkout / "pyproject.toml").is_file() else None


@cache
def environment() -> Mapping[str, str]:
    """Return the version of Python and of each library that the last bits of a result may hang on.

    Returns
    -------
    mapping
        Version by name; ``system`` and ``processor`` are those that numba compiles for.
    """
    # what traces nothing and writes nothing has no use for these
    import llvmlite.binding
    import netCDF4

    return {
        "python": platform.python_version(),
        **{name: version(name) for name in _COMPUTE},
        "netcdf-c": str(netCDF4.__netcdf4libversion__),
        "hdf5": str(netCDF4.__hdf5libversion__),
        "system": f"{platform.system()} {platform.machine()}",
        "processor": str(llvmlite.binding.get_host_cpu_name()),
    }


def source_digest(*sources: str | Path, without: Iterable[str] = ()) -> str:
    """Digest Python sources and all that they import of this package and of their own folder.

    A package that is imported, or passed on the way to a module, counts with its `__init__`, and a
    name that is imported from a package counts as the module of that name where there is one.
    Comments, docstrings, formatting and imports for the type checker alone do not change the
    digest; a changed constant does.

    Parameters
    ----------
    *sources : str or path
        Name of a module or package of this package (``"octsim.stages.spectra"``) or path of a file.
    without : iterable of str
        Modules or packages that are left out, and what only they import.

    Returns
    -------
    str
        Twelve hexadecimal digits of a SHA-256.
    """
    left_out = [f"{name}." for name in without]
    waiting = [path for source in sources for path in _files(source)]
    said: dict[Path, str] = {}
    while waiting:
        path = waiting.pop()
        own = f"{'.'.join(_module(path))}."
        if path in said or any(own.startswith(name) for name in left_out):
            continue
        said[path], imported = _said(path)
        waiting.extend(imported)
    _kept().keep()
    digest = hashlib.sha256()
    for name, path in sorted((_name_of(path), path) for path in said):
        digest.update(f"{name}\n{said[path]}\n".encode())
    return digest.hexdigest()[:12]


def _files(source: str | Path) -> tuple[Path, ...]:
    return (source,) if isinstance(source, Path) else _modules(source)


@cache
def _module(path: Path) -> tuple[str, ...]:
    """Return the name of the module that a file of this package is, part by part."""
    inside = PACKAGE in path.parents
    return path.relative_to(PACKAGE.parent).with_suffix("").parts if inside else ()


@cache
def _name_of(path: Path) -> str:
    """Return what tells a file from others, wherever the checkout stands."""
    inside = PACKAGE in path.parents
    return path.relative_to(PACKAGE.parent).as_posix() if inside else path.name


@cache
def _kept() -> KeptSyntax:
    return KeptSyntax()


@cache
def _said(path: Path) -> tuple[str, tuple[Path, ...]]:
    """Return the digest of what a file says, and what it imports of this package and its folder."""
    found = _kept().of(path.read_bytes(), _module(path))
    imported: list[Path] = []
    for name in found.imported:
        imported.extend(_modules(name) if name.split(".")[0] == PACKAGE.name else ())
        beside = path.with_name(f"{name}.py")
        if PACKAGE not in path.parents and beside.is_file():
            imported.append(beside)
    return found.digest, tuple(imported)


@cache
def _modules(name: str) -> tuple[Path, ...]:
    """Return the files that are run when a module of this package is imported, itself last."""
    place, found = PACKAGE.parent, []
    for part in name.split("."):
        place = place / part
        found.append(place / "__init__.py")
    return tuple(filter(Path.is_file, (*found, place.with_suffix(".py"))))
