"""What made a dataset: a digest of its sources, and the environment that they ran in."""

import ast
import hashlib
import platform
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path

PACKAGE = Path(__file__).parents[1]
"""Folder of the package."""
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
    left_out = tuple(without)
    waiting = [path for source in sources for path in _files(source)]
    dumps: dict[Path, str] = {}
    while waiting:
        path = waiting.pop()
        if path in dumps or any(_is_of(path, name) for name in left_out):
            continue
        imported, dumps[path] = _syntax_tree(path)
        waiting.extend(imported)
    digest = hashlib.sha256()
    for name, path in sorted((_name_of(path), path) for path in dumps):
        digest.update(f"{name}\n{dumps[path]}\n".encode())
    return digest.hexdigest()[:12]


def _files(source: str | Path) -> list[Path]:
    return [source] if isinstance(source, Path) else list(_modules(source))


def _is_of(path: Path, name: str) -> bool:
    """Return whether a file is a module, or part of a package, of this name."""
    place = PACKAGE.parent.joinpath(*name.split("."))
    return path == place.with_suffix(".py") or place in path.parents


def _name_of(path: Path) -> str:
    """Return what tells a file from others, wherever the checkout stands."""
    inside = PACKAGE in path.parents
    return path.relative_to(PACKAGE.parent).as_posix() if inside else path.name


def _modules(name: str) -> Iterator[Path]:
    """Return the files that are run when a module of this package is imported, itself last."""
    place = PACKAGE.parent
    for part in name.split("."):
        place = place / part
        if (place / "__init__.py").is_file():
            yield place / "__init__.py"
    if place.with_suffix(".py").is_file():
        yield place.with_suffix(".py")


@cache
def _syntax_tree(path: Path) -> tuple[tuple[Path, ...], str]:
    """Return the files of this package and its folder that a file imports, and its tree as text."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        for field in ("body", "orelse", "finalbody"):
            held = getattr(node, field, None)
            if isinstance(held, list):
                kept = [part for part in held if not (_is_text(part) or _is_for_types(part))]
                setattr(node, field, kept or (held and [ast.Pass()]))
    imported: list[Path] = []
    for node in ast.walk(tree):
        for name in _imported(node, path):
            imported.extend(_modules(name) if name.split(".")[0] == PACKAGE.name else ())
            beside = path.with_name(f"{name}.py")
            if PACKAGE not in path.parents and beside.is_file():
                imported.append(beside)
    return tuple(imported), ast.dump(tree)


def _imported(node: ast.AST, path: Path) -> Iterator[str]:
    """Return the full names of the modules that a node imports, or may: a name can be a module."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        module = node.module or ""
        if node.level:
            parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
            module = ".".join([*parts[: -node.level], *filter(None, [module])])
        yield module
        yield from (f"{module}.{alias.name}" for alias in node.names)


def _is_for_types(node: ast.stmt) -> bool:
    """Return whether a statement is what only a type checker reads."""
    return isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING")


def _is_text(node: ast.stmt) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )
