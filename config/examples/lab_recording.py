"""Write what a lab's spectrometer might: raw counts of an axon that fires, and its calibrations.

    python config/examples/lab_recording.py [FOLDER]

The truth is known: an axon of 4.5 µm swells by 1 nm for some 2 ms, while it drifts. Frame 1500 is
overexposed, and 2300 is an outlier. `config/examples/lab_recording.yaml` reads these files.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import octsim
from octsim.instrument.instrument import Instrument

Array = NDArray[np.float64]
SPECTRA, PIXELS, RATE = 3000, 2048, 20e3
DIAMETER, FOCUS = 4.5, 0.581 * 4.5 + 0.069  # µm
EXPANSION, BEGIN, LENGTH = 1e-3, 0.06, 2e-3  # µm, s, s
PHOTONS, DARK, READ, FULL = 1.5e7, 96.0, 4.0, 4095  # electrons a spectrum; counts
GAIN = 8.0  # electrons a count
DRIFT = 3e-3  # µm/s, of the diameter


def swelling(time: Array) -> Array:
    """Return how much larger the axon is, µm: a rise, and a slower fall."""
    since = np.clip((time - BEGIN) / LENGTH, 0, None)
    return EXPANSION * since * np.exp(1 - since)


def wavelengths() -> Array:
    """Return the wavelength of each pixel, µm: not quite even, as a grating has it."""
    place = np.arange(PIXELS) / (PIXELS - 1)
    return np.asarray(0.78 + 0.12 * place + 0.003 * (place - 0.5) ** 2)


def source(wavelength: Array) -> Array:
    """Return the source's power: a Gaussian of 50 nm with a ripple."""
    shape = np.exp(-4 * np.log(2) * ((wavelength - 0.84) / 0.05) ** 2)
    return np.asarray(shape * (1 + 0.05 * np.cos(2 * np.pi * wavelength / 0.011)))


def modelled(growth: Array) -> Array:
    """Return spectra of the axon by Maxwell's equations, without a source, (T, pixels)."""
    config = octsim.load_config(
        {
            "tracing": {"scheme": "fullwave", "accuracy": 1e-6},
            "spectrum": {"wavelength": {"min": "779 nm", "max": "902 nm"}, "samples": 2000},
            "sweep": {
                "diameters": {"start": "4.3 um", "stop": "4.7 um", "num": 41},
                "focus": {"slope": 0.581, "intercept": "69 nm"},
            },
        }
    )
    instrument = Instrument(config)
    steps = np.linspace(0, 2 * EXPANSION, 17)
    spectra = instrument.spectra(DIAMETER + steps, np.full(steps.size, FOCUS))
    k = 2 * np.pi / wavelengths()
    on_pixels = np.stack([np.interp(k, instrument.wavenumber, one) for one in spectra])
    # between steps of 0.1 nm all is linear
    place = growth / steps[-1] * (steps.size - 1)
    low = np.minimum(place.astype(int), steps.size - 2)
    share = (place - low)[:, np.newaxis]
    return np.asarray((1 - share) * on_pixels[low] + share * on_pixels[low + 1])


def recorded(light: Array, generator: np.random.Generator) -> NDArray[np.uint16]:
    """Return counts of a camera of 12 bits for expected electrons."""
    electrons = generator.poisson(light) + READ * GAIN * generator.standard_normal(light.shape)
    counts = np.round(electrons / GAIN + DARK)
    return np.clip(counts, 0, FULL).astype(np.uint16)


def main(folder: Path) -> None:
    """Write the files."""
    folder.mkdir(parents=True, exist_ok=True)
    generator = np.random.default_rng(20231115)
    time = np.arange(SPECTRA) / RATE
    lit = source(wavelengths())
    spectra = modelled(swelling(time) + DRIFT * time) * lit
    spectra *= PHOTONS / spectra[0].sum()
    spectra[1500] *= 6  # the light flickers, and the camera is full
    spectra[2300] = spectra[2300][::-1]  # a frame that went wrong
    dark = np.zeros((200, PIXELS))
    bare = np.broadcast_to(lit * spectra[0].max() / lit.max(), (500, PIXELS))
    np.save(folder / "spectra.npy", recorded(spectra, generator))
    np.save(folder / "dark.npy", recorded(dark, generator))
    np.save(folder / "reference.npy", recorded(bare, generator))
    nm = 1e3 * wavelengths()
    np.savetxt(folder / "pixels.csv", nm, fmt="%.6f", header="wavelength (nm)", comments="")
    np.savetxt(
        folder / "source.csv", np.column_stack([nm, lit]), fmt="%.6f", delimiter=",",
        header="wavelength (nm),power", comments="",
    )  # fmt: skip
    np.savetxt(
        folder / "truth.csv", np.column_stack([time, 1e3 * swelling(time)]), fmt="%.8g",
        delimiter=",", header="time (s),expansion (nm)", comments="",
    )  # fmt: skip
    print(f"{folder}: {SPECTRA} spectra of {PIXELS} pixels, dark, reference, pixels, source, truth")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "lab_recording"))
