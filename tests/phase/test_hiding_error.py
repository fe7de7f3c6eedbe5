"""A fringe has to be above an estimated error, and above chance where there is nothing else."""

import numpy as np

from octsim.config.load import load_config
from octsim.instrument.instrument import Instrument
from octsim.phase.estimators.visible import fringe_at
from octsim.phase.fringe_status import FringeStatus
from octsim.phase.hiding_error import hiding_error
from octsim.schemes.light import AccuracyStatus


def test_an_error_of_counted_rays_hides_a_fringe_only_far_above_all_of_the_light() -> None:
    error = np.array([0.02, 3.0, 30.0, np.nan])
    status = np.array([0, 3, 3, 3])
    status[1:] = AccuracyStatus.NOT_CONTROLLED
    assert hiding_error(error, status).tolist() == [0.02, 0.0, 30.0, 0.0]


def test_counted_rays_behind_crossed_polarisers_along_the_neuron_have_no_fringe() -> None:
    config = load_config({
        "polarisation": {"input": "0 deg", "analyser": "90 deg"}, "spectrum": {"samples": 100},
        "tracing": {"rays": 1000},
    })  # fmt: skip
    point = Instrument(config).spectrum(1.0, 0.65)
    depth = np.array([1.39])
    error = hiding_error(np.array([point.error]), np.array([point.status]))
    found = fringe_at(point.intensity[np.newaxis], config.spectrum.wavenumbers(), depth, error)
    assert found.status.tolist() == [FringeStatus.WITHIN_ERROR]
