"""Every public name has an example, and it runs as it is written."""

import doctest

import pytest
from made_runs import few_parameters

import octsim
from octsim.studies.calibration import parameters, round_trips


@pytest.mark.parametrize("name", sorted(vars(octsim)["__all__"]))
def test_the_example_of_a_public_name_runs(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(round_trips, "TRIALS", 2)  # of the action potential, a minute each 100
    # of a calibration no example shows the others
    monkeypatch.setattr(parameters, "PARAMETERS", few_parameters("diameter"))
    thing = getattr(octsim, name)
    (example,) = doctest.DocTestFinder(recurse=False).find(thing, name, globs={name: thing})
    assert any("octsim." in one.source for one in example.examples)
    said: list[str] = []
    doctest.DocTestRunner(verbose=False).run(example, out=said.append)
    assert not said, "".join(said)
