"""A line beam on a cylinder over a plane by Meep (FDTD); run by Debian's Python, as Meep is its.

Reads the job as JSON from standard input and writes overlaps as JSON to standard output: see
`fields`. A current sheet in the glass sends out a pulse; the field that returns to the sheet,
weighted with the sheet's own profile, is by Lorentz's reciprocity the overlap with the beam's mode.
What the sheet has of its own is taken off by a run in which all is glass.
"""

import json
import math
import sys
import time

import meep as mp
import numpy as np

SPACE = 0.8
"""Thickness of the absorbing layers, µm."""


def run(job: dict, resolution: float, all_glass: bool) -> tuple:
    """Step Maxwell's equations until the light is gone; fields on the sheet (x, K), and x."""
    glass, water, neuron = (mp.Medium(index=n) for n in job["indices"])
    across = job["light"] == "across"
    component = mp.Hz if across else mp.Ez
    top = job["gap"] + job["diameter"]
    low, high = -0.6 - SPACE, math.ceil(5 * (top + 0.4 + SPACE)) / 5  # whole pixels
    middle, width = (low + high) / 2, 2 * (job["half_width"] + SPACE)
    x = np.array(job["x"])
    real, imag = np.array(job["real"]), np.array(job["imag"])

    def amplitude(at: mp.Vector3) -> complex:
        return complex(np.interp(at.x, x, real), np.interp(at.x, x, imag))

    far = 1e3
    geometry = [
        mp.Block(mp.Vector3(far, far, far), center=mp.Vector3(0, far / 2 - middle), material=water),
        mp.Cylinder(
            job["diameter"] / 2,
            center=mp.Vector3(0, job["gap"] + job["diameter"] / 2 - middle),
            material=neuron,
        ),
    ]
    k = np.array(job["wavenumbers"])
    line = {
        "center": mp.Vector3(0, job["sheet"] - middle),
        "size": mp.Vector3(2 * job["half_width"]),
    }
    simulation = mp.Simulation(
        cell_size=mp.Vector3(width, high - low),
        resolution=resolution,
        boundary_layers=[mp.PML(SPACE)],
        default_material=glass,
        geometry=[] if all_glass else geometry,
        symmetries=[mp.Mirror(mp.X, phase=-1 if across else 1)],
        sources=[
            mp.Source(
                mp.GaussianSource(job["centre"] / (2 * np.pi), fwidth=job["spread"] / (2 * np.pi)),
                component=component,
                amp_func=amplitude,
                **line,
            )
        ],
    )
    # on the sheet's own row: averaged with the rows beside it, the field's cusp there is lost
    found = simulation.add_dft_fields([component], list(k / (2 * np.pi)), yee_grid=True, **line)
    simulation.run(until_after_sources=job["after"])
    field = np.array([simulation.get_dft_array(found, component, i) for i in range(k.size)])
    place = (np.arange(field.shape[-1]) - (field.shape[-1] - 1) / 2) / resolution
    weight = np.array([amplitude(mp.Vector3(at)) for at in place])
    pixels = (high - low) * width * resolution**2
    steps = simulation.meep_time() * resolution / simulation.Courant
    return np.asarray(place), weight, field, pixels * steps


def fields(job: dict, resolution: float) -> dict:
    """Return the overlap at each wavenumber, the seconds it took and the steps of pixels."""
    began = time.perf_counter()
    _, weight, own, _ = run(job, resolution, True)
    scene_began = time.perf_counter()
    _, _, all_of_it, work = run(job, resolution, False)
    ended = time.perf_counter()
    sent = (own * weight.conj()).sum(axis=1)
    overlap = ((all_of_it - own) * weight).sum(axis=1) / sent
    overlap *= -1 if job["light"] == "across" else 1
    return {
        "real": overlap.real.tolist(), "imag": overlap.imag.tolist(),
        "seconds": ended - began, "scene_seconds": ended - scene_began, "work": work,
    }  # fmt: skip


def main() -> None:
    """Do the job that standard input has."""
    mp.verbosity(0)
    job = json.load(sys.stdin)
    print("RESULT " + json.dumps({"version": mp.__version__, **fields(job, job["resolution"])}))


if __name__ == "__main__":
    main()
