"""What the variables of `design.nc` are that no other dataset has, and their units."""

from collections.abc import Mapping

DESIGN: Mapping[str, tuple[str, str]] = {
    # name: (units, long_name)
    "aperture": ("1", "numerical aperture"),
    "band": ("1", "band of wavelengths"),
    "fill": ("1", "fill of the pupil: 1/e2 radius of intensity over the pupil's"),
    "focus_offset": ("um", "height of the focus above that of the law"),
    "total_error": ("nm", "standard error of an expansion"),
    "rms_error": ("nm", "standard error of an expansion, rms over the diameters"),
    "least_error": ("nm", "Cramér–Rao bound of a spectrum's diameter"),
    "slope_error": ("1", "standard error of the phase slope by a tolerance, over the slope"),
    "brightness": ("1", "mean intensity, over that of a perfect mirror in the focus"),
    "depth_peak": ("1", "height of the fringe's peak in the depth profile, as an amplitude"),
    "criterion": ("1", "what the focus is found by, where it is greatest"),
    "criterion_offset": ("um", "focus where the criterion is greatest, above that of the law"),
    "criterion_prominence": ("1", "how far the greatest is above the scan's ends, over it"),
    "criterion_error": ("nm", "standard error of an expansion at the focus that is found"),
    "draws": ("1", "number of noisy spectra of each setting"),
}
