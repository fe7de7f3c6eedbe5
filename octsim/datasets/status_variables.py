"""What the statuses are that say why values are missing; older files lack them."""

from collections.abc import Mapping

STATUSES: Mapping[str, tuple[str, str]] = {
    # name: (units, long_name)
    "standard_error_status": ("1", "whether the standard error is known, or why not"),
    "law_status": ("1", "whether there is a focus law, or why not"),
    "field_status": ("1", "whether the samples of the field are kept"),
    "node_status": ("1", "whether the field is solved for at the node, or why not"),
    "path_status": ("1", "whether the path brings light back, and so has a phase"),
    "estimate_status": ("1", "whether there is a phase by the estimator, or why not"),
    "slope_status": ("1", "whether there is a phase slope, or why not"),
    "component_slope_status": (
        "1",
        "whether the component has a phase slope, or why not",
    ),
    "exact_slope_status": (
        "1",
        "whether there is a slope by Maxwell's equations, or why not",
    ),
    "mean_slope_status": ("1", "whether there is a mean phase slope, or why not"),
    "band_status": ("1", "whether the sample is in the band that is looked at"),
    "systematic_status": ("1", "whether the systematic error is known"),
    "matched_systematic_status": (
        "1",
        "whether the error of the slope that fits best is known",
    ),
    "phase_error_status": ("1", "whether the phase is compared, or why not"),
    "amplitude_error_status": ("1", "whether the amplitude is compared, or why not"),
    "phase_slope_error_status": (
        "1",
        "whether the phase slope is compared, or why not",
    ),
    "spectrum_error_status": (
        "1",
        "whether the intensity's sum is compared, or why not",
    ),
    "launch_error_status": ("1", "whether the rays' places are compared, or why not"),
    "single_error_status": ("1", "whether float32 is compared, or why not"),
    "paths_status": ("1", "whether light paths are compared, or why not"),
    "slope_error_status": (
        "1",
        "whether there is an error of the phase slope, or why not",
    ),
    "maxwell_status": (
        "1",
        "whether there is an error from Maxwell's equations, or why not",
    ),
    "maxwell_slope_status": (
        "1",
        "whether there is a slope by Maxwell's equations, or why not",
    ),
    "segments_status": ("1", "whether segments are traced"),
    "law_error_status": ("1", "whether there is an error of the focus law, or why not"),
    "intensity_change_status": (
        "1",
        "whether the change of the intensity is measured, or why not",
    ),
    "rays_law_status": ("1", "whether there is a law of counted rays, or why not"),
    "target_status": ("1", "whether it is known what the error costs, or why not"),
    "ray_fringe_status": ("1", "whether the spectrum by rays has a fringe, or why not"),
    "mean_slope_error_status": (
        "1",
        "whether there is a mean error of the slope, or why not",
    ),
    "peak_status": ("1", "whether there is a peak with a width, or why not"),
    "plates_error_status": ("1", "whether the plates are compared with a closed form"),
    "share_status": ("1", "whether the variance is shared out, or why not"),
    "converged_slope_status": (
        "1",
        "whether there is one, of spectra by light paths, or why not",
    ),
    "estimator_status": ("1", "whether the estimator is for a sweep's spectra"),
    "resolution_status": (
        "1",
        "whether each noisy spectrum has an estimate, or why not",
    ),
    "read_noise_resolution_status": ("1", "the same under shot and read noise"),
    "misreading_status": (
        "1",
        "whether it is known how another scene is misread, or why not",
    ),
    "budget_status": ("1", "whether the part of the error is known, or why not"),
    "rays_slope_status": ("1", "whether there is a phase slope by rays, or why not"),
    "light_paths_slope_status": (
        "1",
        "whether there is a phase slope by light paths, or why not",
    ),
    "near_side_slope_status": ("1", "whether the near side returns light"),
    "far_side_slope_status": ("1", "whether the far side returns light"),
    "change_status": ("1", "whether the change is known, or why not"),
    "mean_change_status": ("1", "whether the mean change is known, or why not"),
    "tolerated_status": ("1", "whether it is known what is tolerated, or why not"),
    "response_status": ("1", "whether there is a response, or why not"),
    "response_error_status": (
        "1",
        "whether the response's standard error is known, or why not",
    ),
    "shift_status": ("1", "whether the response's shift is known, or why not"),
    "covariance_status": ("1", "whether the phases have noise, or why not"),
    "depth_status": ("1", "whether the phase is of a depth"),
    "quantity_status": ("1", "whether the scene has the quantity"),
    "correlation_status": ("1", "whether the errors have a correlation, or why not"),
    "sample_status": ("1", "whether the sample is used, or why not"),
    "chi_square_status": ("1", "whether the misfit is known, or why not"),
    "rest_scatter_status": ("1", "whether the scatter at rest is looked at"),
    "smallest_step_status": ("1", "whether the recorder's smallest step is seen"),
    "trip_systematic_status": (
        "1",
        "whether the round trip's systematic error is known",
    ),
    "ray_slope_status": ("1", "whether there is a phase slope by rays, or why not"),
    "edge_jump_status": ("1", "whether the turn of the phase is known, or why not"),
    "local_change_status": (
        "1",
        "whether the change of the local slope is known, or why not",
    ),
    "configured_change_status": (
        "1",
        "whether that by the run's estimator is known, or why not",
    ),
    "noise_status": (
        "1",
        "whether the noise of the slope's change is known, or why not",
    ),
    "local_noise_status": (
        "1",
        "whether the noise of the local change is known, or why not",
    ),
    "configured_noise_status": (
        "1",
        "whether that by the run's estimator is, or why not",
    ),
    "phase_change_status": (
        "1",
        "whether the change of the phase is known, or why not",
    ),
    "slope_change_status": (
        "1",
        "whether the local slope's change is known there, or why not",
    ),
    "baseline_status": ("1", "whether the slope as configured is known, or why not"),
    "baseline_configured_status": (
        "1",
        "whether that by the run's estimator is known, or why not",
    ),
    "pair_change_status": (
        "1",
        "of a pair: whether the slope's change is known, or why not",
    ),
    "pair_local_change_status": (
        "1",
        "of a pair: whether the local change is known, or why not",
    ),
    "pair_configured_change_status": (
        "1",
        "of a pair: whether the estimator's change is, or why not",
    ),
    "pair_excess_status": (
        "1",
        "whether what a pair has beyond the sum is known, or why not",
    ),
    "criterion_status": ("1", "whether the criterion finds a focus, or why not"),
    "criterion_error_status": (
        "1",
        "whether the error at that focus is known, or why not",
    ),
}
