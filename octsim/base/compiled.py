"""Compiling to machine code, kept on disk for as long as no source behind it changes."""

import hashlib
import platform
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from types import FunctionType
from typing import Any, TypeVar

import llvmlite.binding
import numba

from octsim.base.carried import PACKAGE
from octsim.base.compile_time import counted
from octsim.base.compile_whole import as_a_whole
from octsim.base.kept_code import KeptCode
from octsim.base.provenance import source_digest

Function = TypeVar("Function", bound=Callable[..., Any])


def _sources(function: Callable[..., Any]) -> tuple[str | Path, ...]:
    """Return the module of a function, and the files of the functions that it is closed over."""
    file = Path(function.__code__.co_filename)
    own = function.__module__ if PACKAGE in file.parents else file
    return own, *(Path(part.__code__.co_filename) for part in _held_functions(function))


def _held_functions(function: Callable[..., Any]) -> list[FunctionType]:
    """Return the functions that a function is closed over, and those that they are."""
    own = [part for part in _held(function) if isinstance(part, FunctionType)]
    return own + [part for one in own for part in _held_functions(one)]


def _held(function: Callable[..., Any]) -> list[object]:
    """Return what a function is closed over."""
    return [cell.cell_contents for cell in function.__closure__ or ()]


def _named(held: object) -> str:
    """Return what tells a function or a plain value that another is closed over from others."""
    if isinstance(held, tuple):
        return f"({', '.join(map(_named, held))})"
    if isinstance(held, FunctionType):
        return f"{held.__module__}.{held.__qualname__}({', '.join(map(_named, _held(held)))})"
    return repr(held) if isinstance(held, bool | int | float | str) else ""


def _digest(function: Callable[..., Any]) -> str:
    """Digest all that a function's code follows from: sources, compiler and processor."""
    settings: Any = numba.config
    parts = (
        source_digest(*_sources(function)),
        *map(_named, _held(function)),
        platform.python_version(),
        version("numba"),
        version("llvmlite"),
        settings.CPU_NAME or llvmlite.binding.get_host_cpu_name(),
        settings.CPU_FEATURES,
        settings.OPT,
    )
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:12]


def compiled(*apart: Callable[..., Any], **options: Any) -> Callable[[Function], Function]:
    """Compile a function when it is first called, without the interpreter's lock.

    numba's own cache looks at the time of the function's file alone and would go on using old
    formulas from other files; here code is kept below the digest of all of them, those of functions
    that it is closed over too (`octsim.base.kept_code`).
    What it calls is optimised once, with it (`octsim.base.compile_whole`).

    Parameters
    ----------
    *apart : callable
        Functions that it calls and that are optimised by themselves too, before: some loops are
        computed in lanes only then.
    **options
        Those of `numba.njit`.
    """

    def compile_(function: Function) -> Function:
        chosen: Any = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True, **options}
        digest = _digest(function)
        # by this, the types and a number that begins anew in each process numba names machine code,
        # and of two codes of one name it sets the variables of the first alone
        function.__qualname__ += f".{digest}"
        dispatcher: Any = numba.njit(**chosen)(function)
        if not isinstance(dispatcher, FunctionType):  # which it is with NUMBA_DISABLE_JIT
            dispatcher._cache = kept = KeptCode(function, digest)
            dispatcher.compile = _whole(
                dispatcher.compile, kept, frozenset(part.__name__ for part in apart)
            )
        made: Function = dispatcher
        return made

    return compile_


def _whole(
    compile_: Callable[[Any], Any], kept: KeptCode, apart: frozenset[str]
) -> Callable[[Any], Any]:
    """Return a dispatcher's method `compile`, for the whole of what it compiles."""

    def whole(sig: Any) -> Any:
        try:
            with counted(), as_a_whole(apart):
                return compile_(sig)
        finally:
            kept.done()

    return whole
