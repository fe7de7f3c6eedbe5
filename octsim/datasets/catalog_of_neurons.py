"""Rows of the catalog: what is in and around a neuron, and what may change in it."""

from octsim.datasets.stage import Figure, Stage

COMPARED = ("scene", "objective", "detector", "tracing", "spectrum", "sweep", "processing")
"""Keys that what is compared with other schemes or scenes reads."""
CALIBRATED = (
    "tracing.min_amplitude", "scene", "objective", "detector", "tracing.max_intersections",
    "polarisation", "spectrum", "processing", "calibration", "sweep.focus",
)  # fmt: skip
"""Keys that what is of spectra as accurate as small steps need reads, whatever the scheme."""
OF_NEURONS = (
    Stage(
        "measured", "octsim.studies.measured.study:measured",
        "Read a spectrometer's spectra, and estimate the phase of each",
        reads=("measured", "spectrum", "processing", "calibration.estimator",
               "expansion.diameter", "scene"),
        beside=True, plates=True,
        summary="octsim.studies.measured.study:summary",
        doubts="octsim.studies.measured.study:doubts",
        figures=(
            Figure("measured", "octsim.figures.measured:measured_figure",
                   "measured spectra, what is fitted to their mean, and their phases"),
        ),
    ),
    Stage(
        "match", "octsim.studies.match.study:match_of_spectra",
        "Fit the model to the mean of measured spectra",
        reads=("scene", "objective", "polarisation", "spectrum", "calibration", "expansion",
               "sweep.focus", "tracing.max_intersections"),
        after=("measured", "calibration", "focus_law"), beside=True,
        summary="octsim.studies.match.study:summary",
        doubts="octsim.studies.match.study:doubts",
        figures=(
            Figure("match", "octsim.figures.match:match_figure",
                   "a measured spectrum beside the modelled ones, and what fits best"),
        ),
    ),
    Stage(
        "scenes", "octsim.studies.scenes.study:scenes",
        "Compare scenes about the configured one: myelin, membranes, neighbours, a tilt, a cover",
        reads=(*COMPARED, "beam", "polarisation", "interferometer"), after=("focus_law",),
        beside=True,
        summary="octsim.studies.scenes.study:summary",
        figures=(
            Figure("scenes", "octsim.figures.scenes:scenes_figure",
                   "what myelin, membranes, neighbours, a tilt and a cover glass do to the slope"),
        ),
    ),
    Stage(
        "responses", "octsim.studies.responses.study:responses",
        "Differentiate phases and spectra by all that may change in a neuron",
        reads=(*CALIBRATED, "responses", "expansion.diameter", "expansion.bands",
               "action_potential.photons", "action_potential.seed"),
        after=("focus_law",), beside=True,
        summary="octsim.studies.responses.told:summary",
        doubts="octsim.studies.responses.told:doubts",
        figures=(
            Figure("responses", "octsim.figures.responses:responses_figure",
                   "phase responses to all that may change, and what tells them apart"),
        ),
    ),
)  # fmt: skip
