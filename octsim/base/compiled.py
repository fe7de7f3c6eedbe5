"""Compiling to machine code, kept on disk for as long as no source behind it changes."""

from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import Any, TypeVar

import numba

from octsim.base.provenance import PACKAGE, source_digest

Function = TypeVar("Function", bound=Callable[..., Any])


def _sources(function: Callable[..., Any]) -> tuple[str | Path, ...]:
    """Return the module of a function, and the files of the functions that it is closed over."""
    held = (cell.cell_contents for cell in function.__closure__ or ())
    parts = (Path(part.__code__.co_filename) for part in held if isinstance(part, FunctionType))
    return function.__module__, *parts


def compiled(**options: Any) -> Callable[[Function], Function]:
    """Compile a function when it is first called, without the interpreter's lock.

    numba's own cache looks at the time of the function's file alone and would go on using old
    formulas from other files; here the cache's folder is named after the digest of all of them,
    those of functions that it is closed over too, and after the processor that NUMBA_CPU_NAME asks
    for, if it does.
    Options are those of `numba.njit`.
    """

    def compile_(function: Function) -> Function:
        settings: Any = numba.config
        asked = f"-{settings.CPU_NAME}" if settings.CPU_NAME else ""
        digest = source_digest(*_sources(function))
        folder = PACKAGE / "__pycache__" / f"numba-{digest}{asked}"
        elsewhere, settings.CACHE_DIR = settings.CACHE_DIR, str(folder)
        try:
            dispatcher: Function = numba.njit(
                cache=True, nogil=True, error_model="numpy", **options
            )(function)
        finally:
            settings.CACHE_DIR = elsewhere
        return dispatcher

    return compile_
