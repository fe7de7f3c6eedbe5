"""Write the parts of the docs that are made: numbers from datasets, keys from the models.

Run by `make docs`, after `make results`.
"""

import shutil
from pathlib import Path

import xarray as xr

import octsim

DOCS = Path(__file__).parent
RESULTS = DOCS.parent / "results" / "thesis"
CORES = ("4.0 um", "4.2 um", "4.4 um", "4.6 um", "4.8 um", "5.0 um")
SUMMARY = (
    "mean_phase_slope", "phase_slope_standard_deviation", "standard_deviation_from_ideal",
    "largest_deviation", "largest_deviation_diameter",
)  # fmt: skip


def table(head: list[str], rows: list[list[str]]) -> str:
    """Write a Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def summary(law: xr.Dataset, slopes: xr.Dataset) -> list[str]:
    """Give the focus law and the summary figures of a run as text."""
    figures = [f"{float(slopes[name]):.3f}" for name in SUMMARY]
    return [f"{float(law['slope']):.4f}", f"{1000 * float(law['intercept']):.1f}", *figures]


def run(core: str) -> list[str]:
    """Run the thesis's config with another fibre core."""
    config = octsim.load_config({"detector": {"core_diameter": core}})
    law = octsim.focus_law(config, octsim.gaussian_fits(config, octsim.focus_sweep(config, 2)))
    spectra = octsim.spectra(config, octsim.detections(config, law, 2))
    radius = config.detector.core_diameter / (2 * config.objective.magnification)
    slopes = octsim.phase_slope(config, octsim.fourier(config, spectra))
    return [f"{radius:.3f}", *summary(law, slopes)]


def results() -> str:
    """Write the page of the thesis's numbers."""
    stored = {
        stage: xr.load_dataset(RESULTS / f"{stage}.nc") for stage in ("focus_law", "phase_slope")
    }
    law, slopes = stored["focus_law"], stored["phase_slope"]

    def value(dataset: xr.Dataset, name: str, digits: int) -> str:
        return f"{float(dataset[name]):.{digits}f}"

    ideal = [
        value(slopes, name, 3)
        for name in ("mean_ideal_phase_slope", "ideal_phase_slope_standard_deviation")
    ]
    spread, off = "phase_slope_standard_deviation", "standard_deviation_from_ideal"
    thesis = [
        ["focus law, slope", "0.581", value(law, "slope", 4)],
        ["focus law, intercept (µm)", "0.069", value(law, "intercept", 4)],
        ["prediction (mrad/nm)", "23.14", value(slopes, "predicted_phase_slope", 3)],
        ["mean phase slope (mrad/nm)", "very close", value(slopes, "mean_phase_slope", 3)],
        ["scatter about the mean (mrad/nm)", "0.23", value(slopes, spread, 3)],
        ["scatter from the ideal slope (mrad/nm)", "0.19", value(slopes, off, 3)],
        ["largest spike at (µm)", "~1.15", value(slopes, "largest_deviation_diameter", 3)],
        ["ideal slope, mean ± scatter (mrad/nm)", "", " ± ".join(ideal)],
    ]
    head = [
        "R_det (µm)", "law, slope", "law, intercept (nm)", "mean slope", "scatter", "from ideal",
        "largest deviation", "at (µm)",
    ]  # fmt: skip
    return (TEMPLATE).format(
        thesis=table(["quantity", "thesis", "octsim"], thesis),
        radii=table(head, [run(core) for core in CORES]),
    )


TEMPLATE = """# The thesis's numbers

Written by `make docs` from `results/thesis/`; do not edit.

{thesis}
## What the detector's radius does

The thesis does not give the radius of the detector's image, R_det. The default is that of a fibre
with a 4.4 µm core at 20×. With everything else the thesis's, slopes in mrad/nm:

{radii}
The law's intercept and the scatter grow with R_det, which decides how much of the light off the
axis counts. No one radius gives all of the thesis's values at once: its law is that of the largest
radius of the table, its scatters are those of radii between 0.105 and 0.115 µm.
"""


if __name__ == "__main__":
    (DOCS / "results.md").write_text(results(), encoding="utf-8")
    (DOCS / "figures").mkdir(exist_ok=True)
    shutil.copy(RESULTS / "figures" / "figure_12.png", DOCS / "figures" / "figure_12.png")
