"""Cases of a parametrised test that `make test` leaves out."""

from typing import Any

import pytest


def trials(*values: Any) -> list[Any]:
    """Return cases of one value each, as trials: a case beside them is of the same kind."""
    return [pytest.param(value, marks=pytest.mark.trial) for value in values]
