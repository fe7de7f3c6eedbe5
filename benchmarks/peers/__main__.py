"""Measure octsim beside its peers, and write it to docs/peers.md.

    PYTHONPATH=benchmarks python -m peers [NAME …]

Run by `make bench-peers`, which makes the environments. Each part of the page stands between marks
of its name and is measured in one run with octsim; names as arguments choose some of the parts. A
peer that can't be had is named there with the reason.
"""

import sys
from collections.abc import Callable

from marked import write_part
from peers import blender, chances, claim, fdtd, partial_waves, ray_tracers, speed_ups
from peers.others import ROOT, LeftOutError

PAGE = ROOT / "docs" / "peers.md"
SECTIONS: dict[str, Callable[[], str]] = {
    "claim": claim.section,
    "fdtd": fdtd.section,
    "partial waves": partial_waves.section,
    "cycles": blender.section,
    "chances": chances.section,
    "speed-ups": speed_ups.section,
    "ray tracers": ray_tracers.section,
}


def main() -> None:
    """Measure what is asked for, or all of it."""
    for name in sys.argv[1:] or SECTIONS:
        try:
            text = SECTIONS[name]()
        except LeftOutError as error:
            text = f"Left out: {error}."
        print(f"{name}\n\n{text}\n", flush=True)
        write_part(PAGE, name, [text])


if __name__ == "__main__":
    main()
