"""Names of a grid's axes in its datasets."""

from octsim.config.known_keys import known_keys
from octsim.datasets.axes import dimension_name


def test_every_key_gives_a_dimension_of_its_own() -> None:
    names = [dimension_name(key) for key in known_keys()]
    assert len(set(names)) == len(names)
