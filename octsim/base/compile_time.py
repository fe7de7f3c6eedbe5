"""What this process has spent on compiling, or on waiting for it, for who times something else."""

_spent = [0.0]


def count(seconds: float) -> None:
    """Count some seconds of compiling."""
    _spent[0] += seconds


def compiled_for() -> float:
    """Return the seconds counted since this was asked last."""
    seconds, _spent[0] = _spent[0], 0.0
    return seconds
