"""The catalog: every dataset of a run, from first to last, and those beside it.

    config ─┬─ focus_scan
            ├─ focus_sweep ─ gaussian_fits ─ focus_law ─┐      (where sweep.focus is law)
            └─────────────────────── detections or fields ─┬─ spectra ─ fourier ─ phase_slope
                                                           └─ paths

A dataset is a row: what it follows from, what makes it, what is drawn from it. The workflow, the
digests, the axes of a grid, the archive and the command line all read this table.
"""

from collections.abc import Mapping

from octsim.config.following import fitted_diameters, scan_foci
from octsim.config.models import Config
from octsim.datasets.catalog_of_neurons import CALIBRATED, COMPARED, OF_NEURONS
from octsim.datasets.catalog_of_thesis import OF_THE_THESIS
from octsim.datasets.stage import COUNTED, LIGHT, RAYS, SUMMING, Figure, Stage
from octsim.schemes.table import SCHEMES


def _rows(light: str, config: Config, rows: int) -> int:
    """Return how many rows a stage traces that is for schemes of one kind of light."""
    return rows if SCHEMES[config.tracing.scheme].light == light else 0


_RUN = (
    Stage(
        "focus_scan", "octsim.stages.focus_scan:focus_scan",
        "Scan the focus for one diameter",
        reads=(LIGHT, *COUNTED, "spectrum", "focus_scan"),
        points=lambda config: (scan_foci(config).num, 1),
        figures=(
            Figure("figure_6", "octsim.figures.focus_scan:figure_6",
                   "detected rays and intensity over the focus"),
        ),
    ),
    Stage(
        "focus_sweep", "octsim.stages.focus_sweep:focus_sweep",
        "Measure the intensity over the focus for the diameters of the focus law",
        reads=(LIGHT, "spectrum", "focus_law"),
        # a diameter's foci are one row of the dataset
        points=lambda config: (fitted_diameters(config).num, config.focus_law.fraction.num),
    ),
    Stage(
        "gaussian_fits", "octsim.stages.gaussian_fits:gaussian_fits",
        "Fit a Gaussian over the focus of each diameter",
        after=("focus_sweep",), job="focus_law",
        doubts="octsim.stages.centres:doubts_of_fits",
    ),
    Stage(
        "ray_focus_sweep", "octsim.stages.ray_focus_sweep:ray_focus_sweep",
        "Measure the intensity over the focus by light paths too",
        reads=(RAYS, "spectrum", "focus_law"),
        points=lambda config: (
            _rows("waves", config, fitted_diameters(config).num), config.focus_law.fraction.num
        ),
        light="waves",
    ),
    Stage(
        "focus_law", "octsim.stages.focus_law:focus_law",
        "Fit the focus law through their centres",
        after=("gaussian_fits", "ray_focus_sweep"), job="focus_law",
        doubts="octsim.stages.centres:doubts",
        figures=(
            Figure("figure_7", "octsim.figures.focus_law:figure_7",
                   "foci of greatest intensity, and the line through them",
                   of=("gaussian_fits", "focus_law")),
        ),
    ),
    Stage(
        "detections", "octsim.stages.detections:detections",
        "Trace the sweep over diameters",
        reads=(LIGHT, "sweep"), after=("focus_law",),
        points=lambda config: (_rows("rays", config, config.sweep.diameters.num), 1),
        light="rays", sums=False,
    ),
    Stage(
        "fields", "octsim.stages.fields:fields",
        "Solve Maxwell's equations for the sweep over diameters",
        reads=(LIGHT, "sweep"), after=("focus_law",),
        points=lambda config: (_rows("waves", config, config.sweep.diameters.num), 1),
        light="waves", sums=False,
    ),
    Stage(
        "spectra", "octsim.stages.spectra:spectra",
        "Turn the detected light into spectra",
        reads=("spectrum", SUMMING), after=("detections", "fields"), job="spectra",
        doubts="octsim.stages.spectra:doubts", per_sample=(2e-7, 8.0),
        figures=(
            Figure("figure_8", "octsim.figures.spectra:figure_8",
                   "a spectrum on its way to its Fourier transform"),
            Figure("scene", "octsim.figures.scene:scene_figure",
                   "the scene to scale, with rays of its strongest light paths"),
            Figure("aperture", "octsim.figures.aperture:aperture_figure",
                   "the aperture, each ray coloured by the light path that it comes back on"),
        ),
    ),
    Stage(
        "paths", "octsim.stages.paths:light_paths",
        "Share their intensity out among the light paths",
        reads=("spectrum.wavelength",), after=("detections", "fields"), job="spectra",
        figures=(
            Figure("paths", "octsim.figures.paths:figure_paths",
                   "what each light path has in the spectra"),
        ),
    ),
    Stage(
        "fourier", "octsim.stages.fourier:fourier",
        "Transform the spectra",
        reads=("processing",), after=("spectra",), job="phase_slope",
        doubts="octsim.stages.fourier:doubts",
        figures=(
            Figure("figure_9", "octsim.figures.fourier:figure_9",
                   "Fourier transform of a spectrum"),
            Figure("figure_10", "octsim.figures.fourier:figure_10",
                   "magnitude of the components over the diameter",
                   of=("fourier", "phase_slope")),
            Figure("figure_11", "octsim.figures.fourier:figure_11",
                   "phase of the components over the diameter",
                   of=("fourier", "phase_slope")),
        ),
    ),
    Stage(
        "phase_slope", "octsim.stages.phase_slope:phase_slope",
        "Differentiate their phase over the diameter",
        reads=("processing", "scene"), after=("fourier", "spectra"),
        job="phase_slope", summary="octsim.stages.beside_maxwell:summary",
        per_sample=(1e-7, 12.0),  # magnitude, phase and slopes of half as many components
        figures=(
            Figure("figure_12", "octsim.figures.phase_slope:figure_12",
                   "phase slope over the diameter"),
            Figure("grid", "octsim.figures.grid:figure_grid",
                   "phase slope across the grid",
                   without=("component_phase_slope", "component_slope_status"), over_grid=True),
        ),
    ),
)  # fmt: skip

_BESIDE = (
    Stage(
        "stability", "octsim.studies.stability.study:stability",
        "Measure rounding at the extremes against 50 digits",
        reads=(LIGHT, *COUNTED, "spectrum", "sweep"), beside=True,
        summary="octsim.studies.stability.study:summary",
        figures=(
            Figure("stability", "octsim.figures.stability:stability_figure",
                   "errors of rounding at the extremes"),
        ),
    ),
    Stage(
        "tradeoff", "octsim.studies.tradeoff.study:tradeoff",
        "Measure error and cost, one setting after the other",
        reads=(*COMPARED, "polarisation", "focus_law"), beside=True,
        summary="octsim.studies.tradeoff.study:summary",
        figures=(
            Figure("tradeoff", "octsim.figures.tradeoff:tradeoff_figure",
                   "error over cost of each setting"),
            Figure("truth", "octsim.figures.tradeoff:truth_figure",
                   "error from Maxwell's equations over time"),
        ),
    ),
    Stage(
        "validity", "octsim.studies.validity.study:validity",
        "Compare rays with Maxwell's equations, one quantity varied at a time",
        reads=(*COMPARED, "polarisation"), after=("focus_law",), beside=True,
        plates=True, summary="octsim.studies.validity.study:summary",
        figures=(
            Figure("validity", "octsim.figures.validity:validity_figure",
                   "where rays are within 1, 3 and 10 % of Maxwell's equations"),
        ),
    ),
    *OF_THE_THESIS,
    Stage(
        "causes", "octsim.studies.causes.study:causes",
        "Tell what makes the phase slope scatter, and spike",
        reads=(LIGHT, "spectrum", "sweep", "processing"), after=("focus_law",), beside=True,
        summary="octsim.studies.causes.study:summary",
        figures=(
            Figure("causes", "octsim.figures.causes:causes_figure",
                   "what makes the phase slope scatter"),
            Figure("spike", "octsim.figures.causes:spike_figure",
                   "what makes the phase slope spike"),
        ),
    ),
    Stage(
        "estimators", "octsim.studies.estimators.study:estimators",
        "Compare the estimators of the phase",
        reads=COMPARED, after=("focus_law",), beside=True,
        summary="octsim.studies.estimators.study:summary",
        figures=(
            Figure("estimators", "octsim.figures.estimators:estimators_figure",
                   "estimators of the phase compared"),
        ),
    ),
    Stage(
        "calibration", "octsim.studies.calibration.study:calibration",
        "Differentiate the phase over the diameter at a fixed focus and gap",
        reads=CALIBRATED, after=("focus_law",), beside=True,
        summary="octsim.studies.calibration.told:summary",
        doubts="octsim.studies.calibration.told:doubts",
        figures=(
            Figure("calibration", "octsim.figures.calibration:calibration_figure",
                   "phase slope at a fixed focus, and what makes its error"),
        ),
    ),
    *OF_NEURONS,
    Stage(
        "expansion", "octsim.studies.calibration.expansion:expansion_of_series",
        "Turn a measured series of phases into nanometres",
        # a calibration, or responses where more than the diameter is fitted
        reads=("expansion", "measured.average"),
        after=("calibration", "responses", "measured", "match"), beside=True,
        summary="octsim.studies.calibration.expansion:summary",
        doubts="octsim.studies.calibration.expansion:doubts",
        figures=(
            Figure("expansion", "octsim.figures.expansion:expansion_figure",
                   "expansion that a measured series comes to, with its errors"),
        ),
    ),
    Stage(
        "action_potential", "octsim.studies.calibration.action_potential:action_potential",
        "Simulate an action potential and recover it",
        reads=(*CALIBRATED, "action_potential"), after=("calibration", "focus_law"),
        beside=True,
        summary="octsim.studies.calibration.action_potential:summary",
        figures=(
            Figure("action_potential", "octsim.figures.action_potential:action_potential_figure",
                   "an action potential that is recovered, with its errors",
                   of=("action_potential", "calibration")),
        ),
    ),
    Stage(
        "detector", "octsim.studies.detector.study:detector",
        "Compare falloffs and radii of the detector",
        reads=(*COMPARED, "polarisation", "beam", "interferometer"), after=("focus_law",),
        beside=True,
        summary="octsim.studies.detector.recommended:summary",
        doubts="octsim.studies.detector.recommended:doubts",
        figures=(
            Figure("detector", "octsim.figures.detector:detector_figure",
                   "ray noise, jumps and distance from Maxwell's, over falloff and radius"),
        ),
    ),
    Stage(
        "effects", "octsim.studies.effects.study:effects",
        "Measure what each effect changes, alone and in pairs, and what it costs",
        reads=(LIGHT, "polarisation", "interferometer", "spectrum", "sweep", "processing"),
        after=("focus_law",), beside=True,
        summary="octsim.studies.effects.needed:summary",
        doubts="octsim.studies.effects.needed:doubts",
        figures=(
            Figure("effects", "octsim.figures.effects:effects_figure",
                   "what each effect changes of the phase slope and the spectrum, and its cost"),
        ),
    ),
    Stage(
        "design", "octsim.studies.design.study:design",
        "Search fill, focus, aperture and band for the least error of an expansion",
        # by scheme fullwave, whatever the run's
        reads=("scene", "objective", "polarisation", "spectrum", "calibration", "design",
               "sweep.focus"),
        after=("focus_law",), beside=True,
        summary="octsim.studies.design.study:summary",
        doubts="octsim.studies.design.study:doubts",
        figures=(
            Figure("design", "octsim.figures.design:design_figure",
                   "how well an expansion is known, over fill, focus, aperture and band"),
        ),
    ),
)  # fmt: skip

CATALOG: Mapping[str, Stage] = {row.name: row for row in (*_RUN, *_BESIDE)}
"""Every dataset by its name, in the order in which they are made."""
STAGES = tuple(row.name for row in _RUN)
"""Datasets of a run, in the order that light meets them."""
TARGETS = tuple(row.name for row in _BESIDE)
"""Datasets beside a run."""


def jobs(beside: bool) -> dict[str, tuple[Stage, ...]]:
    """Return the jobs of a run, or those beside it, and the datasets that each makes."""
    found: dict[str, tuple[Stage, ...]] = {}
    for row in CATALOG.values():
        if row.beside == beside:
            found[row.rule] = (*found.get(row.rule, ()), row)
    return found
