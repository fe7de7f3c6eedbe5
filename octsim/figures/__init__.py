"""The figures, one module for each dataset: functions from datasets to a matplotlib figure."""

import contextlib
import os
import sys

if "matplotlib" not in sys.modules:
    # no figure here asks for a backend; a name of none would keep matplotlib from being loaded
    _backend = os.environ.pop("MPLBACKEND", "")
    import matplotlib as mpl

    if _backend:
        os.environ["MPLBACKEND"] = _backend
        with contextlib.suppress(ValueError):
            mpl.rcParams["backend"] = _backend
