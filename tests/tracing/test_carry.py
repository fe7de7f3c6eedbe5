"""What rays carry: another kind than the amplitude, and compiled code that is found again."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from literal import spiral

from octsim.config.load import load_config
from octsim.instrument.build import detector_of, scene_of
from octsim.optics.detector import lens_correction
from octsim.tracing.carry import AMPLITUDE
from octsim.tracing.kernel import make_tree
from octsim.tracing.lengths import with_lengths
from octsim.tracing.tree import arrivals

LENGTHS_TOO = with_lengths(AMPLITUDE, 3)
CONFIG = load_config({"tracing": {"rays": 300}})
TESTS = Path(__file__).parents[1]


def test_rays_can_carry_the_lengths_of_their_ways_too() -> None:
    scene, beam, detector = scene_of(CONFIG, 1.4), spiral(CONFIG), detector_of(CONFIG)
    for focus, faint in ((0.88, 0.0), (0.1, 1e-3)):
        plain = arrivals(scene, beam, detector, focus, 11, faint)
        found = arrivals(scene, beam, detector, focus, 11, faint, tree=make_tree(LENGTHS_TOO))
        for name in plain._fields:
            if name != "carried":
                assert np.array_equal(getattr(found, name), getattr(plain, name)), name
        amplitude, *lengths = found.carried
        assert np.array_equal(amplitude, plain.carried[0])
        index = [region.material.index(8.0).real for region in scene.regions]
        squared = found.x**2 + found.y**2
        lens = [lens_correction(s, detector.magnification, detector.focal_length) for s in squared]
        geometric = sum(n * length for n, length in zip(index, lengths, strict=True))
        assert found.optical_path_length == pytest.approx(geometric + np.array(lens), abs=1e-12)
        assert (lengths[1] >= 0).all()
        assert lengths[2].max() >= 2.8  # through the neuron and back


def test_compiled_trees_are_found_again_by_another_process() -> None:
    code = (
        "from test_carry import CONFIG, LENGTHS_TOO, arrivals, detector_of, make_tree, scene_of\n"
        "from literal import spiral\n"
        "from octsim.tracing.kernel import trace_amplitudes\n"
        "for tree in (make_tree(LENGTHS_TOO), trace_amplitudes):\n"
        "    optics = scene_of(CONFIG, 1.4), spiral(CONFIG), detector_of(CONFIG)\n"
        "    arrivals(*optics, 0.88, tree=tree)\n"
        "    print(sum(tree.stats.cache_hits.values()), sum(tree.stats.cache_misses.values()))\n"
    )
    places = os.pathsep.join(map(str, (TESTS.parent, TESTS, TESTS / "tracing")))
    for _ in range(2):
        found = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True,
            env=os.environ | {"PYTHONPATH": places},
        )  # fmt: skip
    assert found.stdout.split("\n")[:2] == ["1 0", "1 0"]
