"""The thesis's claim that rays are far faster than fields: what a spectrum takes, side by side."""

import statistics
import time
from collections.abc import Callable

import numpy as np
from line_beam import Polarisation, detected, gaussian_beam
from numpy.polynomial.chebyshev import Chebyshev
from peers.chances import by_scheme
from peers.fdtd import BAND, FILL, FOCUS, SLIDE, by_meep, by_reference
from peers.others import LeftOutError, table

NODES = 16
RESOLUTION = 40
ROUNDS = 5


def by_partial_waves(light: Polarisation) -> np.ndarray:
    """Return a spectrum of the line beam through the nodes of a Chebyshev series."""
    path = 2 * SLIDE.neuron * SLIDE.diameter + 2 * SLIDE.glass * (SLIDE.gap - FOCUS)

    def smooth(k: np.ndarray) -> np.ndarray:
        beams = [gaussian_beam(SLIDE, x, FOCUS, FILL) for x in k.tolist()]
        found = [detected(SLIDE, x, b, light) for x, b in zip(k.tolist(), beams, strict=True)]
        return np.asarray(found) * np.exp(-0.5j * k * path)

    # numpy interpolates real functions: the imaginary part beside
    nodes = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
    low, high = float(BAND[0]), float(BAND[-1])
    values = smooth((high + low) / 2 + (high - low) / 2 * nodes)
    parts = [Chebyshev.fit(nodes, part, NODES - 1)(np.linspace(-1, 1, BAND.size))
             for part in (values.real, values.imag)]  # fmt: skip
    return np.asarray(parts[0] ** 2 + parts[1] ** 2)


def seconds_of(work: Callable[[], object]) -> float:
    """Time some work; the median of a few rounds."""
    work()
    took = []
    for _ in range(ROUNDS):
        began = time.perf_counter()
        work()
        took.append(time.perf_counter() - began)
    return statistics.median(took)


def section() -> str:
    """Measure, and write the page's part."""
    rows = []
    truth = by_scheme("paths", accuracy=1e-8)(0)

    def scheme(name: str, options: dict[str, float], limit: np.ndarray, what: str) -> None:
        spectrum = by_scheme(name, **options)
        error = float(np.abs(spectrum(0) - limit).max() / limit.max())
        told = ", ".join(f"{key} {value:g}" for key, value in options.items())
        rows.append([
            f"scheme `{name}`, {told}", what, f"{error:.1e}",
            f"{seconds_of(lambda: spectrum(0)) * 1e3:.3g}",
        ])  # fmt: skip

    scheme("vogel", {"rays": 3000}, truth, "rays, 3-D")
    scheme("paths", {"accuracy": 1e-4}, truth, "rays, 3-D")
    limit = by_scheme("fullwave", accuracy=1e-8)(0)
    scheme("fullwave", {"accuracy": 1e-2}, limit, "Maxwell, 3-D, both polarisations")
    scheme("fullwave", {"accuracy": 1e-4}, limit, "Maxwell, 3-D, both polarisations")
    lights: tuple[Polarisation, ...] = ("along", "across")
    for light in lights:
        exact = np.array([
            abs(detected(SLIDE, k, gaussian_beam(SLIDE, k, FOCUS, FILL), light)) ** 2
            for k in BAND.tolist()
        ])  # fmt: skip
        error = float(np.abs(by_partial_waves(light) - exact).max() / exact.max())
        took = seconds_of(lambda light=light: by_partial_waves(light))
        rows.append([
            f"the literal reference, {NODES} wavenumbers", f"Maxwell, 2-D, {light}", f"{error:.1e}",
            f"{took * 1e3:.3g}",
        ])  # fmt: skip
        try:
            meep = by_meep(light, RESOLUTION)
        except LeftOutError as reason:
            rows.append([f"Meep, left out: {reason}", f"Maxwell, 2-D, {light}", "", ""])
            continue
        exact = np.abs(by_reference(light, RESOLUTION)[0][1:]) ** 2
        intensity = np.array(meep["real"][1:]) ** 2 + np.array(meep["imag"][1:]) ** 2
        rows.append([
            f"Meep, {RESOLUTION} pixels a µm", f"Maxwell, 2-D, {light}",
            f"{np.abs(intensity - exact).max() / exact.max():.1e}", f"{meep['seconds'] * 1e3:.3g}",
        ])  # fmt: skip
    return table(["code", "what it solves", "max abs(ΔI) / max I from its own limit",
                  "ms a spectrum"], rows)  # fmt: skip
