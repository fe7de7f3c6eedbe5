"""What is uncertain of an instrument: moved one by one, or drawn within its limits."""

import numpy as np
import pytest

from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.studies.calibration.study import converged
from octsim.studies.calibration.tolerances import (
    PARAMETERS,
    drawn,
    moved,
    offsets_of,
    value_of,
)

LAW = 0.58


def test_parameters_move_alone_and_only_where_they_can() -> None:
    config = converged(load_config({"scene": {"gap": "0 nm"}}))
    for name in PARAMETERS:
        for by in offsets_of(config, name).tolist():
            place = moved(config, {name: by}, LAW)
            if name in ("diameter", "focus"):
                assert place.config == config
                assert (place.diameter, place.focus) == (
                    (by, LAW * by) if name == "diameter" else (0.0, by)
                )
            else:
                assert value_of(place.config, name) == pytest.approx(value_of(config, name) + by)
                for other in set(PARAMETERS) - {name}:
                    assert value_of(place.config, other) == value_of(config, other)
    assert min(offsets_of(config, "gap")) == 0


def test_what_is_drawn_scatters_by_the_tolerances() -> None:
    generator = np.random.default_rng(3)
    places = [drawn(Config(), generator, LAW) for _ in range(300)]
    tolerances = Config().calibration.tolerances
    for name in ("gap", "neuron", "wavelength_min", "detector_radius"):
        spread = np.std([value_of(place.config, name) for place in places])
        assert spread == pytest.approx(getattr(tolerances, name), rel=0.15), name
    following = [place.focus - LAW * place.diameter for place in places]
    assert np.std(following) == pytest.approx(tolerances.focus, rel=0.15)


@pytest.mark.parametrize("aperture", [1.5, 1.51])
def test_an_instrument_near_its_limits_is_drawn_within_them(aperture: float) -> None:
    config = load_config({"objective": {"numerical_aperture": aperture}})
    generator = np.random.default_rng(1)
    for _ in range(300):
        place = drawn(config, generator, 0.58)
        glass = place.config.scene.refractive_index.glass
        assert place.config.objective.numerical_aperture < glass
