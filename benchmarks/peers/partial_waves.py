"""treams and PyMieSim beside the literal reading of a cylinder's partial waves."""

import time
from itertools import product

import numpy as np
from line_beam import Slide, cylinder
from numpy.typing import NDArray
from oblique_cylinder import wait
from peers.others import asked, environment, table

CASES = [
    {"k": k, "ky": slope * k, "order": order, "radius": radius, "outside": 1.33, "inside": inside}
    for k, slope, order, radius, inside in product(
        (7.0, 9.6), (0.0, 0.3, -0.9, 1.15), (0, 1, -2, 5), (0.05, 0.6, 2.0), (1.34, 1.39, 1.6)
    )
]
PYMIESIM = {
    "k": 8.0, "diameter": 1.2, "outside": 1.33, "inside": 1.39, "aperture": 1.2, "couplings": 100,
}  # fmt: skip


def complex_of(pairs: object) -> NDArray[np.complex128]:
    """Return complex numbers from pairs."""
    values = np.array(pairs)
    return np.asarray(values[..., 0] + 1j * values[..., 1])


def section() -> str:
    """Measure, and write the page's part."""
    found = asked(
        environment("waves"), "partial_waves_run.py", {"cases": CASES, "pymiesim": PYMIESIM}
    )
    treams, pymiesim = found["treams"], found["pymiesim"]
    theirs = complex_of(treams["matrices"])
    began = time.perf_counter()
    ours = np.array([wait(**case) for case in CASES])
    seconds = (time.perf_counter() - began) / len(CASES)
    apart = np.abs(theirs - ours).max(axis=0)
    crossed = np.abs(ours[:, 0, 1]).max()
    slide = Slide()
    off = {}
    for name, lights in pymiesim["coefficients"].items():
        b = {light: complex_of(values) for light, values in lights.items()}
        # PyMieSim's across the cylinder begin at order 0, those along it too; T is −b
        off[name] = max(
            float(np.abs(cylinder(slide, 8.0, np.arange(6), light) + b[light][:6]).max())
            for light in ("along", "across")
        )
    named = f"PyMieSim {pymiesim['version']}"
    rows = [
        [
            f"treams {treams['version']}", f"T₁₁, T₂₂, {len(CASES)} cases",
            f"{max(apart[0, 0], apart[1, 1]):.1e}", f"{1e6 * treams['seconds']:.3g}",
            f"{1e6 * seconds:.3g}",
        ],
        [
            "", f"T₁₂, T₂₁ with their signs (up to {crossed:.2g})",
            f"{max(apart[0, 1], apart[1, 0]):.1e}", "", "",
        ],
        [named, "coefficients at k_y = 0, wavelength in vacuum", f"{off['vacuum']:.1e}", "", ""],
        ["", "the same, wavelength in water", f"{off['water']:.1e}", "", ""],
        ["", "one coupling to LP01", "not ours", f"{1e6 * pymiesim['seconds']:.3g}", ""],
    ]  # fmt: skip
    head = ["peer", "what", "largest difference", "theirs, µs", "the literal reading, µs"]
    return table(head, rows)
