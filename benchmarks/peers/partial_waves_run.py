"""What treams and PyMieSim say of a cylinder; run by the Python of an environment that has them.

Reads the job as JSON from standard input and writes matrices and coefficients as JSON to standard
output. Real and imaginary parts are kept as pairs.
"""

import json
import sys
import time
from importlib.metadata import version

import numpy as np

TURNED = np.array([[1, 1], [-1, 1]]) / np.sqrt(2)
"""From negative and positive helicity to treams's waves N and M."""


def by_treams(case: dict) -> list:
    """Return the matrix of F = (E_y, Z0 H_y) from treams's, whose axis z is our -y.

    E along the axis is that of N; H is (n / i) times E with N and M exchanged, so that H along the
    axis is -i n times the amplitude of M.
    """
    from treams.coeffs import mie_cyl

    found = mie_cyl(
        -case["ky"], case["order"], case["k"], [case["radius"]],
        [case["inside"] ** 2, case["outside"] ** 2], [1, 1], [0, 0],
    )  # fmt: skip
    scale = np.array([1, -1j * case["outside"]])
    matrix = scale[:, None] * (TURNED @ found @ TURNED.T) / scale
    return [[[value.real, value.imag] for value in row] for row in matrix]


def by_pymiesim(job: dict) -> dict:
    """Return PyMieSim's coefficients at normal incidence, and the seconds of LP01 couplings."""
    from PyMieSim.polarization import PolarizationState
    from PyMieSim.single import Setup
    from PyMieSim.single.detector import CoherentMode
    from PyMieSim.single.scatterer import InfiniteCylinder
    from PyMieSim.single.source import PlaneWave
    from PyMieSim.units import ureg

    def setup(wavelength: float) -> tuple:
        source = PlaneWave(
            wavelength=wavelength * ureg.micrometer,
            polarization=PolarizationState(angle=0 * ureg.degree),
            amplitude=1 * ureg.volt / ureg.meter,
        )
        cylinder = InfiniteCylinder(
            diameter=job["diameter"] * ureg.micrometer,
            material=job["inside"],
            medium=job["outside"],
        )
        fibre = CoherentMode(
            mode_number="LP01", numerical_aperture=job["aperture"], phi_offset=180 * ureg.degree,
            gamma_offset=0 * ureg.degree, rotation=0 * ureg.degree, medium=job["outside"],
        )  # fmt: skip
        return cylinder, Setup(scatterer=cylinder, source=source, detector=fibre)

    vacuum = 2 * np.pi / job["k"]
    coefficients = {}
    for name, wavelength in (("vacuum", vacuum), ("water", vacuum / job["outside"])):
        cylinder, made = setup(wavelength)
        made.get("coupling")
        coefficients[name] = {
            light: [[value.real, value.imag] for value in np.array(getattr(cylinder, which))]
            for light, which in (("along", "b1n"), ("across", "a2n"))
        }
    began = time.perf_counter()
    for wavelength in np.linspace(0.65, 0.9, job["couplings"]):
        setup(float(wavelength))[1].get("coupling")
    seconds = (time.perf_counter() - began) / job["couplings"]
    return {"coefficients": coefficients, "seconds": seconds, "version": version("PyMieSim")}


def main() -> None:
    """Do the job that standard input has."""
    job = json.load(sys.stdin)
    by_treams(job["cases"][0])  # imports it
    began = time.perf_counter()
    matrices = [by_treams(case) for case in job["cases"]]
    seconds = (time.perf_counter() - began) / len(matrices)
    answer = {
        "treams": {"matrices": matrices, "seconds": seconds, "version": version("treams")},
        "pymiesim": by_pymiesim(job["pymiesim"]),
    }
    print("RESULT " + json.dumps(answer))


if __name__ == "__main__":
    main()
