"""What a Python source says to the interpreter: a digest of its syntax tree, and its imports."""

import ast
import hashlib
from collections.abc import Iterator
from typing import NamedTuple


class Syntax(NamedTuple):
    """What a source says."""

    digest: str
    """Of its syntax tree: comments, docstrings, formatting and what only a type checker reads do
    not change it."""
    imported: tuple[str, ...]
    """Full names of modules that it imports, or may: a name in a package can be a module."""


def syntax_of(text: str, module: tuple[str, ...]) -> Syntax:
    """Return what a source says.

    Parameters
    ----------
    text : str
        The source.
    module : tuple of str
        Its own name, part by part; that of a package ends in ``__init__``.
    """
    tree = ast.parse(text)
    for node in ast.walk(tree):
        for field in ("body", "orelse", "finalbody"):
            held = getattr(node, field, None)
            if isinstance(held, list):
                kept = [part for part in held if not (_is_text(part) or _is_for_types(part))]
                setattr(node, field, kept or (held and [ast.Pass()]))
    imported = dict.fromkeys(name for node in ast.walk(tree) for name in _imported(node, module))
    return Syntax(hashlib.sha256(ast.dump(tree).encode()).hexdigest(), tuple(imported))


def _imported(node: ast.AST, module: tuple[str, ...]) -> Iterator[str]:
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        name = node.module or ""
        if node.level:
            name = ".".join([*module[: -node.level], *filter(None, [name])])
        yield name
        yield from (f"{name}.{alias.name}" for alias in node.names)


def _is_for_types(node: ast.stmt) -> bool:
    """Return whether a statement is what only a type checker reads."""
    return isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING")


def _is_text(node: ast.stmt) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )
