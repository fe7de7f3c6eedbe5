"""Ray tracers that can split a ray, beside octsim's.

Each peer traces a Vogel beam through the same scene, as far as it can build it, and takes turns
with octsim on one thread; its ratio is that of segments a second. A peer that cannot be had, or
cannot trace this, is named with the reason.
"""

import statistics
import time
from collections.abc import Callable
from importlib.metadata import version
from typing import NamedTuple

from peers.by_optiland import optiland_work
from peers.by_pyoptools import pyoptools_work
from peers.others import table
from peers.ray_job import RAYS, Counts, Job, Work, job_of, octsim_work

ROUNDS = 7


class Peer(NamedTuple):
    """A peer, and what was read of it in its source."""

    distribution: str
    mode: str
    rays: int
    """As many as take it a good part of a second."""
    build: Callable[[Job], Work]
    needs: tuple[str, ...]
    """What it has, or lacks, of `NEEDS`, one for each."""


class Result(NamedTuple):
    """What was measured of a peer."""

    counts: Counts
    expected: Counts
    """octsim's own, of the same rays."""
    rate: float
    speed: float
    """octsim's rate over the peer's."""
    touching: str
    """Segments of the axial ray without a gap, over octsim's."""


NEEDS = (
    "signed amplitudes",
    "optical path length",
    "which light path a ray took",
    "a given beam",
    "the objective as a surface in the glass",
    "neighbouring surfaces",
)
PEERS = (
    Peer(
        "optiland",
        "non-sequential mode",
        RAYS,
        optiland_work,
        (
            "lacks: a ray has a flux, multiplied by R or 1 − R of unpolarised light",
            "lacks: neither `NSQRayBundle` nor a detector has a field for it",
            "lacks: one child of each split gets a new `ray_id`, without its parent's",
            "lacks: its sources draw rays at random; done here by a source of its kind",
            "has",
            "hits nearer than 1e-9 of its lengths are dropped, by an epsilon",
        ),
    ),
    Peer(
        "pyoptools",
        "`System`",
        200,
        pyoptools_work,
        (
            "lacks: a ray has an intensity, split by a constant of the surface; no Fresnel "
            "equations",
            "has: `optical_path_parent`, summed up the tree for each ray anew",
            "has: each ray knows its parent and its surface",
            "has",
            "lacks: outside each component it takes the system's medium; done here without",
            "hits nearer than 1e-10 are dropped; components within 1e-12 of each other are "
            "in contact, and two that both split are then refused",
        ),
    ),
)


def seconds_of(work: Work) -> float:
    """Time a trace."""
    began = time.perf_counter()
    work.trace()
    return time.perf_counter() - began


def touching(peer: Peer) -> str:
    """Trace the axial ray where cylinder and plane touch: segments found, of octsim's."""
    job = job_of(1, gap=0.0)
    ours, theirs = octsim_work(job), peer.build(job)
    expected = ours.count(ours.trace()).segments
    try:
        return f"{theirs.count(theirs.trace()).segments} of {expected}"
    except RuntimeError as error:
        return f"refused: {error}"


def measure(peer: Peer) -> Result:
    """Let a peer and octsim take turns."""
    same_rays = job_of(peer.rays)
    theirs, ours, same = (
        peer.build(same_rays),
        octsim_work(job_of(RAYS)),
        octsim_work(same_rays),
    )
    counts, our_counts = theirs.count(theirs.trace()), ours.count(ours.trace())
    seconds = [(seconds_of(ours), seconds_of(theirs)) for _ in range(ROUNDS)]
    return Result(
        counts,
        same.count(same.trace()),
        counts.segments / statistics.median(their for _, their in seconds),
        statistics.median(their / our for our, their in seconds)
        * our_counts.segments
        / counts.segments,
        touching(peer),
    )


def section() -> str:
    """Measure all ray tracers, and write the page's part."""
    results: list[tuple[Peer, Result]] = []
    refused: list[str] = []
    for peer in PEERS:
        try:
            results.append((peer, measure(peer)))
        except (ImportError, AttributeError, TypeError, ValueError, RuntimeError) as error:
            reason = f"{type(error).__name__}: {error}".splitlines()[0]
            refused.append(f"{peer.distribution} was left out: {reason}")
    measured = table(
        [
            "peer", "rays", "segments, of octsim's", "detected, of octsim's",
            "thousand segments a second", "octsim is so many times as fast",
            "segments of the axial ray without a gap",
        ],
        [
            [
                f"{peer.distribution} {version(peer.distribution)}, {peer.mode}", f"{peer.rays}",
                f"{result.counts.segments} of {result.expected.segments}",
                f"{result.counts.detected} of {result.expected.detected}",
                f"{result.rate / 1e3:.3g}", f"{result.speed:.3g}", result.touching,
            ]
            for peer, result in results
        ],
    )  # fmt: skip
    lacks = table(
        ["", *(peer.distribution for peer, _ in results)],
        [[need, *(peer.needs[i] for peer, _ in results)] for i, need in enumerate(NEEDS)],
    )
    told = "Read in the source of the versions above, what this job needs of them:"
    return "\n\n".join((measured, *refused, told, lacks))
