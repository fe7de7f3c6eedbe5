"""The section of the config for what moves a phase besides a diameter (`snakemake responses`)."""

from octsim.config.fields import Index, PositiveLength, Section, key
from octsim.config.ranges import DiameterRange


class Membrane(Section):
    """A thin shell, for a scene whose swept cylinder has none."""

    thickness: PositiveLength = key("5 nm", "of the membrane that such a neuron is given")
    index: Index = key(1.46, "its refractive index")


class Responses(Section):
    """How far a phase, and the spectrum's shape, tell what has changed in a neuron."""

    diameters: DiameterRange = key(
        {"start": "1 um", "stop": "2 um", "num": 11},
        "of the neuron at rest; expansion.diameter is one more",
    )
    membrane: Membrane = Membrane()
