"""Numbers and commands as a report writes them."""

import math


def with_error(value: float, error: float) -> str:
    """Write a number and its error to two digits of the error; to three places without one.

    Examples
    --------
    >>> with_error(23.2191, 0.2203), with_error(23.2191, float("nan")), with_error(1234.5, 67.8)
    ('23.22 ± 0.22', '23.219 ± not known', '1234 ± 68')
    """
    if not (math.isfinite(error) and error > 0):
        return f"{signed(value)} ± {'0' if error == 0 else 'not known'}"
    places = max(1 - math.floor(math.log10(error)), 0)
    return f"{signed(value, places)} ± {error:.{places}f}"


def signed(value: float, places: int = 3) -> str:
    """Write a number with a minus that is one, or that it is not known."""
    return (
        f"{value:.{places}f}".replace("-", "\N{MINUS SIGN}")
        if math.isfinite(value)
        else "not known"
    )


def share(value: float) -> str:
    """Write a share in per cent to two digits, or that it is not known."""
    return f"{100 * value:.2g} %" if math.isfinite(value) else "not known"


def command(target: str) -> str:
    """Return the command that makes what is not there, of the config that the page offers."""
    return " ".join(filter(None, ("snakemake", target, "--cores 2 --configfile config.yaml")))


def capital(text: str) -> str:
    """Write a sentence's first letter as one."""
    return text[:1].upper() + text[1:]
