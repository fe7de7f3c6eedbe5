"""What made a dataset: a digest of the sources that its stage stands on."""

import ast
import hashlib
from functools import cache
from pathlib import Path

_PACKAGE = Path(__file__).parent
LOCK = "requirements.lock"
"""Pinned versions of what octsim needs, in a checkout."""


def lock_file() -> Path | None:
    """Give the pinned versions, where the package stands in a checkout of octsim."""
    checkout = _PACKAGE.parent
    file = checkout / LOCK
    return file if file.is_file() and (checkout / "pyproject.toml").is_file() else None


def source_digest(source: str | Path) -> str:
    """Digest a Python source and all that it imports of this package and of its own folder.

    Comments, docstrings and formatting do not change it; a changed constant does.

    Parameters
    ----------
    source : str or path
        Name of a module of this package (``"octsim.focus"``) or path of a script.

    Returns
    -------
    str
        Twelve hexadecimal digits of a SHA-256.
    """
    waiting = [_module_path(source) if isinstance(source, str) else source]
    dumps: dict[Path, str] = {}
    while waiting:
        path = waiting.pop()
        if path not in dumps:
            imported, dumps[path] = _syntax_tree(path)
            waiting.extend(imported)
    digest = hashlib.sha256()
    for path in sorted(dumps, key=lambda path: (path.parent.name, path.name)):
        digest.update(f"{path.parent.name}/{path.name}\n{dumps[path]}\n".encode())
    return digest.hexdigest()[:12]


def _module_path(name: str) -> Path:
    path = _PACKAGE.joinpath(*name.split(".")[1:])
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@cache
def _syntax_tree(path: Path) -> tuple[tuple[Path, ...], str]:
    """Give the files that a file imports, of this package and its folder, and its tree as text."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    names: list[str] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            names.append(node.module or "")
        elif isinstance(node, ast.Import):
            names.extend(alias.name for alias in node.names)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            node.body = [part for part in node.body if not _is_text(part)] or [ast.Pass()]
    own = [_module_path(name) for name in names if name.startswith("octsim.")]
    beside = [path.with_name(f"{name}.py") for name in names if path.parent != _PACKAGE]
    return (*own, *(file for file in beside if file.is_file())), ast.dump(tree)


def _is_text(node: ast.stmt) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )
