"""What scheme fullwave can't reach is refused, or said beforehand."""

from typing import Any

import pytest

from octsim.base.errors import ConfigError, OctsimWarning
from octsim.config.load import load_config

EXACT: dict[str, Any] = {"tracing": {"preset": "exact"}}


@pytest.mark.parametrize("aperture", [1.33, 1.4])
def test_waves_need_an_aperture_below_the_index_of_water(aperture: float) -> None:
    wide = {"objective": {"numerical_aperture": aperture}}
    with pytest.raises(ConfigError, match=r"^objective\.numerical_aperture: .*") as caught:
        load_config(EXACT, wide)
    said = str(caught.value)
    assert f"{aperture} given, but tracing.scheme: fullwave" in said
    assert said.endswith(
        "below scene.refractive_index.water = 1.33, or tracing.scheme: vogel or paths"
    )
    assert "\n" not in said
    load_config(wide)


@pytest.mark.parametrize(
    ("overlay", "key"),
    [
        ({"sweep": {"diameters": {"stop": "40 um"}}}, "sweep.diameters.stop: 40.0 um takes"),
        ({"scene": {"gap": "1 mm"}}, "scene.gap: 1000.0 um takes"),
    ],
)
def test_what_passes_the_budget_of_waves_is_said_beforehand(
    overlay: dict[str, Any], key: str
) -> None:
    with pytest.warns(OctsimWarning) as told:
        load_config(EXACT, overlay)
    said = [str(one.message) for one in told if key in str(one.message)]
    assert len(said) == 1
    assert "budget_spent" in said[0]
