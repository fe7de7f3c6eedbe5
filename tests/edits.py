"""Every key of a run's config, edited, and the jobs that are made anew for it."""

from typing import Any

EVERYTHING = {
    "focus_scan", "focus_sweep", "focus_law", "detections", "spectra", "phase_slope", "figures",
}  # fmt: skip
FITTED = EVERYTHING - {"focus_scan"}
SWEPT = {"detections", "spectra", "phase_slope", "figures"}
PROCESSED = {"phase_slope", "figures"}
EDITS: dict[str, tuple[Any, set[str], set[str]]] = {
    "run": ("other", EVERYTHING, EVERYTHING),
    "scene.refractive_index.glass": (1.53, EVERYTHING, EVERYTHING),
    "scene.refractive_index.water": (1.34, EVERYTHING, EVERYTHING),
    "scene.refractive_index.neuron": (1.38, EVERYTHING, EVERYTHING),
    "scene.gap": ("6 nm", EVERYTHING, EVERYTHING),
    "scene.layers": (["water", "glass"], EVERYTHING, EVERYTHING),
    "scene.cylinders": ([{"medium": "neuron", "gap": "6 nm"}], EVERYTHING, EVERYTHING),
    "objective.numerical_aperture": (1.1, EVERYTHING, EVERYTHING),
    "objective.focus_distance": ("310 um", EVERYTHING, EVERYTHING),
    "objective.magnification": (21, EVERYTHING, EVERYTHING),
    "objective.zernike_rays": ("phase", EVERYTHING, EVERYTHING),
    "beam.wavelength": ("755 nm", EVERYTHING, EVERYTHING),
    "detector.core_diameter": ("4 um", EVERYTHING, EVERYTHING),
    "detector.falloff": ("top_hat", EVERYTHING, EVERYTHING),
    "detector.fibre_na": (0.12, EVERYTHING, EVERYTHING),
    "tracing.scheme": ("paths", EVERYTHING, EVERYTHING),
    "tracing.accuracy": (1e-3, set(), set()),  # of the scheme paths
    "tracing.rays": (201, EVERYTHING, EVERYTHING),
    "tracing.max_intersections": (10, EVERYTHING, EVERYTHING),
    "tracing.min_amplitude": (1e-4, EVERYTHING, EVERYTHING),
    "spectrum.wavelength.min": ("660 nm", EVERYTHING, EVERYTHING - {"detections"}),
    "spectrum.wavelength.max": ("890 nm", EVERYTHING, EVERYTHING - {"detections"}),
    "spectrum.samples": (999, EVERYTHING, EVERYTHING - {"detections"}),
    "spectrum.source": (
        {"gaussian": {"centre": "775 nm", "fwhm": "150 nm"}},
        EVERYTHING,
        EVERYTHING - {"detections"},
    ),
    "focus_scan.diameter": ("2.1 um", {"focus_scan", "figures"}, {"focus_scan", "figures"}),
    "focus_scan.focus": ({"num": 6}, {"focus_scan", "figures"}, {"focus_scan", "figures"}),
    "focus_law.diameters": ({"num": 4}, FITTED, {"focus_sweep", "focus_law", "figures"}),
    "focus_law.fraction": ({"num": 10}, FITTED, {"focus_sweep", "focus_law", "figures"}),
    "sweep.diameters": ({"num": 10}, SWEPT, SWEPT),
    "sweep.focus": ({"slope": 0.5, "intercept": "0.1 um"}, SWEPT, SWEPT),
    "grid.combine": ("zip", set(), set()),
    "cache.file": ("other", set(), set()),
    "cache.gigabytes": (1, set(), set()),
    "budget.cpu_hours": (2, set(), set()),
    "budget.disk_gigabytes": (21, set(), set()),
    "scatter.minutes": (1e-5, set(), set()),
    "processing.estimator": ("sinusoid", PROCESSED, PROCESSED),
    "processing.centre": ("mean", PROCESSED, PROCESSED),
    "processing.centre_degree": (2, PROCESSED, PROCESSED),
    "processing.window": (["kaiser", 4.0], PROCESSED, PROCESSED),
    "processing.depth": ("peak", PROCESSED, PROCESSED),
    "processing.read_noise": (2.0, PROCESSED, PROCESSED),
    "processing.sinusoid.offset_degree": (2, PROCESSED, PROCESSED),
    "processing.sinusoid.amplitude_degree": (2, PROCESSED, PROCESSED),
    "processing.sinusoid.depth": ("fitted", PROCESSED, PROCESSED),
    "processing.sinusoid.weights": ("shot", PROCESSED, PROCESSED),
    "processing.sinusoid.envelope": ("common", PROCESSED, PROCESSED),
    "processing.hilbert.band": (0.4, PROCESSED, PROCESSED),
    "processing.esprit.poles": (5, PROCESSED, PROCESSED),
}
"""By key: its edited value, what is made anew under the fitted law, and at a given focus."""


def edit_of(key: str) -> dict[str, Any]:
    """Return the edit of a key as an overlay."""
    edit: Any = EDITS[key][0]
    for name in reversed(key.split(".")):
        edit = {name: edit}
    return dict(edit)
