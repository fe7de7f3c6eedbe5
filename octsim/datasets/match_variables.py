"""What each variable of `match.nc` is, and its unit."""

from collections.abc import Mapping

MATCH: Mapping[str, tuple[str, str]] = {
    # name: (units, long_name)
    "believed": ("1", "what is believed of the parameter, in parameter_unit"),
    "chi_square": ("1", "sum of squares of what the best fit leaves, over the errors"),
    "configured_chi_square": ("1", "the same of the config as it is"),
    "configured_misfit": ("1", "residual of the config as it is, over the spectrum, rms"),
    "degrees_of_freedom": ("1", "samples less what is fitted"),
    "match_correlation": ("1", "correlation of the errors of two parameters of the fit"),
    "match_status": ("1", "whether the fit tells the parameter better than its tolerance"),
    "match_tolerance": ("1", "tolerance of the parameter, in parameter_unit"),
    "matched": ("1", "what fits best, in parameter_unit"),
    "matched_error": ("1", "standard error of that, in parameter_unit"),
    "matched_phase_slope": ("mrad/nm", "phase slope at a fixed focus of what fits best"),
    "matched_phase_slope_standard_error": (
        "mrad/nm",
        "its error, by the fit and the tolerances of what is not fitted",
    ),
    "matched_spectrum": ("1", "modelled counts of what fits best"),
    "measured_spectrum": ("1", "mean counts at rest, without the dark"),
    "measured_spectrum_error": ("1", "standard error of these"),
    "misfit": ("1", "residual of the best fit over the spectrum, rms"),
    "modelled_spectrum": ("1", "modelled counts of the config as it is"),
    "nominal_depth": ("um", "optical depth n d by the config"),
    "other_parameter": ("1", "the other of two parameters"),
    "parameter_unit": ("1", "unit of the parameter"),
    "source_difference": ("1", "difference of spectrum.source and the measured source, rms"),
}
