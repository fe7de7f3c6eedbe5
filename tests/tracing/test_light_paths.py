"""Codes and names of light paths."""

from octsim.tracing.light_paths import path_name


def test_a_path_is_named_after_the_surfaces_of_its_scene() -> None:
    assert path_name(0b1_01_10_01, ("P", "C")) == "PT CR PT"
    assert path_name(1, ("P", "C")) == ""
    # in base 6: through the film, off the cylinder, back through the film
    assert path_name(((6 + 3) * 6 + 4) * 6 + 3, ("P", "film ", "C")) == "film T CR film T"
