"""Instruments that differ in their pupil alone, and solve a scene for all of them together."""

from functools import cached_property

from octsim.config.models import Config
from octsim.instrument.instrument import Instrument
from octsim.schemes.fullwave.operators import Operators
from octsim.schemes.fullwave.scheme import sharing
from octsim.schemes.light import LightAt


class SharingInstrument(Instrument):
    """An instrument by scheme fullwave that shares with others how scenes scatter.

    Parameters
    ----------
    config : Config
        Whose scheme is fullwave.
    operators : Operators
        Where those are kept that several instruments share.
    """

    def __init__(self, config: Config, operators: Operators) -> None:
        super().__init__(config)
        self._operators = operators

    @cached_property
    def _tracer(self) -> LightAt:
        return sharing(self._optics, self._options, self._operators)
