"""The thesis's list of what could make its rays faster, each answered with a number."""

import os

from bench import CORES, trees
from peers.others import table


def section() -> str:
    """Measure, and write the page's part."""
    load = os.getloadavg()[0]  # of others' work too, which takes from what more cores give
    rate = {name: per_second for name, per_second, _ in trees()}
    one = rate["octsim, one core"]

    def times(name: str) -> str:
        return f"{rate[name] / one:.2g}" if name in rate else "not measured: no C compiler"

    cores = f"{CORES} cores, on a machine whose load was {load:.1f} before"
    breadth_first = "numpy, breadth first"

    return table(
        ["the thesis's idea", "what was tried", "times as fast as octsim's tree on one core"],
        [
            ["memory management, algorithms", breadth_first, times(breadth_first)],
            ["C++", "C, same arithmetic, scalar", times("C, same arithmetic, scalar")],
            ["", "C, same arithmetic, SIMD", times("C, same arithmetic, SIMD")],
            ["C++ and algorithms", "C, by this scene's invariants, SIMD",
             times("C, this scene's invariants, SIMD")],
            ["parallelization", cores, times(f"octsim, {CORES} cores")],
            ["a GPU", "not measured: this machine has none", ""],
        ],
    )  # fmt: skip
