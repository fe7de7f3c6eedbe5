"""Rows of the catalog: what the thesis suggests or explains, and does not simulate."""

from octsim.datasets.stage import Figure, Stage

_LIT = (
    "scene", "objective", "beam", "polarisation", "detector", "tracing", "spectrum", "sweep",
    "processing",
)  # fmt: skip
OF_THE_THESIS = (
    Stage(
        "diffraction", "octsim.studies.diffraction.study:diffraction",
        "Compare rays that are defocused on purpose with Maxwell's equations",
        reads=(*_LIT, "interferometer", "focus_scan"), beside=True,
        plates=True, summary="octsim.studies.diffraction.study:summary",
        figures=(
            Figure("diffraction", "octsim.figures.diffraction:diffraction_figure",
                   "the diffraction limit by defocus, beside Maxwell's equations"),
        ),
    ),
    Stage(
        "interferometers", "octsim.studies.interferometers.study:interferometers",
        "Measure a Michelson interferometer and plates",
        reads=_LIT, beside=True,
        plates=True, summary="octsim.studies.interferometers.study:summary",
        figures=(
            Figure("michelson", "octsim.figures.interferometers:michelson_figure",
                   "a Michelson interferometer: its spectrum, and a moved mirror"),
            Figure("plates", "octsim.figures.interferometers:plates_figure",
                   "plates: their spectra, transforms and phase slopes"),
        ),
    ),
)  # fmt: skip
