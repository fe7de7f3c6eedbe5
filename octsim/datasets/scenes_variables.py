"""What each variable of `scenes.nc` is, and its unit."""

from collections.abc import Mapping

SCENES: Mapping[str, tuple[str, str]] = {
    # name: (units, long_name)
    "quantity_amount": ("1", "how much of it there is, in quantity_unit"),
    "quantity_unit": ("1", "unit of the quantity"),
    "scene_phase_slope": ("mrad/nm", "phase slope of the scene"),
    "scene_slope_change": ("mrad/nm", "change of the phase slope from the configured scene's"),
    "scene_mean_change": ("mrad/nm", "change of the phase slope, mean over the diameters"),
    "scene_change_scatter": ("mrad/nm", "scatter of that change over the diameters"),
    "scene_worst_change": ("mrad/nm", "largest change of the phase slope over the diameters"),
    "scene_phase_change": ("rad", "change of the phase from the configured scene's"),
    "tolerated": ("1", "change of the quantity that moves the held slope by the tolerance"),
    "case_status": ("1", "whether a scheme measures a case, and why not"),
}
