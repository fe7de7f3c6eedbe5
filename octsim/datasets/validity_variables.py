"""What each variable of `validity.nc` is, and its unit: rays beside Maxwell's equations."""

from collections.abc import Mapping

VALIDITY: Mapping[str, tuple[str, str]] = {
    # name: (units, long_name)
    "case": ("1", "instrument that is compared"),
    "quantity": ("1", "what is varied of it"),
    "quantity_value": ("1", "what that is"),
    "ray_scheme": ("1", "scheme of rays"),
    "focus_mode": ("1", "whether the focus follows the diameter, or is held"),
    "bound_of_error": ("1", "bound of the relative error of the phase slope"),
    "ray_phase_slope": ("mrad/nm", "phase slope by rays"),
    "ray_slope_error": ("1", "relative error of the phase slope by rays"),
    "ray_phase_error": ("rad", "error of the phase by rays, at the middle of the band"),
    "ray_visibility_error": ("1", "relative error of the fringe's visibility by rays"),
    "ray_spectrum_error": ("1", "error of the spectrum over its mean by rays, rms over the band"),
    "mean_slope_error": ("1", "mean error of the phase slope by rays, over the mean slope"),
    "share_within": ("1", "share of the diameters where that error is within the bound"),
}
