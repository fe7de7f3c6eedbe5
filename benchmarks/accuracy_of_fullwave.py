"""How true the accuracy is that scheme fullwave states, and what it costs.

    python benchmarks/accuracy_of_fullwave.py [POINTS] [--seed TEXT] [--write]

Points are drawn anew by the hash of the commit, solved, and compared with
`dense_waves.dense_waves`; then points of 1 to 2 µm are timed, each alone, beside 3000 rays of
scheme vogel, and a scan of 501 foci. `--write` puts both into docs/fullwave.md.
"""

import argparse
import time
from concurrent.futures import ProcessPoolExecutor
from typing import NamedTuple

import numpy as np
import pandas as pd
from dense_waves import Beam, Slide, dense_waves
from drawn_points import ROOT, add_options, judged, seeded
from marked import write_part

from octsim.optics.detector import fibre_detector
from octsim.optics.materials import Constant
from octsim.optics.polarisation import Polarisation
from octsim.optics.pupil import FibrePupil, GaussianPupil, Pupil, UniformPupil
from octsim.optics.scene import Scene, neuron_on_glass
from octsim.schemes.field_sum import relative_error
from octsim.schemes.light import Optics
from octsim.schemes.table import COUNTED_RAYS, FULL_WAVE

DOCS = ROOT / "docs/fullwave.md"
BAND = 2e3 * np.pi / 900, 2e3 * np.pi / 650
WAVENUMBERS = np.linspace(*BAND, 65)
DETECTOR = fibre_detector(1.2, 1.52, 300.0, 20.0, 5.0)
PUPILS: dict[str, Pupil] = {
    "uniform": UniformPupil(), "gaussian": GaussianPupil(1.0), "fibre": FibrePupil(5.0, 20.0),
}  # fmt: skip


class Drawn(NamedTuple):
    """A point, and the accuracy that is asked of it; lengths in µm."""

    glass: float
    water: float
    neuron: float
    gap: float
    diameter: float
    offset: float
    numerical_aperture: float
    focus: float
    pupil: str
    accuracy: float
    first: float
    """Of three wavenumbers that are compared, thirds of the band apart: where in its third."""


def draw(generator: np.random.Generator) -> Drawn:
    """Draw a point; half of them with the thesis's indices, half on the optical axis."""
    glass, water, neuron = 1.52, 1.33, 1.39
    if generator.random() < 0.5:
        glass, neuron = generator.uniform(1.42, 1.6), generator.uniform(1.3, 1.6)
        water = generator.uniform(1.31, 1.38)
    diameter = float(np.exp(generator.uniform(np.log(0.5), np.log(8))))
    aperture = generator.uniform(0.5, min(1.3, 0.985 * water))
    offset = generator.uniform(0, 0.6) * diameter if generator.random() < 0.5 else 0.0
    return Drawn(
        glass, water, neuron, generator.choice([0.0, 0.5]) * generator.random(), diameter, offset,
        aperture, diameter * generator.uniform(-1, 2), str(generator.choice(list(PUPILS))),
        10 ** generator.uniform(-6, -2), generator.random(),
    )  # fmt: skip


def optics_of(aperture: float, pupil: Pupil) -> Optics:
    """Return the thesis's instrument with another aperture and pupil."""
    return Optics(DETECTOR, BAND, 10, aperture, pupil, Polarisation(None, None))


def scene_of(point: Drawn) -> Scene:
    """Return the point's scene."""
    return neuron_on_glass(
        Constant(point.glass), Constant(point.water), Constant(point.neuron), point.gap,
        point.diameter, point.offset,
    )  # fmt: skip


def measured(point: Drawn) -> dict[str, float | str]:
    """Return what scheme fullwave states of a point, and how far it is from dense rules."""
    pupil, options = PUPILS[point.pupil], {"accuracy": point.accuracy}
    optics = optics_of(point.numerical_aperture, pupil)
    begin = time.process_time()
    light = FULL_WAVE.tracer(optics, options)(scene_of(point), point.focus)
    seconds = time.process_time() - begin
    compared = BAND[0] + (BAND[1] - BAND[0]) * (np.arange(3) + point.first) / 3
    asked, every = (FULL_WAVE.field(light, k, optics, options) for k in (compared, WAVENUMBERS))
    slide = Slide(*point[:6])
    largest = (np.abs(every.values) ** 2).mean(axis=0).max()
    beam = Beam(pupil, point.numerical_aperture, point.focus)
    # half a hundredth of the intensity that is asked for
    dense = dense_waves(slide, beam, compared, 5e-3 * point.accuracy * float(np.sqrt(largest)))
    # both are of light polarised across and along; unpolarised light is the mean of intensities
    truth = (np.abs(dense.field) ** 2).mean(axis=0)
    found = (np.abs(asked.values) ** 2).mean(axis=0)
    return {
        **point._asdict(), "status": int(light.status), "seconds": seconds,
        "stated": relative_error(float(np.sqrt(largest)), every.error),
        "true": float(np.abs(found - truth).max() / largest),
        "reference_error": relative_error(float(np.sqrt(largest)), dense.error),
    }  # fmt: skip


def timed() -> list[str]:
    """Return what points take, alone and beside rays, and a scan of foci."""
    pupil, diameters = PUPILS["fibre"], np.linspace(1, 2, 21).tolist()
    optics, accurate = optics_of(1.2, pupil), {"accuracy": 1e-4}
    rays = {"rays": 3000, "min_amplitude": 1e-4}
    scenes = [
        (neuron_on_glass(Constant(1.52), Constant(1.33), Constant(1.39), 0.005, d), 0.581 * d)
        for d in diameters
    ]
    COUNTED_RAYS.tracer(optics, rays)(*scenes[0])  # compiled
    waves_time, rays_time = [], []
    for scene, focus in scenes:
        traced = COUNTED_RAYS.tracer(optics, rays)
        begin = time.process_time()
        traced(scene, focus)
        rays_time.append(time.process_time() - begin)
        begin = time.process_time()
        FULL_WAVE.tracer(optics, accurate)(scene, focus)
        waves_time.append(time.process_time() - begin)
    begin = time.process_time()
    light_at = FULL_WAVE.tracer(optics, accurate)
    for focus in np.linspace(0, 4, 501).tolist():
        light_at(scenes[-1][0], focus)
    scan = time.process_time() - begin
    alone, ray = 1e3 * np.mean(waves_time), 1e3 * np.mean(rays_time)
    return [
        f"Alone, a point of 1 to 2 µm takes {alone:.0f} ms at 1e-4 on one core, {alone / ray:.0f} "
        f"times one of 3000 rays in the same run ({ray:.1f} ms); a scan of 501 foci at 2 µm "
        f"{scan:.1f} s."
    ]


def rows_of(table: pd.DataFrame, name: str) -> str:
    """Return the row of the docs' table for some points."""
    off = (table.true / table.accuracy)[table.reached]
    return (
        f"| {name} | {len(table)} | {table.wrong.sum()} | {table.open.sum()} "
        f"| {table.warned.sum()} | {table.unsure.sum()} | {table.understated.sum()} "
        f"| {off.median():.2g} | {off.max():.2g} | {1e3 * table.seconds.median():.0f} |"
    )


def main() -> None:
    """Measure, print and, if asked, write the docs' table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("points", type=int, nargs="?", default=200)
    add_options(parser)
    asked = parser.parse_args()
    seed, generator = seeded(asked.seed)
    points = [draw(generator) for _ in range(asked.points)]
    with ProcessPoolExecutor(2) as pool:
        rows = []
        for row in pool.map(measured, points):
            rows.append(row)
            if asked.table:  # as they come, as large cylinders take minutes
                judged(pd.DataFrame(rows)).to_csv(asked.table, index=False)
    table = judged(pd.DataFrame(rows))
    if asked.table:
        table.to_csv(asked.table, index=False)
    parts = {
        "0.5 to 2 µm": table.diameter < 2, "2 to 4 µm": table.diameter.between(2, 4),
        "4 to 8 µm": table.diameter > 4,
    }  # fmt: skip
    lines = [
        f"Seed {seed[:12]}; asked for 1e-6 to 1e-2.", "",
        "| points | drawn | worse than asked, `reached` | the same, within the rules' own error "
        "| worse, and said so | right, and not sure | error above the stated one "
        "| median error over asked | largest of those `reached` | median ms |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
        *(rows_of(table[where], name) for name, where in parts.items() if where.any()), "",
        *timed(),
    ]  # fmt: skip
    print("\n".join(lines))
    print(table[~table.reached | table.wrong | table.open].to_string())
    if asked.write:
        write_part(DOCS, "accuracy", lines)


if __name__ == "__main__":
    main()
