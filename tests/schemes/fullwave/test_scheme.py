"""A point has the same bits alone and in any company."""

import hashlib
import os
import subprocess
import sys
import threading
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

import octsim
from octsim.base.errors import OctsimError
from octsim.base.threads import each
from octsim.config.load import load_config
from octsim.instrument.build import optics_of, scene_of
from octsim.instrument.point_store import PointStore
from octsim.instrument.points import Points
from octsim.schemes.fullwave import operators
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.orders import Orders
from octsim.schemes.fullwave.scheme import tracer
from octsim.schemes.light import LightAt, Waves

CONFIG = load_config({"tracing": {"scheme": "fullwave", "accuracy": 1e-3}})
POINTS = [(d, focus) for d in (1.0, 1.3, 2.2) for focus in (-0.5, 0.4, 0.6, 2.5)]


def light_at() -> LightAt:
    return tracer(optics_of(CONFIG), {"accuracy": 1e-3})


def solved(points: Sequence[tuple[float, float]], threads: int = 0) -> list[bytes]:
    """Return the bits of some points, by one tracer."""
    traced = light_at()

    def bits(point: tuple[float, float]) -> bytes:
        diameter, focus = point
        found = traced(scene_of(CONFIG, diameter), focus)
        assert isinstance(found, Waves)
        return b"".join(
            part.tobytes()
            for part in (found.wavenumber, found.values, found.terms, np.array(found.error))
        )

    return list(each(bits, points, threads)) if threads else [bits(point) for point in points]


def test_points_are_the_same_alone_in_company_in_other_orders_and_from_threads() -> None:
    alone = [solved([point])[0] for point in POINTS]
    assert solved(POINTS) == alone
    assert solved(POINTS[::-1]) == alone[::-1]
    # foci in turn, so that operators are made again
    mixed = [number for begin in range(4) for number in range(begin, len(POINTS), 4)]
    assert solved([POINTS[i] for i in mixed]) == [alone[i] for i in mixed]
    assert solved(POINTS, threads=3) == alone


@pytest.mark.parametrize("threads", ["1", "2"])
def test_bits_do_not_follow_the_threads_of_linear_algebra(threads: str) -> None:
    code = (
        "import hashlib, sys; sys.path[:0] = sys.argv[1:]\n"
        "from schemes.fullwave.test_scheme import POINTS, solved\n"
        "print(hashlib.sha256(b''.join(solved(POINTS[:5]))).hexdigest())"
    )
    tests = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", code, str(tests)], capture_output=True, text=True, check=True,
        env={**os.environ, "OPENBLAS_NUM_THREADS": threads},
    )  # fmt: skip
    assert done.stdout.strip() == hashlib.sha256(b"".join(solved(POINTS[:5]))).hexdigest()


def test_points_from_the_store_are_those_that_are_solved(tmp_path: Path) -> None:
    config = load_config(
        {"tracing": {"scheme": "fullwave", "accuracy": 1e-3}},
        {"sweep": {"diameters": {"num": 11}, "focus": {"slope": 0.58, "intercept": "69 nm"}}},
    )
    found = []
    for traced, kept in ((11, 0), (0, 11)):
        points = Points(PointStore(tmp_path / "points", 1))
        solved_fields = octsim.fields(config, None, 1, points)
        found.append(octsim.spectra(config, fields=solved_fields))
        assert (points.traced, points.from_cache) == (traced, kept)
    plain = octsim.spectra(config, fields=octsim.fields(config))
    for one in found:
        assert one["intensity"].values.tobytes() == plain["intensity"].values.tobytes()


def test_a_focus_scan_makes_few_operators(monkeypatch: pytest.MonkeyPatch) -> None:
    made, operator = [], operators.operator

    def counted(*given: object) -> operators.Operator:
        made.append(given)
        return operator(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(operators, "operator", counted)
    traced, scene = light_at(), scene_of(CONFIG, 2.0)
    foci = np.linspace(0, 4, 51).tolist()
    for focus in foci:
        traced(scene, focus)
    assert len(made) < len(foci)


def test_an_aperture_at_the_waters_index_is_refused() -> None:
    for aperture in (1.33, 1.4):
        optics = optics_of(CONFIG)._replace(numerical_aperture=aperture)
        with pytest.raises(OctsimError, match=r"numerical_aperture: 1\.\d+ given, .* below"):
            tracer(optics, {"accuracy": 1e-3})(scene_of(CONFIG, 1.2), 0.7)


def test_threads_make_their_operators_at_the_same_time(monkeypatch: pytest.MonkeyPatch) -> None:
    both, operator = threading.Barrier(2, timeout=30), operators.operator

    def met(*given: object) -> operators.Operator:
        both.wait()  # broken, and raises, if the other thread does not come
        return operator(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(operators, "operator", met)
    shared, orders = operators.Operators(), Orders(8, 8, 20, 6)
    k = np.array([8.0])
    scenes = [CylinderOnPlane(1.52, 1.33, 1.39, 0.005, d) for d in (0.5, 0.6)]
    made = list(each(lambda one: shared.of(one, 1.0, k, orders), scenes, 2))
    assert made[0] is not made[1]
    kept = [shared.of(one, 1.0, k, orders) for one in scenes]
    assert all(one is other for one, other in zip(kept, made, strict=True))


def test_an_operator_that_failed_is_tried_again(monkeypatch: pytest.MonkeyPatch) -> None:
    given = CylinderOnPlane(1.52, 1.33, 1.39, 0.005, 0.5), 1.0, np.array([8.0]), Orders(8, 8, 20, 6)
    shared = operators.Operators()

    def fails(*_: object) -> operators.Operator:
        raise MemoryError

    with monkeypatch.context() as patched:
        patched.setattr(operators, "operator", fails)
        with pytest.raises(MemoryError):
            shared.of(*given)
    assert shared.of(*given).k is given[2]
