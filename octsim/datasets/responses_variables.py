"""What the variables of `responses.nc` are, and those of an expansion by them, and their units."""

from collections.abc import Mapping

RESPONSES: Mapping[str, tuple[str, str]] = {
    # of each quantity the unit is a nanometre or a thousandth of an index: quantity_unit
    "variant": ("1", "scene as it is, or with a membrane"),
    "quantity": ("1", "what of the neuron changes"),
    "quantity_unit": ("1", "unit of a quantity: nm, or 1e-3 of an index"),
    "observable": ("1", "phase that is watched: of the band, of parts of it, or of depths"),
    "source": ("1", "what tells the quantities"),
    "phase_response": ("mrad", "change of a phase for each nm, or 1e-3 of an index, focus held"),
    "phase_response_difference_error": ("mrad", "error of that response as a finite difference"),
    "phase_response_shift": ("mrad", "change of that response by a tolerance, at two nodes of it"),
    "phase_noise_covariance": ("mrad2", "covariance of the phases by shot noise"),
    "apparent_expansion": ("nm", "change of the diameter that a unit of a quantity looks like"),
    "apparent_expansion_of_shape": ("nm", "the same, of the likeliest diameter of a spectrum"),
    "intensity_response": ("1", "change of the intensity for each nm, or 1e-3 of an index"),
    "intensity_response_error": ("1", "error of that as a finite difference, over its largest"),
    "error_alone": ("1", "standard error of a quantity, all others known, in its unit"),
    "error_with_other": ("1", "standard error of a quantity with another unknown, in its unit"),
    "error_together": ("1", "standard error of a quantity, all unknown, in its unit"),
    "error_correlation": ("1", "correlation of the errors, all unknown"),
    "separability": ("1", "whether a quantity is told from all others"),
    "separability_with_other": ("1", "whether a quantity is told from another"),
    "trial_bias": ("1", "mean error of fits to noisy spectra of a changed neuron, in its unit"),
    "trial_coverage": ("1", "fraction of those fits within their standard error"),
    "band_min": ("um", "shortest wavelength of a band, in vacuum"),
    "band_max": ("um", "longest wavelength of a band, in vacuum"),
    # of an expansion by several phases
    "change": ("1", "change of a quantity from rest, in its unit"),
    "change_statistical_error": ("1", "standard error of that change, by the phases'"),
    "change_systematic_error": ("1", "standard error of that change, by the responses'"),
    "statistical_covariance": ("1", "covariance of the changes' statistical errors"),
    "systematic_covariance": ("1", "covariance of the changes' systematic errors"),
    "reduced_chi_square": ("1", "misfit of the phases over their errors, for each degree freedom"),
}
