"""Which status says of a variable why values are missing, as CF's ancillary variables."""

from collections.abc import Mapping, Sequence
from enum import IntEnum

import numpy as np
import xarray as xr
from numpy.typing import NDArray


class MeanStatus(IntEnum):
    """Whether there is a mean, or another number of several values."""

    KNOWN = 0
    TOO_FEW = 1
    """Fewer of the values are known than it takes; their own statuses say why."""


TOLD_BY: Mapping[str, Mapping[str, str]] = {
    # stage: {status: variables whose NaN it explains}
    "focus_scan": {"accuracy_status": "intensity intensity_error"},
    "focus_sweep": {"accuracy_status": "intensity intensity_error"},
    "ray_focus_sweep": {"accuracy_status": "intensity intensity_error"},
    "gaussian_fits": {
        "status": "centre width amplitude offset residual relative_residual brightest_focus",
        "standard_error_status": (
            "centre_standard_error width_standard_error amplitude_standard_error "
            "offset_standard_error"
        ),
    },
    "focus_law": {
        "law_status": "slope intercept slope_standard_error intercept_standard_error",
        "status": "brightest_focus law_centre",
        "standard_error_status": "law_centre law_centre_standard_error",
    },
    "detections": {
        "accuracy_status": "focus field_error",
        "field_status": "field_real field_imaginary",
    },
    "fields": {
        "accuracy_status": "focus removed_optical_path_length azimuth field_error",
        "node_status": "real imaginary term_real term_imaginary node_wavenumber",
    },
    "spectra": {"accuracy_status": "intensity intensity_error focus"},
    "paths": {"path_status": "field_phase mean_optical_path_length"},
    "fourier": {
        "phase_status": "phase magnitude",
        "fringe_status": "fringe_visibility",
        "estimate_status": "estimated_phase estimated_depth",
    },
    "phase_slope": {
        "slope_status": "phase_slope",
        "component_slope_status": "component_phase_slope",
        "exact_slope_status": "exact_phase_slope",
        "mean_slope_status": (
            "mean_phase_slope phase_slope_standard_deviation standard_deviation_from_ideal "
            "largest_deviation largest_deviation_diameter"
        ),
    },
    "measured": {
        "spectrum_status": (
            "fringe_phase fringe_phase_error visibility snr fit_residual measured_depth"
        ),
        "band_status": "source_power dark_level sample_variance",
    },
    "match": {
        "systematic_status": "fixed_focus_phase_slope_standard_error",
        "matched_systematic_status": "matched_phase_slope_standard_error",
    },
    "stability": {
        "phase_error_status": "phase_error phase_condition phase_share",
        "amplitude_error_status": "amplitude_error amplitude_condition amplitude_share",
        "phase_slope_error_status": "phase_slope_error phase_slope_condition phase_slope_share",
        "spectrum_error_status": "spectrum_error spectrum_condition spectrum_share",
        "launch_error_status": "launch_error launch_condition launch_share",
        "single_error_status": "single_phase_error single_amplitude_error",
        "paths_status": "optical_path_length_error single_lost",
    },
    "tradeoff": {
        "slope_error_status": "phase_slope_rms_error phase_slope_largest_error",
        "maxwell_status": "maxwell_spectrum_worst_error maxwell_spectrum_median_error",
        "maxwell_slope_status": (
            "maxwell_slope_rms_error maxwell_slope_largest_error maxwell_slope_bias"
        ),
        "segments_status": "segments_per_diameter",
        "law_error_status": "law_slope_error law_intercept_error focus_error",
        "intensity_change_status": "intensity_change",
        "rays_law_status": "rays_law_error rays_law_factor rays_law_exponent",
        "target_status": (
            "target_error rays_segments paths_segments segments_ratio paths_segments_between "
            "segments_ratio_between"
        ),
        "effect_status": "effect_cost_ratio effect_intensity_change",
    },
    "validity": {
        "accuracy_status": "intensity_error",
        "fringe_status": (
            "exact_phase_slope ray_slope_error ray_phase_error ray_visibility_error "
            "ray_spectrum_error"
        ),
        "ray_fringe_status": (
            "ray_phase_slope ray_slope_error ray_phase_error ray_visibility_error "
            "ray_spectrum_error"
        ),
        "mean_slope_error_status": "mean_slope_error mean_slope_error_standard_error",
    },
    "diffraction": {"peak_status": "peak_focus peak_width peak_height"},
    "interferometers": {"plates_error_status": "plates_error"},
    "causes": {
        "share_status": (
            "cause_share least_share largest_share share_removed_first share_removed_last "
            "trend_share unexplained_share left_without_leakage left_without_all"
        ),
    },
    "estimators": {
        "slope_status": "phase_slope scatter bias largest_spike largest_spike_diameter",
        "converged_slope_status": (
            "converged_phase_slope converged_scatter converged_bias converged_largest_spike "
            "converged_largest_spike_diameter"
        ),
        "estimator_status": "estimator_seconds",
        "resolution_status": "resolution resolution_over_bound",
        "read_noise_resolution_status": "read_noise_resolution read_noise_resolution_over_bound",
        "misreading_status": "misreading misreading_scatter",
    },
    "calibration": {
        "standard_error_status": (
            "fixed_focus_phase_slope_standard_error diameter_per_phase_standard_error"
        ),
        "budget_status": "budget budget_error",
        "maxwell_slope_status": "maxwell_phase_slope",
        "rays_slope_status": "rays_phase_slope",
        "light_paths_slope_status": "light_paths_phase_slope",
        "near_side_slope_status": "near_side_phase_slope",
        "far_side_slope_status": "far_side_phase_slope",
    },
    "scenes": {
        "case_status": "scene_phase_slope intensity_error",
        "fringe_status": "scene_phase_slope",
        "change_status": "scene_slope_change scene_phase_change",
        "mean_change_status": "scene_mean_change scene_change_scatter scene_worst_change",
        "tolerated_status": "tolerated",
    },
    "responses": {
        "response_status": (
            "phase_response phase_response_difference_error apparent_expansion"
        ),
        "response_error_status": "phase_response_standard_error",
        "shift_status": "phase_response_shift",
        "covariance_status": "phase_noise_covariance",
        "depth_status": "depth",
        "quantity_status": (
            "intensity_response intensity_response_error apparent_expansion_of_shape trial_bias "
            "trial_coverage"
        ),
        "separability": "error_alone error_together",
        "separability_with_other": "error_with_other",
        "correlation_status": "error_correlation",
    },
    "expansion": {
        "sample_status": (
            "measured_phase measured_phase_error phase_change expansion statistical_error "
            "systematic_error change change_statistical_error change_systematic_error "
            "statistical_covariance systematic_covariance"
        ),
        "error_status": "statistical_error change_statistical_error statistical_covariance",
        "systematic_status": (
            "fixed_focus_phase_slope_standard_error systematic_error change_systematic_error "
            "systematic_covariance"
        ),
        "chi_square_status": "reduced_chi_square",
        "rest_scatter_status": "rest_scatter",
        "smallest_step_status": "smallest_step",
    },
    "action_potential": {
        "systematic_status": "systematic_error",
        "trip_systematic_status": "trip_systematic_error",
    },
    "detector": {
        "fringe_status": "line_slope slope_scatter signal shape_difference",
        "ray_slope_status": "ray_phase_slope slope_difference slope_bias",
        "exact_status": "slope_difference slope_bias shape_difference sweep_maxwell_phase_slope",
        "maxwell_slope_status": (
            "slope_difference slope_bias sweep_maxwell_phase_slope maxwell_line_slope "
            "maxwell_slope_scatter"
        ),
        "limit_status": "ray_noise phase_jump intensity_error",
        "edge_jump_status": "edge_jump edge_phase_jump edge_amplitude outermost_amplitude",
    },
    "effects": {
        "effect_status": (
            "spectrum_change shape_change signal_ratio mean_slope_change calibration_change "
            "cost_ratio intensity_error spectrum_change_noise shape_change_noise "
            "signal_ratio_noise"
        ),
        "local_change_status": "slope_change_scatter worst_slope_change",
        "configured_change_status": "configured_slope_change configured_local_change",
        "noise_status": "mean_slope_change_noise calibration_change_noise",
        "local_noise_status": "slope_change_scatter_noise worst_slope_change_noise",
        "configured_noise_status": (
            "configured_slope_change_noise configured_local_change_noise"
        ),
        "phase_change_status": "effect_phase_change",
        "slope_change_status": "effect_slope_change",
        "baseline_status": "baseline_slope baseline_local_scatter",
        "baseline_configured_status": "baseline_configured_slope baseline_configured_scatter",
        "pair_change_status": "pair_mean_slope_change pair_calibration_change",
        "pair_local_change_status": "pair_slope_change_scatter pair_worst_slope_change",
        "pair_configured_change_status": (
            "pair_configured_slope_change pair_configured_local_change"
        ),
        "pair_excess_status": "pair_sum pair_excess pair_local_excess",
    },
    "design": {
        "fringe_status": (
            "phase_slope statistical_error systematic_error total_error rms_error slope_error "
            "least_error fringe_visibility"
        ),
        "criterion_status": "criterion_offset",
        "criterion_error_status": "criterion_error",
    },
}  # fmt: skip
"""By stage, then by status: the variables of that stage whose values it says are missing, and why.
A variable of several statuses is missing where any of them says so."""


def first_reason(
    reasons: Sequence[tuple[NDArray[np.bool_], IntEnum]], otherwise: IntEnum
) -> NDArray[np.int64]:
    """Return the code of the first of some reasons that holds at each place, or another code.

    Parameters
    ----------
    reasons : sequence of tuple
        Where each holds, of shapes that are broadcast together, and its code.
    otherwise : IntEnum
        The code where none does.
    """
    where, codes = zip(*reasons, strict=True)
    found: NDArray[np.int64] = np.select(where, [np.int64(code) for code in codes], otherwise)
    return found


def statuses_of(stage: str, name: str) -> dict[str, str]:
    """Return the attribute of a variable that names its statuses; empty of one without.

    Examples
    --------
    >>> statuses_of("fourier", "phase")
    {'ancillary_variables': 'phase_status'}
    """
    told = [status for status, of in TOLD_BY.get(stage, {}).items() if name in of.split()]
    return {"ancillary_variables": " ".join(told)} if told else {}


def with_statuses(dataset: xr.Dataset, stage: str) -> xr.Dataset:
    """Let the variables of a stage's dataset name the statuses that it has of them."""
    for name, variable in dataset.data_vars.items():
        told = statuses_of(stage, str(name)).get("ancillary_variables", "").split()
        # an older octsim's has not all of them
        if there := [status for status in told if status in dataset]:
            variable.attrs["ancillary_variables"] = " ".join(there)
    return dataset
