"""Estimators of a spectrum's phase, interchangeable: spectra in, phase and depth out."""

from octsim.phase.estimators.by_name import ESTIMATORS as ESTIMATORS
from octsim.phase.estimators.by_name import phases as phases
from octsim.phase.estimators.judged import estimate as estimate
