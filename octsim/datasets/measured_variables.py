"""What each variable of `measured.nc` is, and its unit."""

from collections.abc import Mapping

MEASURED: Mapping[str, tuple[str, str]] = {
    # name: (units, long_name)
    "chain_error": ("1", "relative error of changes of the phase by the source's own spectrum"),
    "counts": ("1", "counts of a spectrometer, as they were recorded"),
    "dark_noise": ("1", "standard deviation of a sample without light, counts"),
    "dark_level": ("1", "mean counts without light"),
    "dispersion_a2": ("rad", "phase of dispersion at the edge of the band, of second order"),
    "dispersion_a3": ("rad", "phase of dispersion at the edge of the band, of third order"),
    "fit_residual": ("1", "counts that the fitted sinusoid leaves, root mean square"),
    "fringe_depth": ("um", "optical depth at which the phase is"),
    "fringe_phase": ("rad", "phase of the fringe at the middle of the band, in (-pi, pi]"),
    "fringe_phase_error": ("rad", "standard error of the phase by the noise of counts"),
    "full_scale": ("1", "counts at which the camera is full"),
    "measured_depth": ("um", "optical depth of the mean spectrum's fringe"),
    "sample_variance": ("1", "variance of the counts of a sample"),
    "saturated_samples": ("1", "samples at full scale"),
    "source_power": ("1", "power of the source, over its largest"),
    "spectrum_status": ("1", "whether the spectrum has a fringe, or why not"),
    "variance_per_count": ("1", "of the variance, one over the photoelectrons in a count"),
    "visibility": ("1", "amplitude of the fringe over its offset, at the middle of the band"),
    "wavelength": ("um", "wavelength in vacuum"),
}
