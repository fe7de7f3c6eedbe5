"""Having the compiler optimise a function with all that it calls once, and not piece by piece.

numba makes machine code of every function that another calls, and links what it had optimised into
the caller, where it is optimised and made machine code of again, level by level. Of code that only
others call, none of that is used. Within `as_a_whole` such parts are kept as they are, for linking,
and the whole is optimised when all is together. A part is compiled once for all that call it:
numba compiles it anew for callers of other options, and has it inlined wherever its caller is.

What is replaced for that are methods of numba that are not public. Where a numba has none of these
names, `FITS` is false and all is compiled as numba does: to the same numbers, in twice the time.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from threading import local
from types import FunctionType
from typing import Any

import llvmlite.binding
from numba.core import codegen
from numba.core.compiler import Flags
from numba.core.cpu import CPUContext
from numba.core.event import Listener, register
from numba.core.targetconfig import ConfigStack
from numba.core.typing import templates

_library: Any = codegen.CPUCodeLibrary
_OPTIMISE, _MAKE_CODE, _TO_LINK = (
    "_optimize_final_module", "_finalize_final_module", "_get_module_for_linking"
)  # fmt: skip
_WRAP = "create_cfunc_wrapper"
_part: Any = getattr(templates, "_OverloadFunctionTemplate", None)
_TYPE = "generic"
_INLINE = "forceinline"
_OF_ALL = "nrt", "error_model", "fastmath", "boundscheck", "debuginfo"
"""Options of the whole that its parts are compiled with."""
FITS = (
    hasattr(CPUContext, _WRAP)
    and hasattr(_part, _TYPE)
    and all(hasattr(_library, name) for name in (_OPTIMISE, _MAKE_CODE, _TO_LINK))
    and all(hasattr(Flags, name) for name in (*_OF_ALL, _INLINE))
)
_ENVIRONMENT = "NumbaEnv"  # of global variables that numba looks up in each function's code


class _Compiling(local):
    """What a thread is compiling."""

    within = False
    """Whether it is within `as_a_whole`."""
    depth = 0
    """Functions, each for the one before."""
    options: "tuple[_Shared, ...]" = ()
    """Those of its parts: of functions in Python, and of those that numba has ready."""
    apart: frozenset[str] = frozenset()
    """Names of functions that are optimised by themselves too."""


_compiling = _Compiling()


class _Depth(Listener):
    """Counts what a thread compiles. There is one, as each is told of all that is compiled."""

    def on_start(self, _event: Any) -> None:
        if _compiling.within:
            _compiling.depth += 1

    def on_end(self, _event: Any) -> None:
        if _compiling.within:
            _compiling.depth -= 1


register("numba:compile", _Depth())  # type: ignore[no-untyped-call]


def _is_part() -> bool:
    return _compiling.depth > 1


def _waits(name: str) -> bool:
    """Return whether what is being compiled is optimised with the whole alone."""
    return _is_part() and name not in _compiling.apart


class _Shared(Flags):
    """Options of a whole that its parts have in common.

    There is one object of the same options, as numba compares them tens of thousands of times.
    """

    __slots__ = ()
    __hash__ = object.__hash__

    def __eq__(self, other: object) -> bool:
        return self is other


_made: list[_Shared] = []


def _shared(whole: Flags, inline: bool) -> _Shared:
    """Return the options that the parts of a whole have, from its own; whether they are inlined."""
    flags = _Shared()  # type: ignore[no-untyped-call]
    setattr(flags, _INLINE, inline)
    for name in _OF_ALL:
        setattr(flags, name, getattr(whole, name))
    for made in _made:
        if Flags.__eq__(made, flags):  # type: ignore[no-untyped-call]
            return made
    _made.append(flags)
    return flags


if FITS:
    _optimise, _make_code = getattr(_library, _OPTIMISE), getattr(_library, _MAKE_CODE)
    _wrap = getattr(CPUContext, _WRAP)
    _type = getattr(_part, _TYPE)

    def _type_for_all(self: Any, *arguments: Any) -> Any:
        """Compile a part once for all that call it; numba does for each set of their options."""
        if not _compiling.depth:
            return _type(self, *arguments)
        if not _compiling.options:
            whole = ConfigStack().top()  # type: ignore[no-untyped-call]
            _compiling.options = _shared(whole, False), _shared(whole, True)
        # numba's own, such as max, are a few instructions; ours say for themselves
        flags = _compiling.options[not isinstance(type(self).key, FunctionType)]
        with ConfigStack().enter(flags):  # type: ignore[no-untyped-call]
            return _type(self, *arguments)

    def _optimise_the_whole(self: Any) -> None:
        if not _waits(self.name):
            _optimise(self)

    def _make_code_of_the_whole(self: Any) -> None:
        if _is_part():
            self._finalized = True
            getattr(self, _TO_LINK)()  # keeps a copy, for those that link it
            self._finalized = False
            self._final_module = llvmlite.binding.parse_assembly(_variables_of(self))
        _make_code(self)

    def _wrap_the_whole(self: Any, *arguments: Any, **named: Any) -> None:
        if not _is_part():  # nothing but compiled code calls a part
            _wrap(self, *arguments, **named)

    setattr(CPUContext, _WRAP, _wrap_the_whole)
    setattr(_part, _TYPE, _type_for_all)
    setattr(_library, _OPTIMISE, _optimise_the_whole)
    setattr(_library, _MAKE_CODE, _make_code_of_the_whole)


def _variables_of(library: Any) -> str:
    """Return a module that has the variables of a library which numba looks up, and no code."""
    module = library._final_module
    names = [one.name for one in module.global_variables if _ENVIRONMENT in one.name]
    lines = [f'@"{name}" = common global ptr null' for name in names]
    head = f'target datalayout = "{module.data_layout}"\ntarget triple = "{module.triple}"'
    return "\n".join((head, *lines))


@contextmanager
def as_a_whole(apart: frozenset[str]) -> Iterator[None]:
    """Compile what is compiled within, each for itself, as a whole with all that it calls.

    Parameters
    ----------
    apart : frozenset of str
        Names of functions that are optimised by themselves too, before the whole is: some loops are
        computed in lanes only then.
    """
    here = _compiling
    around = here.within, here.depth, here.apart, here.options
    here.within, here.depth, here.apart, here.options = True, 0, apart, ()
    collects = gc.isenabled()
    gc.disable()  # looks for garbage take a seventh of all; what there is takes 0.1 GB
    try:
        yield
    finally:
        if collects:
            gc.enable()
        here.within, here.depth, here.apart, here.options = around
