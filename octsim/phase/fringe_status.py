"""Whether a spectrum has a fringe that a phase can be read from, by name and with a remedy."""

from collections.abc import Callable, Mapping
from enum import IntEnum
from operator import attrgetter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class FringeStatus(IntEnum):
    """What is known of a fringe; from `SATURATED` on there is a phase, but a doubtful one."""

    VISIBLE = 0
    NO_SPECTRUM = 1
    """The spectrum is NaN, as there is no focus."""
    NO_LIGHT = 2
    """The spectrum is zero."""
    TOO_FEW_OSCILLATIONS = 3
    """The band has less than `octsim.phase.estimators.visible.FEWEST_OSCILLATIONS`."""
    NOT_RESOLVED = 4
    """There are too few samples for the oscillations."""
    NO_FRINGE = 5
    """There is light, but what oscillates at the depth is not told from noise, from rounding or
    from a smooth curve."""
    WITHIN_ERROR = 6
    """The fringe is smaller than the estimated error of the intensity."""
    OTHER_DEPTHS = 7
    """What oscillates at other depths is at least half as strong, or the strongest component of
    the Fourier transform is of another depth."""
    SATURATED = 8
    """Several samples are cut at the largest or the least value."""
    FAR_FROM_NOMINAL = 9
    """The fringe is at another depth than the one that was expected."""
    MIXED = 10
    """What oscillates at other depths is at least a tenth as strong."""
    POOR_FIT = 11
    """The residual has a shape: the fringe is not a sinusoid on a slowly changing offset."""

    @property
    def has_phase(self) -> bool:
        """Whether a phase can be read from the spectrum."""
        return self == FringeStatus.VISIBLE or self >= FringeStatus.SATURATED

    @property
    def remedy(self) -> str:
        """What a user can do about it in a config; empty where nothing is amiss."""
        return _REMEDIES[self]

    @property
    def measured_remedy(self) -> str:
        """What a user can do about it who has measured; empty where nothing is amiss."""
        return _MEASURED[self]

    @property
    def lit_remedy(self) -> str:
        """What a user can do about it who has measured, and gives the source's own spectrum."""
        return _LIT[self]


_ALONE = (
    "give a smaller gap or detector.core_diameter, or bring the focus between the neuron's sides, "
    "so that the fringe of the diameter is by far the strongest"
)
_NOT_ALONE = "else its phase and slope are not of the diameter alone"
_REMEDIES: Mapping[FringeStatus, str] = {
    FringeStatus.VISIBLE: "",
    FringeStatus.NO_SPECTRUM: "give focus_law.fraction a wider range or more steps",
    FringeStatus.NO_LIGHT: (
        "bring the focus to the neuron, give detector.core_diameter a larger value, or media whose "
        "indices differ"
    ),
    FringeStatus.TOO_FEW_OSCILLATIONS: "widen spectrum.wavelength, or take larger diameters",
    FringeStatus.NOT_RESOLVED: "raise spectrum.samples, or narrow spectrum.wavelength",
    FringeStatus.NO_FRINGE: (
        "give the neuron an index other than that of water, and bring the focus between its sides"
    ),
    FringeStatus.WITHIN_ERROR: "ask for more by tracing.accuracy",
    FringeStatus.OTHER_DEPTHS: _ALONE,
    FringeStatus.SATURATED: "expose for less, so that no sample is cut, and measure again",
    FringeStatus.FAR_FROM_NOMINAL: "check the diameter, the index and the wavenumbers",
    FringeStatus.MIXED: f"{_ALONE}; {_NOT_ALONE}",
    FringeStatus.POOR_FIT: (
        "raise the degrees of processing.sinusoid; else phases and their changes can be wrong by "
        "far more than their standard error"
    ),
}
_DIVIDE = "divide the spectra by the source's own"
_MEASURED: Mapping[FringeStatus, str] = {
    **_REMEDIES,
    FringeStatus.NO_SPECTRUM: "leave the spectrum out",
    FringeStatus.NO_LIGHT: "leave the spectrum out, or look whether the camera recorded it",
    FringeStatus.TOO_FEW_OSCILLATIONS: "measure over a wider band, or check the depth",
    FringeStatus.NOT_RESOLVED: "give more samples, or a narrower band, or check the depth",
    FringeStatus.NO_FRINGE: f"{_DIVIDE}, name the depth, or take more light or a longer mean",
    FringeStatus.WITHIN_ERROR: "take more light or a longer mean",
    FringeStatus.OTHER_DEPTHS: f"{_DIVIDE}, name the depth, or subtract what is there without it",
    FringeStatus.FAR_FROM_NOMINAL: (
        f"check the depth that is named and the wavelengths, and {_DIVIDE}"
    ),
    FringeStatus.MIXED: (
        f"{_DIVIDE}, look for samples that are none, and subtract fringes of other surfaces; "
        f"{_NOT_ALONE}"
    ),
    FringeStatus.POOR_FIT: (
        f"{_DIVIDE}, or raise the degrees of Processing.sinusoid; else phases and their changes "
        "can be wrong by far more than their standard error"
    ),
}


_LIT: Mapping[FringeStatus, str] = {
    **_MEASURED,
    FringeStatus.POOR_FIT: (
        "the fringe is no pure sinusoid; octsim's own are none by a few %, and a calibration by "
        "the same fit has the same shape: octsim run match says whether it is the model's"
    ),
    FringeStatus.MIXED: (
        "subtract fringes of other surfaces, else the phase is not of the diameter alone"
    ),
    FringeStatus.OTHER_DEPTHS: "name the depth, or subtract what is there without it",
    FringeStatus.NO_FRINGE: "name the depth, or take more light or a longer mean",
    FringeStatus.FAR_FROM_NOMINAL: "check expansion.diameter, the neuron's index and the axis",
}
"""What to do about spectra whose source is known, and so needs no division."""

WITH_PHASE = [status for status in FringeStatus if status.has_phase]
"""Those of spectra whose phase can be read."""


def doubts_of(
    status: "NDArray[np.int8]",
    what: str,
    remedy: Callable[[FringeStatus], str] = attrgetter("remedy"),
) -> list[str]:
    """Say, a line each, how many of some things have a status that is amiss, with its remedy."""
    return [
        f"{one.name.lower()} at {(status == one).sum()} of {status.size} {what}"
        f"{'' if one.has_phase else ', whose phase is not known (NaN)'}: {remedy(one)}"
        for one in FringeStatus
        if one.remedy and (status == one).any()
    ]
