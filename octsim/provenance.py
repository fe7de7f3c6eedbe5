"""What made a dataset: a digest of the sources that its stage stands on."""

import ast
import hashlib
from functools import cache
from pathlib import Path

_PACKAGE = Path(__file__).parent


def source_digest(*sources: str | Path) -> str:
    """Digest Python sources and the modules of this package that they import, at any depth.

    Comments, docstrings and formatting do not change it; a changed constant does.

    Parameters
    ----------
    *sources : str or path
        Names of modules of this package (``"octsim.focus"``) or paths of scripts.

    Returns
    -------
    str
        Twelve hexadecimal digits of a SHA-256.
    """
    scripts = [source for source in sources if isinstance(source, Path)]
    waiting = [source for source in sources if isinstance(source, str)]
    trees = [_tree(script) for script in scripts]
    waiting.extend(name for tree, _ in trees for name in tree)
    modules: dict[str, str] = {}
    while waiting:
        name = waiting.pop()
        if name not in modules:
            imported, modules[name] = _tree(_module_path(name))
            waiting.extend(imported)
    digest = hashlib.sha256()
    for _, dump in trees:
        digest.update(dump.encode())
    for name in sorted(modules):
        digest.update(f"{name}\n{modules[name]}\n".encode())
    return digest.hexdigest()[:12]


def _module_path(name: str) -> Path:
    path = _PACKAGE.joinpath(*name.split(".")[1:])
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@cache
def _tree(path: Path) -> tuple[tuple[str, ...], str]:
    """Give the modules of this package that a file imports, and its syntax tree as text."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    imported = []
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("octsim."):
            imported.append(node.module or "")
        elif isinstance(node, ast.ImportFrom) and node.module == "octsim":
            imported.extend(f"octsim.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Import):
            imported.extend(a.name for a in node.names if a.name.startswith("octsim."))
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            node.body = [part for part in node.body if not _is_text(part)] or [ast.Pass()]
    return tuple(imported), ast.dump(tree)


def _is_text(node: ast.stmt) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )
