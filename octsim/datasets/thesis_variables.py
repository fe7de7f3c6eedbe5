"""What each variable of `diffraction.nc` and `interferometers.nc` is, and its unit."""

from collections.abc import Mapping

DIFFRACTION: Mapping[str, tuple[str, str]] = {
    # name: (units, long_name)
    "peak": ("1", "peak of the intensity over the focus"),
    "peak_focus": ("um", "focus of the peak"),
    "peak_width": ("um", "full width of the peak at half of its height"),
    "peak_height": ("1", "intensity at the peak"),
    "slope_change": ("mrad/nm", "mean phase slope less that of rays that meet in the focus"),
    "local_slope_change": ("mrad/nm", "difference of the phase slope from its mean one, rms"),
    "offset_phase_slope": ("mrad/nm", "mean phase slope with the focus off the law"),
}
INTERFEROMETERS: Mapping[str, tuple[str, str]] = {
    "michelson_intensity": ("1", "intensity with the reference arm"),
    "michelson_closed_form": ("1", "the same by eq. (1), L one way in the place of its difference"),
    "michelson_magnitude": ("1", "magnitude of the component, with the reference arm"),
    "arm": ("um", "length of the reference arm, one way from the focus"),
    "one_wavelength_intensity": ("1", "intensity at the middle of the band, over both arms' own"),
    "band_intensity": ("1", "intensity of the whole band, over both arms' own"),
    "plates_intensity": ("1", "intensity of plates; of the ideal, cos(2ndk)"),
    "plates_error": ("1", "largest difference from Airy's sum, over the largest intensity"),
    "shown_thickness": ("um", "thickness whose spectrum is shown"),
}
