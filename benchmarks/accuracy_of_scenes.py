"""How true the accuracy is that scheme fullwave states of shells and stacks of planes.

    python benchmarks/accuracy_of_scenes.py [POINTS] [--seed TEXT]

Scenes are drawn anew by the hash of the commit, solved, and compared with `dense_scenes`.
"""

import argparse
import math
import time
from typing import Any

import numpy as np
import pandas as pd
from accuracy_of_fullwave import BAND, DETECTOR, PUPILS, WAVENUMBERS
from dense_scenes import Layered, dense_scene
from dense_waves import Beam
from drawn_points import add_options, judged, seeded

from octsim.optics.materials import Constant
from octsim.optics.polarisation import Polarisation
from octsim.optics.scene import Cylinder, Plane, Region, Scene
from octsim.schemes.field_sum import relative_error
from octsim.schemes.light import Optics
from octsim.schemes.table import FULL_WAVE


def scene_of(layered: Layered) -> Scene:
    """Return a scene as schemes have it: its lowest plane at z = 0."""
    numbered = iter(range(100))

    def region(index: complex) -> Region:
        # κ as attenuation at 8 /µm would depend on the wavenumber: indices are real here
        return Region(f"medium {next(numbered)}", Constant(index.real))

    glass, water, core = map(region, (layered.n_glass, layered.n_water, layered.n_neuron))
    planes, below, height = [], glass, 0.0
    for index, thickness in layered.films:
        above = region(index)
        planes.append(Plane(f"P{next(numbered)}", height, below, above))
        below, height = above, height + thickness
    planes.append(Plane("P", height, below, water))
    floor, below, height = height, water, height + layered.room
    for index, thickness in layered.above:
        above = region(index)
        planes.append(Plane(f"P{next(numbered)}", height, below, above))
        below, height = above, height + thickness
    z, radius = floor + layered.gap + layered.diameter / 2, layered.diameter / 2
    cylinders, outside = [], water
    for index, thickness in layered.shells:
        inside = region(index)
        cylinders.append(Cylinder("S", layered.offset, z, radius, inside, outside))
        outside, radius = inside, radius - thickness
    cylinders.append(Cylinder("C", layered.offset, z, radius, core, outside))
    return Scene(glass, (*planes, *cylinders))


def draw(generator: np.random.Generator) -> tuple[Layered, Beam, str, float]:
    """Draw a scene, its light and the accuracy that is asked."""
    uniform = generator.uniform
    diameter = float(np.exp(uniform(np.log(0.6), np.log(3))))
    water = uniform(1.31, 1.38) if generator.random() < 0.5 else 1.33
    gap = generator.choice([0.0, 0.3]) * generator.random()
    shells, left = [], diameter / 2
    for _ in range(generator.integers(0, 3)):
        thickness = min(generator.choice([0.005, 0.1, 0.3]) * uniform(0.5, 1.5), 0.5 * left)
        shells.append((uniform(1.36, 1.5), thickness))
        left -= thickness
    films = [(uniform(1.3, 1.7), uniform(0.02, 0.8)) for _ in range(generator.choice([0, 0, 1, 2]))]
    room, above = math.inf, []
    if generator.random() < 0.5 or not (shells or films):
        room = gap + diameter + generator.choice([0.0, 0.3, 2.0]) * generator.random()
        above = [(uniform(1.3, 1.6), uniform(0.02, 0.5))] if generator.random() < 0.3 else []
        above.append((generator.choice([1.0, 1.45, 1.52]), math.inf))
    layered = Layered(
        uniform(1.42, 1.6), water, uniform(1.34, 1.5), gap, diameter,
        uniform(0, 0.6) * diameter if generator.random() < 0.4 else 0.0, tuple(shells),
        tuple(films), room, tuple(above),
    )  # fmt: skip
    name = str(generator.choice(list(PUPILS)))
    beam = Beam(PUPILS[name], uniform(0.5, min(1.25, 0.94 * water)), diameter * uniform(-0.5, 1.5))
    return layered, beam, name, 10 ** uniform(-5, -2)


def measured(point: tuple[Layered, Beam, str, float]) -> dict[str, Any]:
    """Return what scheme fullwave states of a point, and how far it is from dense rules."""
    layered, beam, name, accuracy = point
    options = {"accuracy": accuracy}
    optics = Optics(
        DETECTOR, BAND, 10, beam.aperture, beam.pupil, Polarisation(None, None), WAVENUMBERS
    )
    begin = time.process_time()
    light = FULL_WAVE.tracer(optics, options)(scene_of(layered), beam.focus)
    seconds = time.process_time() - begin
    compared = np.array([BAND[0] + (BAND[1] - BAND[0]) * 0.71])
    asked, every = (FULL_WAVE.field(light, k, optics, options) for k in (compared, WAVENUMBERS))
    largest = (np.abs(every.values) ** 2).mean(axis=0).max()
    size = float(np.sqrt(largest))
    dense = dense_scene(layered, beam, compared, 5e-3 * accuracy * size)
    truth, found = ((np.abs(one) ** 2).mean(axis=0) for one in (dense.field, asked.values))
    return {
        **layered._asdict(), "aperture": beam.aperture, "focus": beam.focus, "pupil": name,
        "accuracy": accuracy, "status": int(light.status), "seconds": seconds,
        "nodes": light.wavenumber.size, "order": light.order,
        "stated": relative_error(size, every.error),
        "true": float(np.abs(found - truth).max() / largest),
        "reference_error": relative_error(size, dense.error),
    }  # fmt: skip


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("points", type=int, nargs="?", default=50)
    add_options(parser)
    asked = parser.parse_args()
    _, generator = seeded(asked.seed)
    rows = []
    for _ in range(asked.points):
        rows.append(measured(draw(generator)))
        table = judged(pd.DataFrame(rows))
        if asked.table:
            table.to_csv(asked.table, index=False)
        last = table.iloc[-1]
        print(
            f"{len(rows)} asked {last.accuracy:.1e} true {last.true:.1e} "
            f"stated {last.stated:.1e} "
            f"rules {last.reference_error:.0e} {last.seconds:.2f} s status {last.status}",
            flush=True,
        )
    counts = table[["wrong", "open", "warned", "unsure", "understated"]].sum()
    print(f"{len(table)} drawn", counts.to_dict())


if __name__ == "__main__":
    main()
