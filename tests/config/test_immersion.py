"""An immersion of another medium than the slide: what is asked for by it, and what is refused."""

from typing import Any

import pytest

from octsim import load_config
from octsim.base.errors import ConfigError
from octsim.config.derive import merge
from octsim.config.immersion import aberration_terms, of_slide
from octsim.config.models import Config
from octsim.config.scene_keys import scene_values
from octsim.config.told import told
from octsim.datasets.keys import keys_behind
from octsim.optics.slide import slide_aberration

pytestmark = pytest.mark.filterwarnings("ignore::octsim.base.errors.OctsimWarning")


def oil(index: float = 1.515, thickness: str | None = "170 um", **more: Any) -> dict[str, Any]:
    slide: Any = "glass" if thickness is None else {"medium": "glass", "thickness": thickness}
    return {
        "objective": {"immersion": "oil", **more},
        "scene": {"refractive_index": {"oil": index}, "layers": [slide, "water"]},
    }


ABSORBING = {"table": {"wavelength": [0.6, 1.0], "n": [1.51, 1.51], "kappa": [0.01, 0.01]}}


def merged_focus(config: Config) -> Config:
    """Return a config that does not follow from a focus law."""
    return load_config(config.to_dict(), {"sweep": {"focus": {"slope": 0.58, "intercept": "0 um"}}})


def test_an_immersion_and_its_slide_add_their_aberration_to_the_objectives() -> None:
    config = load_config(oil(zernike={"coma x": "5 nm"}))
    slide = slide_aberration(1.2, 1.515, 1.52, 170.0)
    assert aberration_terms(config) == ((8, 0.005), *slide.terms)
    assert Config().objective.immersion is None
    assert aberration_terms(Config()) == ()
    assert of_slide(Config()) is None


def test_the_scene_itself_is_as_without_one() -> None:
    config, plain = load_config(oil()), Config()
    assert config.scene.floor == plain.scene.floor == 0
    assert config.objective_index == plain.objective_index


def test_its_index_and_the_slides_thickness_are_numbers_that_tolerances_may_name() -> None:
    values = scene_values(load_config(oil()))
    assert values["scene.refractive_index.oil"] == 1.515
    assert values["scene.layers.0.thickness"] == 170


def test_it_is_said_in_words() -> None:
    scene, aberration = told(load_config(oil()))
    assert "oil (n 1.515) below glass (n 1.52) of 170 um" in scene
    assert aberration == "objective.immersion: the slide aberrates by 18.9 nm rms, once"


REFUSED: list[tuple[dict[str, Any], str]] = [
    (oil(thickness=None), "objective.immersion: oil given, but the slide above it, scene.layers.0, has no thickness; give it as {medium: glass, thickness: 170 um}"),
    ({"objective": {"immersion": "oil"}, "scene": {"layers": [{"medium": "glass", "thickness": "1 um"}, "water"]}}, "objective.immersion: oil given, which has no refractive index; give scene.refractive_index.oil"),
    ({"scene": {"layers": [{"medium": "glass", "thickness": "1 um"}, "water"]}}, "scene.layers.0.thickness: given, but the lowest layer has no end; leave it out, or name in objective.immersion what is below it"),
    (oil(index=1.1), "objective.numerical_aperture: 1.2 given; it must be below the index of oil, the immersion, scene.refractive_index.oil = 1.1"),
    (oil(thickness="400 um"), "scene.layers.0.thickness: 400.0 um given; the slide must be thinner than objective.focus_distance = 300.0 um"),
    (merge(oil(), {"scene": {"attenuation": {"glass": "1 /cm"}}}), "objective.immersion: oil given, but glass attenuates, whose way below the scene is not that of an objective in glass; leave its attenuation out"),
    (merge(oil(), {"scene": {"attenuation": {"oil": "1 /cm"}}}), "scene.attenuation.oil: given, but nothing in the scene is of oil"),
    (merge(oil(), {"scene": {"refractive_index": {"oil": ABSORBING}}}), "objective.immersion: oil given, but oil attenuates"),
    (oil(immersion="oil immersion"), "objective.immersion: 'oil immersion' given"),
    ({"scene": {"refractive_index": {"oil": 1.515}}}, "scene.refractive_index.oil: 1.515 given, but nothing in the scene is of oil"),
]  # fmt: skip


@pytest.mark.parametrize(("overlay", "line"), REFUSED)
def test_an_impossible_immersion_is_refused_in_a_line(overlay: dict[str, Any], line: str) -> None:
    with pytest.raises(ConfigError) as raised:
        load_config(overlay)
    assert str(raised.value).startswith(line)


def test_what_is_left_out_of_an_aberration_is_remarked() -> None:
    with pytest.warns(match=r"aberrates by 1.43 um rms, of which 0.014 um is finer than Zernike"):
        load_config(oil(index=1.33))
    disperses = {"oil": {"cauchy": [1.4982, 0.008]}, "glass": "N-BK7"}
    with pytest.warns(match=r"moves the focus by [-+]0\.\d+ um from the shortest to the longest"):
        load_config(merge(oil(), {"scene": {"refractive_index": disperses}}))


def test_an_immersion_of_the_slides_index_is_none() -> None:
    config = load_config(oil(index=1.52))
    assert of_slide(config) is None
    assert aberration_terms(config) == ()


def test_light_through_a_dispersive_immersion_follows_from_the_band() -> None:
    plain, dispersive = (
        load_config(merge(oil(), {"scene": {"refractive_index": {"oil": index}}}))
        for index in (1.515, {"cauchy": [1.49, 0.012]})
    )
    assert "spectrum.wavelength" not in keys_behind("detections", merged_focus(plain))
    assert "spectrum.wavelength" in keys_behind("detections", merged_focus(dispersive))


def test_an_aberration_by_which_the_focus_is_lost_is_remarked() -> None:
    with pytest.warns(match=r"objective.immersion: oil below a slide of glass, 0.217 um, is 0.334"):
        load_config(oil(index=1.47))
