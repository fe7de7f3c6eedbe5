"""Which tests look at a module: of its own name, those that import it, and the next farther."""

import ast
from pathlib import Path

PACKAGE = "octsim"
_RINGS = 2
"""Of tests: the nearest, and those of what imports the module."""
_WHOLE_RUNS = {"archive", "cli", "figures", "studies", "workflow"}
"""Rooms whose tests are of many modules at once, and take long."""


class OwnTests:
    """The test files of each module of a checkout.

    Parameters
    ----------
    root : Path
        Folder of the checkout.
    """

    def __init__(self, root: Path) -> None:
        self._root = root
        self._names = {
            _name(path.relative_to(root)): path for path in sorted(root.glob(f"{PACKAGE}/**/*.py"))
        }
        self._users: dict[str, set[str]] = {name: set() for name in self._names}
        for name, path in self._names.items():
            for used in self._imported(path, named=True):
                self._users[used].add(name)
        self._tests: dict[str, list[str]] = {name: [] for name in self._names}
        for path in sorted(root.glob("tests/*/**/test_*.py")):
            file = path.relative_to(root)
            if file.parts[1] not in _WHOLE_RUNS:
                for used in self._imported(path, named=False):
                    self._tests[used].append(file.as_posix())

    def files(self, module: str) -> list[str]:
        """Return the test files of a module, the nearest first.

        They are those of its name in its room and those that import it; then those of the modules
        that import it. Where there are none of the one kind, farther ones follow.

        Parameters
        ----------
        module : str
            Path of the module, from the checkout.
        """
        name = _name(Path(module))
        room, own = name.split(".")[1], f"test_{name.split('.')[-1]}.py"
        every = sorted(self._root.glob(f"tests/{room}/**/{own}"))
        near = [path.relative_to(self._root).as_posix() for path in every]
        found: list[str] = []
        known, at, rings = {name}, {name}, 0
        while at and rings < _RINGS:
            near += [file for one in sorted(at) for file in self._tests[one]]
            new = [file for file in dict.fromkeys(near) if file not in found]
            found, near, rings = found + new, [], rings + bool(new)
            at = {user for one in at for user in self._users[one]} - known
            known |= at
        return found

    def _imported(self, path: Path, *, named: bool) -> set[str]:
        """Return the modules of the package that a file imports, or maybe names as text."""
        found: set[str] = set()
        for node in ast.walk(ast.parse(path.read_bytes())):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
            elif named and isinstance(node, ast.Constant) and isinstance(node.value, str):
                found.add(node.value)  # as tables name modules, which are imported when needed
        return found & set(self._names)


def _name(path: Path) -> str:
    """Return the dotted name of a module."""
    parts = path.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
