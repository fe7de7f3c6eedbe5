"""The figures, one module for each dataset: functions from datasets to a matplotlib figure."""

import contextlib
import os
import sys

from octsim.base.errors import FileError

if "matplotlib" not in sys.modules:
    # no figure here asks for a backend; a name of none would keep matplotlib from being loaded
    _backend = os.environ.pop("MPLBACKEND", "")
    try:
        import matplotlib as mpl
    except UnicodeDecodeError as error:
        raise FileError(f"matplotlibrc: is no text ({error}); mend or remove yours") from None

    if _backend:
        os.environ["MPLBACKEND"] = _backend
        with contextlib.suppress(ValueError):
            mpl.rcParams["backend"] = _backend
