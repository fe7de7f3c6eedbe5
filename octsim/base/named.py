"""Functions that a table names as text, so that nothing is imported before it is used."""

import inspect
from collections.abc import Callable
from importlib import import_module
from typing import Any


def named(text: str) -> Any:
    """Return what ``"module:function"`` names."""
    module, _, name = text.partition(":")
    return getattr(import_module(module), name)


def called(work: Callable[..., Any], *arguments: object, **offered: object) -> Any:
    """Call a function with its arguments, and with those of the offered keywords that it names."""
    return work(*arguments, **{name: one for name, one in offered.items() if names(work, name)})


def names(work: Callable[..., Any], keyword: str) -> bool:
    """Return whether a function has a parameter of a name."""
    return keyword in inspect.signature(work).parameters
