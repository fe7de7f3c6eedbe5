"""How often stated errors cover the truth of simulated recordings, and what 1 nm is read as.

    python benchmarks/accuracy_of_measured.py [--series N] [--seed TEXT] [--write]

In cells of diameter, source, photons and drift N series of raw counts, whose neuron swells by 1 nm,
go through the chain of docs/measured.md, drawn anew by the hash of the commit. `--write` puts the
table into that page. Ten minutes.
"""

import argparse
import itertools
import tempfile
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from drawn_points import ROOT, add_options, seeded
from marked import write_part
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from octsim.base.errors import OctsimWarning
from octsim.config.derive import calibrating, merge
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.instrument.instrument import Instrument
from octsim.measured.setup import setup_of
from octsim.phase.cramer_rao import diameter_bound
from octsim.phase.estimators.one_fit import fitted
from octsim.phase.estimators.series import series_phases
from octsim.phase.measured_series import Series
from octsim.phase.rest_error import stated_change
from octsim.studies.measured.study import opened

Array = NDArray[np.float64]
DOCS = ROOT / "docs" / "measured.md"
WAVELENGTH = np.linspace(0.65, 0.90, 512)  # µm, of the pixels
K = 2 * np.pi / WAVELENGTH
REST, MOVED, STEP = 40, 20, 1e-3  # spectra, and µm
DARK, READ = 100.0, 3.0  # counts
PHOTONS = (1e6, 3e7)
# a source of 50 nm holds a quarter of a fringe of less than 4 µm
NEURONS = (*itertools.product((1.0, 1.4, 2.0), (200, 150, 100)), (4.0, 50), (4.5, 50))
BASE: dict[str, Any] = {
    "tracing": {"scheme": "fullwave", "accuracy": 1e-6},
    "sweep": {"focus": {"slope": 0.581, "intercept": "69 nm"}},
    "processing": {"sinusoid": {"weights": "shot", "envelope": "common"}},
}


class Neuron(NamedTuple):
    """What a diameter's spectra are at the pixels, and how its phase goes with it."""

    rest: Array
    swollen: Array
    slope: float
    """rad/nm."""
    bend: float
    """rad/nm²."""
    config: Config


def neuron(folder: Path, diameter: float, power: Array) -> Neuron:
    """Return a neuron by Maxwell's equations, and the config of a lab that has its files."""
    rows = {"wavelength": WAVELENGTH.tolist(), "power": power.tolist()}
    files = {name: str(folder / f"{name}.npy") for name in ("spectra", "dark", "reference")}
    axis = {"wavelength": str(folder / "axis.csv")}
    config = load_config(merge(BASE, {
        "expansion": {"diameter": f"{diameter} um"},
        "spectrum": {"source": {"table": rows}},
        "measured": {**files, "axis": axis, "rate": "20 kHz"},
    }))  # fmt: skip
    flat, lit = Instrument(load_config(BASE)), Instrument(config)
    focus, fine = 0.581 * diameter + 0.069, np.linspace(K.min(), K.max(), 1500)

    def on_pixels(of: float) -> Array:
        found = flat.over(flat.light(of, focus), fine).intensity
        return np.asarray(make_interp_spline(fine, found, k=5)(K))

    around = lit.spectra(diameter + STEP * np.array([-1, 0, 1]), [focus] * 3)
    depth = float(lit.nominal_depth(np.array(diameter)))
    phase = np.unwrap(series_phases(around, lit.wavenumber, depth, calibrating(config), lit.power))
    return Neuron(
        on_pixels(diameter), on_pixels(diameter + STEP), float(phase[2] - phase[0]) / 2,
        float(phase[2] - 2 * phase[1] + phase[0]), config,
    )  # fmt: skip


def camera(expected: Array, generator: np.random.Generator) -> NDArray[np.uint32]:
    """Return counts for expected electrons."""
    noise = READ * generator.standard_normal(expected.shape)
    counts = generator.poisson(np.maximum(expected, 0)) + noise + DARK
    return np.maximum(np.round(counts), 0).astype(np.uint32)


def measured(
    folder: Path, one: Neuron, power: Array, photons: float, drifts: bool,
    generator: np.random.Generator,
) -> dict[str, float]:  # fmt: skip
    """Record a series, read it, and compare it with its truth."""
    number = REST + MOVED
    step = np.append(np.zeros(REST), np.ones(MOVED))
    grown = step + drifts * np.linspace(0, 1, number)
    light = (one.rest + (one.swollen - one.rest) * grown[:, np.newaxis]) * power
    scale = photons / (one.rest * power).sum()
    bare = np.broadcast_to(2 * scale * power * one.rest.mean(), (500, K.size))
    for name, expected in (
        ("spectra", scale * light), ("dark", np.zeros((100, K.size))), ("reference", bare)
    ):  # fmt: skip
        np.save(folder / f"{name}.npy", camera(expected, generator))
    with opened(one.config) as recording:
        setup = setup_of(one.config, recording)
        found = fitted(setup.design, setup.net(recording.counts[:]), setup.variance)
    series = Series(setup.time, found.phase, found.phase_error)
    change, _ = stated_change(series, REST, drifts)
    expansion = change.phase / one.slope
    expansion -= one.bend * expansion**2 / 2 / one.slope
    moved, error = expansion[REST:], change.error[REST:] / one.slope
    return {
        "covered": float((np.abs(moved - 1) < error).mean()), "read": float(moved.mean()),
        "stated": float(found.phase_error.mean() / one.slope),
    }  # fmt: skip


def bound(one: Neuron, power: Array, photons: float) -> float:
    """Return the Cramér–Rao bound of one spectrum's diameter, nm, where the source is known."""
    rest, change = one.rest * power, (one.swollen - one.rest) * power / STEP
    return 1e3 * diameter_bound(rest, change, photons, READ)


def cells(series: int, generator: np.random.Generator) -> pd.DataFrame:
    """Measure all cells."""
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        np.savetxt(folder / "axis.csv", 1e3 * WAVELENGTH, header="wavelength (nm)", comments="")
        for diameter, width in NEURONS:
            shape = np.exp(-4 * np.log(2) * ((WAVELENGTH - 0.775) / (1e-3 * width)) ** 2)
            power = shape * (1 + 0.05 * np.cos(2 * np.pi * WAVELENGTH / 0.02))
            one = neuron(folder, diameter, power)
            for photons, drifts in itertools.product(PHOTONS, (False, True)):
                found = pd.DataFrame(
                    measured(folder, one, power, photons, drifts, generator) for _ in range(series)
                )
                mean, least = found.mean(), bound(one, power, photons)
                rows.append(
                    {"diameter": diameter, "width": width, "photons": photons, "drifts": drifts,
                     **mean, "over_bound": mean.stated / least}
                )  # fmt: skip
                print(" ".join(f"{value:.4g}" for value in rows[-1].values()), flush=True)
    return pd.DataFrame(rows)


def main() -> None:
    """Measure, print and, if asked, write the docs' table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--series", type=int, default=100)
    add_options(parser)
    asked = parser.parse_args()
    warnings.simplefilter("ignore", OctsimWarning)
    seed, generator = seeded(asked.seed)
    table = cells(asked.series, generator)
    if asked.table:
        table.to_csv(asked.table, index=False)
    lines = [
        f"By `benchmarks/accuracy_of_measured.py` at {seed[:7]}: {asked.series} series a cell, "
        "sources with a ripple of 5 %, dark and read noise, 512 pixels. Covered is how often a "
        "sample's stated error covers its truth; drift is 1 nm over the series, subtracted as a "
        "line.",
        "",
        "| diameter (µm) | source (nm) | photons | drift | covered | 1 nm is read as | stated error"
        " of a spectrum (nm) | over the Cramér–Rao bound |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
        *(
            f"| {row.diameter:g} | {row.width} | {row.photons:.0e} | "
            f"{'yes' if row.drifts else 'no'} | {row.covered:.0%} | {row.read:.3f} | "
            f"{row.stated:.3g} | {row.over_bound:.2f} |"
            for row in table.itertuples()
        ),
        "",
        f"Covered {table.covered.min():.0%} to {table.covered.max():.0%}, read as "
        f"{table.read.min():.3f} to {table.read.max():.3f} nm, {table.read.mean():.4f} in mean.",
    ]
    print("\n".join(lines))
    if asked.write:
        write_part(DOCS, "accuracy", lines)


if __name__ == "__main__":
    main()
