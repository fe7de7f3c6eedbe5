"""What each variable of the way from a phase to nanometres is, and its unit."""

from collections.abc import Mapping

CALIBRATION: Mapping[str, tuple[str, str]] = {
    # what is held while the diameter changes is in docs/calibration.md
    "fixed_focus_phase_slope": ("mrad/nm", "phase slope at a fixed focus and gap"),
    "diameter_per_phase": ("nm/mrad", "change of the diameter for each mrad of phase"),
    "phase_curvature": ("mrad/nm2", "change of that phase slope with the diameter, focus held"),
    "difference_error": ("mrad/nm", "error of that phase slope as a finite difference"),
    "interpolation_error": ("mrad/nm", "error between every second of the diameters"),
    "following_phase_slope": ("mrad/nm", "phase slope if the focus follows the diameter"),
    "focus_phase_slope": ("mrad/nm", "change of the phase with the focus"),
    "fft_fixed_focus_phase_slope": ("mrad/nm", "phase slope at a fixed focus, of the fft"),
    "fft_following_phase_slope": ("mrad/nm", "phase slope if the focus follows, of the fft"),
    "near_side_phase_slope": ("mrad/nm", "change of the phase of the near side's light by itself"),
    "far_side_phase_slope": ("mrad/nm", "change of the phase of the far side's light by itself"),
    "rays_phase_slope": ("mrad/nm", "phase slope at a fixed focus, by 3000 rays"),
    "light_paths_phase_slope": ("mrad/nm", "phase slope at a fixed focus, by light paths"),
    "maxwell_phase_slope": ("mrad/nm", "phase slope at a fixed focus, by Maxwell's equations"),
    "model_status": ("1", "whether the error of the scheme itself is known"),
    "parameter": ("1", "what may differ from what is believed"),
    "budget": ("mrad/nm", "rms change of the phase slope by a parameter's tolerance"),
    "slope_shift": ("mrad/nm", "mean change of the phase slope by all that is not known"),
    "budget_error": ("mrad/nm", "error of that standard error as a finite difference"),
    "diameter_sensitivity": ("mrad/nm2", "change of the phase slope with the diameter at rest"),
    "gap_sensitivity": ("mrad/nm2", "change of the phase slope with the gap"),
    "glass_sensitivity": ("mrad/nm", "change of the phase slope with the index of glass"),
    "water_sensitivity": ("mrad/nm", "change of the phase slope with the index of water"),
    "neuron_sensitivity": ("mrad/nm", "change of the phase slope with the index of the neuron"),
    "focus_sensitivity": ("mrad/nm2", "change of the phase slope with the focus"),
    "numerical_aperture_sensitivity": ("mrad/nm", "change of the phase slope with the NA"),
    "detector_radius_sensitivity": ("mrad/nm2", "change of the phase slope with R_det"),
    "fill_sensitivity": ("mrad/nm", "change of the phase slope with the pupil's relative fill"),
    "polarisation_sensitivity": ("mrad/nm", "change of the phase slope with the direction, a rad"),
    "offset_sensitivity": ("mrad/nm2", "change of the phase slope with the neuron's offset"),
    "wavelength_min_sensitivity": ("mrad/nm2", "change of the phase slope with the band's edge"),
    "wavelength_max_sensitivity": ("mrad/nm2", "change of the phase slope with the band's edge"),
    "time": ("s", "time"),
    "measured_phase": ("rad", "phase as it was measured"),
    "measured_phase_error": ("rad", "standard error of the phase as it was measured"),
    "phase_change": ("rad", "change of the phase from rest"),
    "expansion": ("nm", "change of the diameter from rest"),
    "statistical_error": ("nm", "standard error of that change, by the phase's"),
    "systematic_error": ("nm", "standard error of that change, by the calibration's"),
    "samples_missing": ("1", "number of samples without a phase"),
    "outlier": ("1", "whether a sample stands alone, far from its neighbours"),
    "error_status": ("1", "where the statistical error is from"),
    "rest_scatter": ("rad", "scatter of the phase at rest; NaN where its error is given"),
    "smallest_step": ("rad", "smallest step between the phases that were recorded"),
    "drift": ("rad s-1", "drift of the phase that is subtracted"),
    "true_expansion": ("nm", "change of the diameter that was simulated"),
    "fft_expansion": ("nm", "phase of the fft over the predicted slope: the thesis's way"),
    "trip_diameter": ("um", "diameter at rest of the round trips"),
    "trip_expansion": ("nm", "change of the diameter that a round trip recovers"),
    "trip_statistical_error": ("nm", "standard error of that, by the phase's"),
    "trip_systematic_error": ("nm", "standard error of that, by the calibration's"),
    "trip_bias": ("1", "mean error of the round trips, over the expansion"),
    "coverage_both": ("1", "fraction of round trips within their standard error"),
    "coverage_noise": ("1", "the same of an instrument as believed, by the statistical error"),
    "coverage_instrument": ("1", "the same without noise, by the systematic error"),
}
"""Of the calibration, expansions by it, and its worked example."""

_BY_LENGTH, _BY_ANGLE = ("gap", "x", "diameter", "thickness"), ("azimuth", "elevation")


def scene_sensitivity(name: str) -> tuple[str, str]:
    """Return unit and meaning of the sensitivity to a number of the scene.

    Parameters
    ----------
    name : str
        ``<key>_sensitivity``, the key's dots as underscores.

    Raises
    ------
    KeyError
        If it is of no such variable.
    """
    key = name.removesuffix("_sensitivity")
    if key == name or not key.startswith("scene_"):
        raise KeyError(name)
    by_index, last = key.startswith("scene_refractive_index_"), key.rpartition("_")[2]
    units = "mrad um/nm"  # an attenuation
    if by_index or last in _BY_ANGLE:
        units = "mrad/nm"
    elif last in _BY_LENGTH:
        units = "mrad/nm2"
    return units, f"change of the phase slope with {key.replace('_', ' ')}"
