"""What each variable of `detector.nc` is, and its unit: the detector's falloff and radius."""

from collections.abc import Mapping

DETECTOR: Mapping[str, tuple[str, str]] = {
    # name: (units, long_name)
    "falloff": ("1", "falloff of the detected amplitude"),
    "detector_radius": ("um", "radius R_det of the fibre core's image at the focus"),
    "fibre_core_diameter": ("um", "diameter of the fibre's core with that image"),
    "limit_status": ("1", "whether it is known what counted rays come to as they become more"),
    "line_slope": ("mrad/nm", "slope of the line through the phase, by rays"),
    "slope_scatter": ("mrad/nm", "local phase slope less that of the line, rms, by rays"),
    "signal": ("1", "intensity by rays, mean over band and diameters"),
    "ray_noise": ("mrad/nm", "phase slope by counted rays less that by light paths, rms"),
    "phase_jump": (
        "rad",
        "second difference over the diameter of what the phases differ by",
    ),
    "edge_jump": ("rad", "turn of the phase as rays enter or leave while the diameter grows 1 nm"),
    "edge_phase_jump": ("mrad/nm", "that turn, rms over the diameters"),
    "edge_rays": ("1", "rays that enter or leave the detector as the diameter grows by 1 nm, mean"),
    "edge_amplitude": ("1", "sum of their amplitudes over that of all that are detected, mean"),
    "outermost_amplitude": ("1", "share of the amplitudes beyond 0.9 of the reach, mean"),
    "mean_rays_detected": ("1", "number of rays detected, mean over the diameters"),
    "effective_rays": ("1", "number of rays of one amplitude that would count as much, mean"),
    "sweep_maxwell_phase_slope": ("mrad/nm", "phase slope by Maxwell's equations over the sweep"),
    "maxwell_line_slope": ("mrad/nm", "slope of the line through the phase by Maxwell's equations"),
    "maxwell_slope_scatter": ("mrad/nm", "local phase slope by them less that of the line, rms"),
    "maxwell_accuracy_status": ("1", "whether the accuracy asked for is reached by them"),
    "slope_difference": ("mrad/nm", "phase slope by rays less that by Maxwell's equations, rms"),
    "slope_bias": ("mrad/nm", "phase slope by rays less that by Maxwell's equations, mean"),
    "shape_difference": ("1", "spectrum over its mean, by rays less that by Maxwell's, rms"),
}
