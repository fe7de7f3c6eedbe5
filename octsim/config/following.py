"""What follows the sweep where a config says null: the diameters and foci of what goes with it."""

import math

from octsim.config.models import Config
from octsim.config.ranges import (
    DiameterList,
    DiameterRange,
    FocusRange,
    TableList,
    TableRange,
    evenly,
)

_LAW_STEP, _FEWEST_OF_LAW = 0.2, 9
"""Distance (µm) of the diameters that a law is fitted to, which is the thesis's, and how many."""
_TABLE_STEP, _FEWEST_OF_TABLE = 0.02, 8
"""Those of a calibration: the thesis's, and what a spline needs."""
_SCANNED = (-0.5, 2.0, 501)
"""A scan's lowest and highest focus, as fractions of the diameter, and how many: the thesis's."""


def scan_diameter(config: Config) -> float:
    """Return the diameter of a plain config's focus scan, µm: as given, or the sweep's middle."""
    given, sweep = config.focus_scan.diameter, config.sweep.diameters
    if given is not None:
        return given
    return float(evenly(sweep.start, sweep.stop, 3)[1])


def scan_foci(config: Config) -> FocusRange:
    """Return the foci of its focus scan, µm: as given, or about the diameter."""
    given = config.focus_scan.focus
    if given is not None:
        return given
    low, high, num = _SCANNED
    start, stop, _ = evenly(low * scan_diameter(config), high * scan_diameter(config), 3)[[0, 2, 1]]
    return FocusRange.model_construct(start=float(start), stop=float(stop), num=num)


def fitted_diameters(config: Config) -> DiameterRange | DiameterList:
    """Return the diameters that its focus law is fitted to: as given, or over the sweep's."""
    given = config.focus_law.diameters
    return _over_the_sweep(config, _LAW_STEP, _FEWEST_OF_LAW) if given is None else given


def calibration_diameters(config: Config) -> TableRange | TableList:
    """Return the diameters of its calibration: as given, or over the sweep's."""
    given = config.calibration.diameters
    if given is not None:
        return given
    return _over_the_sweep(config, _TABLE_STEP, _FEWEST_OF_TABLE)


def _over_the_sweep(config: Config, step: float, fewest: int) -> TableRange:
    sweep = config.sweep.diameters
    # a span of whole steps may be one rounding above
    steps = math.ceil(round((sweep.stop - sweep.start) / step, 6))
    return TableRange.model_construct(
        start=sweep.start, stop=sweep.stop, num=max(fewest, steps + 1)
    )


FOLLOWING = (
    "focus_scan.diameter", "focus_scan.focus", "focus_law.diameters", "calibration.diameters",
)  # fmt: skip
"""Keys that may be null, and follow the sweep then."""


def follows(config: Config, key: str) -> bool:
    """Return whether what a plain config has under one of `FOLLOWING` is the sweep's to say."""
    section, name = key.split(".")
    if getattr(getattr(config, section), name) is not None:
        return False
    # a scan's foci are of its diameter
    return key != "focus_scan.focus" or config.focus_scan.diameter is None
