"""How true the accuracy is that scheme paths states: random points beside dense grids of rays.

    python benchmarks/accuracy_of_paths.py [POINTS STEEP] [--seed TEXT] [--write]

Points are drawn anew by the hash of the commit; `--write` puts the table into docs/paths.md. What
is drawn is asked for, traced by scheme paths, and compared with `dense_grids.dense_field`.
"""

import argparse
import time
from concurrent.futures import ProcessPoolExecutor
from typing import NamedTuple

import numpy as np
import pandas as pd
from dense_grids import dense_field
from drawn_points import ROOT, add_options, judged, seeded
from marked import write_part

from octsim.optics.detector import fibre_detector
from octsim.optics.materials import Constant
from octsim.optics.scene import neuron_on_glass
from octsim.schemes.paths.integrate import integrate
from octsim.schemes.paths.path_sum import field_of_paths

DOCS = ROOT / "docs/paths.md"
BAND = 2e3 * np.pi / 900, 2e3 * np.pi / 650
WAVENUMBERS = np.linspace(*BAND, 65)
FOCUS_DISTANCE, MAGNIFICATION = 300.0, 20.0


class Drawn(NamedTuple):
    """A point, and the accuracy that is asked of it; lengths in µm."""

    glass: float
    water: float
    neuron: float
    gap: float
    numerical_aperture: float
    core: float
    diameter: float
    focus: float
    accuracy: float


def draw(generator: np.random.Generator, steep: bool) -> Drawn:
    """Draw a point; half of them with the thesis's indices."""
    glass, water, neuron = 1.52, 1.33, 1.39
    if generator.random() < 0.5:
        glass = generator.uniform(1.45, 1.54)
        water = generator.uniform(1.31, 1.38)
        neuron = water + generator.uniform(0.003, 0.12)
    aperture = generator.uniform(0.92, 0.985) * water if steep else generator.uniform(0.3, 1.25)
    diameter = float(np.exp(generator.uniform(np.log(0.3), np.log(8))))
    gap = generator.uniform(0, 0.5)
    return Drawn(
        glass, water, neuron, gap, aperture, generator.uniform(2, 9), diameter,
        diameter * generator.uniform(0, 1.3), 10 ** generator.uniform(-5, -2),
    )  # fmt: skip


def measured(point: Drawn) -> dict[str, float]:
    """Return what scheme paths states of a point, and how far it is from dense grids."""
    scene = neuron_on_glass(
        Constant(point.glass), Constant(point.water), Constant(point.neuron), point.gap,
        point.diameter,
    )  # fmt: skip
    detector = fibre_detector(
        point.numerical_aperture, point.glass, FOCUS_DISTANCE, MAGNIFICATION, point.core
    )
    begin = time.process_time()
    light = integrate(scene, detector, point.focus, BAND, point.accuracy)
    seconds = time.process_time() - begin
    field = field_of_paths(
        light.path, light.amplitude, light.rough_amplitude, light.optical_path_length,
        light.missing, WAVENUMBERS, point.accuracy,
    )  # fmt: skip
    dense = dense_field(scene, detector, point.focus, WAVENUMBERS, point.accuracy)
    intensity, truth = np.abs(field.values) ** 2, np.abs(dense.field) ** 2
    largest, size = truth.max(), np.abs(dense.field).max()
    return {
        **point._asdict(), "status": int(light.status), "segments": light.segments,
        "seconds": seconds,
        "stated": float((2 * np.abs(field.values) * field.error).max() / intensity.max()),
        "true": float(np.abs(intensity - truth).max() / largest),
        "reference_error": float(2 * dense.error / size),
    }  # fmt: skip


def rows_of(table: pd.DataFrame, name: str) -> list[str]:
    """Return the rows of the docs' table for some points."""
    off = (table.true / table.accuracy)[table.reached]
    return [
        f"| {name} | {len(table)} | {table.wrong.sum()} | {table.open.sum()} "
        f"| {table.warned.sum()} | {table.unsure.sum()} | {off.median():.2g} | {off.max():.2g} |"
    ]


def main() -> None:
    """Measure, print and, if asked, write the docs' table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("points", type=int, nargs="?", default=1000)
    parser.add_argument("steep", type=int, nargs="?", default=300)
    add_options(parser)
    asked = parser.parse_args()
    seed, generator = seeded(asked.seed)
    points = [draw(generator, False) for _ in range(asked.points)]
    steep = [draw(generator, True) for _ in range(asked.steep)]
    with ProcessPoolExecutor(2) as pool:
        table = judged(pd.DataFrame(list(pool.map(measured, points + steep, chunksize=4))))
    table["steep"] = np.arange(len(table)) >= asked.points
    if asked.table:
        table.to_csv(asked.table, index=False)
    lines = [
        f"Seed {seed[:12]}; asked for 1e-5 to 1e-2.", "",
        "| points | drawn | worse than asked, `reached` | the same, within the grids' own error "
        "| worse, and said so | right, and not sure | median error over asked "
        "| largest of those `reached` |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
        *rows_of(table[~table.steep], "NA 0.3 to 1.25"),
        *rows_of(table[table.steep], "NA 0.92 to 0.985 of the index of water"),
    ]  # fmt: skip
    print("\n".join(lines))
    print(table[table.wrong | table.open | table.warned].to_string())
    if asked.write:
        write_part(DOCS, "accuracy", lines)


if __name__ == "__main__":
    main()
