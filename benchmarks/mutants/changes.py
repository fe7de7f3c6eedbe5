"""Small wrong changes that can be made to a module: one operator, number, condition or answer."""

import ast
import copy
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

_BOUNDARY: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt,
}  # fmt: skip
_OPPOSITE: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE, ast.LtE: ast.Gt, ast.Gt: ast.LtE, ast.GtE: ast.Lt, ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
}  # fmt: skip
_ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult, ast.Mod: ast.Mult, ast.Pow: ast.Mult, ast.MatMult: ast.Mult,
}  # fmt: skip
_LARGER = 1.5
_UNTOUCHED = (ast.Raise, ast.Assert, ast.JoinedStr, ast.Import, ast.ImportFrom)
"""What is said of errors, what helps the type checker, and text: no result follows from these."""
_FOR_CHECKS = {"strict"}
"""Keywords that say what must be so, as in zip: nothing changes where it is so."""


class Change(NamedTuple):
    """A piece of a module's text that is replaced by another."""

    module: str
    """Path of the file, from the checkout's folder."""
    line: int
    text: str
    """The line."""
    begin: int
    """Of the piece, in bytes of the file."""
    end: int
    was: str
    now: str
    kind: str
    """Of what is changed: comparison, arithmetic, condition, constant or answer."""
    number: int = 1
    """Of those of a file that read the same, in the order of its text."""

    def made(self, source: bytes) -> bytes:
        """Return the file's content with this change."""
        return source[: self.begin] + f"({self.now})".encode() + source[self.end :]

    @property
    def name(self) -> str:
        """What tells it from others, wherever in its file the line is."""
        nth = f" ({self.number})" if self.number > 1 else ""
        return f"{self.module}: {self.was} -> {self.now}{nth} in {self.text}"


def changes(root: Path, module: str) -> list[Change]:
    """Return every change that can be made to a module, in the order of its text.

    Parameters
    ----------
    root : Path
        Folder of the checkout.
    module : str
        Path of the file, from there.
    """
    source = (root / module).read_bytes()
    starts = [0]
    lines = source.splitlines(keepends=True)
    for line in lines:
        starts.append(starts[-1] + len(line))
    found = []
    for node, now, kind in _within(ast.parse(source)):
        begin = starts[node.lineno - 1] + node.col_offset
        end = starts[(node.end_lineno or 0) - 1] + (node.end_col_offset or 0)
        texts = ast.unparse(node), ast.unparse(now)
        text = lines[node.lineno - 1].decode().strip()
        found.append(Change(module, node.lineno, text, begin, end, *texts, kind))
    same = Counter[str]()
    for place, one in enumerate(sorted(found, key=lambda one: (one.begin, one.end, one.now))):
        same[one.name] += 1
        found[place] = one._replace(number=same[one.name])
    return found


def _within(node: ast.AST) -> Iterator[tuple[ast.expr, ast.expr, str]]:
    """Yield expressions below a node, what each may be replaced by, and the kind of that."""
    if isinstance(node, _UNTOUCHED) or _is_for_types(node):
        return
    if isinstance(node, ast.expr):
        yield from ((node, now, kind) for now, kind in _instead_of(node))
    if isinstance(node, ast.If | ast.IfExp):
        yield node.test, ast.UnaryOp(ast.Not(), node.test), "condition"
    if isinstance(node, ast.Return) and node.value is not None and not _is_none(node.value):
        yield node.value, ast.Constant(None), "answer"
    for name, held in ast.iter_fields(node):
        if name in {"annotation", "returns", "decorator_list"}:
            continue
        for below in held if isinstance(held, list) else [held]:
            if isinstance(below, ast.AST):
                yield from _within(below)


def _instead_of(node: ast.expr) -> Iterator[tuple[ast.expr, str]]:
    if isinstance(node, ast.Compare):
        for place, operator in enumerate(node.ops):
            for table in (_BOUNDARY, _OPPOSITE):
                if other := table.get(type(operator)):
                    now = copy.copy(node)
                    now.ops = [*node.ops[:place], other(), *node.ops[place + 1 :]]
                    yield now, "comparison"
    elif isinstance(node, ast.BinOp) and type(node.op) in _ARITHMETIC:
        yield ast.BinOp(node.left, _ARITHMETIC[type(node.op)](), node.right), "arithmetic"
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield node.operand, "arithmetic"
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.Invert):
        yield node.operand, "condition"
    elif isinstance(node, ast.BoolOp):
        other = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        yield ast.BoolOp(other, node.values), "condition"
    elif isinstance(node, ast.Constant):
        yield from ((ast.Constant(now), "constant") for now in _other_value(node.value))


def _other_value(value: object) -> list[bool | int | float | complex]:
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1]
    if isinstance(value, float | complex):
        return [_LARGER * value if value else value + 1]
    return []


def _is_for_types(node: ast.AST) -> bool:
    if isinstance(node, ast.keyword):
        return node.arg in _FOR_CHECKS
    return isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING")


def _is_none(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is None
