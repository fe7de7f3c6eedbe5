"""The effects that are tried: what each is, as an overlay of a config."""

from dataclasses import dataclass

from octsim.studies.effects.overlays import (
    SOLUTION,
    OverlayOf,
    always,
    attenuation,
    chromatic,
    cover,
    dispersion,
    neighbour,
    of_cylinder,
    other_immersion,
    polarised,
    rulings,
    shell,
    wider_core,
    zernike,
)

RMS = 0.01
"""Of an aberration that is tried, µm."""
FOCUS_STEP = 0.05
"""By which the focus is moved, µm."""


@dataclass(frozen=True)
class Effect:
    """An effect of a size that is tried."""

    name: str
    kind: str
    """What it is one of; of the pairs that are measured no two are of one kind."""
    what: str
    """What it is, in words."""
    overlay: OverlayOf
    alone: bool = False
    """Whether a config has one of its kind at most, as a falloff."""
    focus: float = 0.0
    """By how much the focus is moved, µm."""


def _zernike_rows() -> tuple[Effect, ...]:
    """Return the aberrations, of both signs: but of coma, whose other sign is its mirror image."""
    nm = 1e3 * RMS
    terms = (("defocus", 4), ("astigmatism", 6), ("coma x", 8), ("coma y", 7), ("spherical", 11))
    return tuple(
        Effect(
            f"Zernike {name} ({number}) {'−' if sign < 0 else ''}{nm:g} nm rms{suffix}", "zernike",
            f"aberration by Noll's term {number}, in and out, {said}",
            zernike(number, sign * RMS, **keys),
        )
        for suffix, said, keys in (
            ("", "as objective.zernike_rays has it", {}),
            (", phase only", "its rays not turned", {"zernike_rays": "phase"}),
        )
        for name, number in terms
        for sign in ((1,) if name.startswith("coma") else (1, -1))
    )  # fmt: skip


EFFECTS: tuple[Effect, ...] = (
    Effect("dispersion of glass, water and neuron", "dispersion",
           "N-BK7, water, and water whose index is raised by what is dissolved in it, each with "
           "the configured index at the middle of the band",
           dispersion(glass="N-BK7", water="water", neuron=SOLUTION)),
    Effect("dispersion of neuron alone", "dispersion",
           "water whose index is raised by what is dissolved in it, to the configured one at the "
           "middle of the band", dispersion(neuron=SOLUTION)),
    Effect("dispersion of neuron alone, cytoplasm", "dispersion",
           "the illustration that octsim has, with the configured index at the middle of the band",
           dispersion(neuron="cytoplasm")),
    Effect("dispersion of glass alone", "dispersion",
           "N-BK7, with the configured index at the middle of the band",
           dispersion(glass="N-BK7")),
    Effect("attenuation of neuron 100 /cm", "attenuation",
           "of intensity, absorbed and scattered", attenuation(100, around=False)),
    Effect("absorption of water 0.07 /cm", "attenuation",
           "that of 900 nm, around the neuron and in it", attenuation(0.07, around=True)),
    Effect("unpolarised", "polarisation",
           "the incoherent sum of two polarisations in the place of the thesis's split",
           polarised("unpolarised"), alone=True),
    Effect("linear x", "polarisation", "linear input across a cylinder along y",
           polarised("0 deg"), alone=True),
    Effect("linear y", "polarisation", "linear input along a cylinder along y",
           polarised("90 deg"), alone=True),
    Effect("circular", "polarisation", "left circular input", polarised("left"), alone=True),
    Effect("linear 45°, crossed analyser", "polarisation",
           "linear input between x and y, and an analyser across it",
           polarised("45 deg", "135 deg"), alone=True),
    *_zernike_rows(),
    Effect("immersion 0.005 below the slide's index", "immersion",
           "the aberration of a slide of 170 µm above oil of another index",
           other_immersion(-0.005, "170 um"), alone=True),
    Effect("chromatic focal shift 100 nm", "focal shift",
           "a focus that is higher at longer wavelengths, by 100 nm over the band",
           chromatic, alone=True),
    Effect("uniform pupil", "pupil", "a pupil that is lit evenly",
           always("objective.pupil", "uniform"), alone=True),
    Effect("Gaussian pupil, fill 1", "pupil", "1/e² of intensity at the rim",
           always("objective.pupil", {"gaussian": 1.0}), alone=True),
    Effect("Gaussian pupil, fill 0.5", "pupil", "1/e² of intensity halfway to the rim",
           always("objective.pupil", {"gaussian": 0.5}), alone=True),
    Effect("fibre pupil", "pupil", "the mode of a fibre, of 5 µm mode-field diameter",
           always("objective.pupil", {"fibre": "5 um"}), alone=True),
    Effect("aplanatic apodisation", "apodisation", "√cos θ in, 1/√cos θ out",
           always("objective.apodisation", "aplanatic"), alone=True),
    Effect("falloff top hat", "falloff", "all of the core collects alike",
           always("detector.falloff", "top_hat"), alone=True),
    Effect("falloff cosine", "falloff", "cos(π ρ / 2 R_det)",
           always("detector.falloff", "cosine"), alone=True),
    Effect("falloff Gaussian", "falloff", "1/e of amplitude at R_det, without an edge",
           always("detector.falloff", "gaussian"), alone=True),
    Effect("falloff fibre", "falloff", "the mode of core and fibre_na at each wavenumber",
           always("detector.falloff", "fibre"), alone=True),
    Effect("R_det +10 %", "detector radius", "a core that is larger by a tenth", wider_core),
    Effect("rulings of each wavelength", "rulings",
           "rays as a Gaussian beam's rulings, of waist λ/(π NA) at each wavelength",
           rulings("diffraction", each=True), alone=True),
    Effect("rulings of one wavelength", "rulings",
           "rays as a Gaussian beam's rulings, of waist λ/(π NA) at the middle of the band",
           rulings("diffraction", each=False), alone=True),
    Effect("rulings, waist 0.1 um", "rulings",
           "rays as a Gaussian beam's rulings, of one wavelength",
           rulings("0.1 um", each=False), alone=True),
    Effect("focus +50 nm", "focus", "the focus higher than its line by 50 nm",
           lambda _: {}, focus=FOCUS_STEP),
    Effect("neuron 50 nm off the axis", "scene", "moved across itself",
           of_cylinder(x="50 nm"), alone=True),
    Effect("azimuth 10°", "scene", "the neuron turned about the optical axis",
           of_cylinder(azimuth="10 deg"), alone=True),
    Effect("elevation 2°", "scene", "one end of the neuron above the other",
           of_cylinder(elevation="2 deg"), alone=True),
    Effect("membrane 5 nm", "scene", "a shell of index 1.46",
           shell("membrane", 1.46, "5 nm"), alone=True),
    Effect("myelin 100 nm", "scene", "a shell of index 1.44",
           shell("myelin", 1.44, "100 nm"), alone=True),
    Effect("neighbour 50 nm beside", "scene",
           "a cylinder as thick as the sweep's middle, 50 nm beside the thickest",
           neighbour(0.05), alone=True),
    Effect("cover glass at 5 um", "scene", "a second plane above the water",
           cover("5 um"), alone=True),
)  # fmt: skip
"""Every effect that is tried, at the sizes of docs/effects.md."""
