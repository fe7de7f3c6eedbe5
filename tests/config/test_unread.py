"""Keys that are given and not read are said, and nothing is said of what a run recorded."""

import json
import warnings
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
import xarray as xr
import yaml
from pydantic import BaseModel

from octsim.base.errors import OctsimWarning
from octsim.config.derive import merge
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.config.processing import Processing, options_read
from octsim.config.unread import unread_scene
from octsim.datasets.catalog import CATALOG, STAGES
from octsim.phase.estimators import ESTIMATORS, phases

ROOT = Path(__file__).parents[2]


def said(*overlays: Any) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", OctsimWarning)
        load_config(*overlays)
    return [str(one.message) for one in caught]


VOGEL, FFT = "tracing.scheme: vogel does not", "processing.estimator: fft does not"
OUT = "read it; leave it out, or give"
COUNT = "read it (only the focus scan's count of rays does); leave it out, or give"
UNREAD: list[tuple[dict[str, Any], str]] = [
    (
        {"tracing": {"accuracy": 1e-6}},
        f"tracing.accuracy: 1e-06 given, but {VOGEL} {OUT} tracing.scheme: paths",
    ),
    ({"tracing": {"accuracy": 1e-4}}, "tracing.accuracy: 0.0001 given"),
    ({"tracing": {"scheme": "vogel", "accuracy": 1e-4, "rays": 3000}}, "tracing.accuracy: "),
    (
        {"tracing": {"preset": "standard", "rays": 100_000}},
        f"tracing.rays: 100000 given, but tracing.scheme: paths does not {COUNT} "
        "tracing.scheme: vogel in the place of tracing.preset",
    ),
    ({"tracing": {"scheme": "paths", "min_amplitude": 1e-3}}, "tracing.min_amplitude: 0.001 given"),
    (
        {"tracing": {"scheme": "vogel", "preset": "draft"}},
        f"tracing.preset: draft given, but {VOGEL} {OUT} tracing.scheme: paths",
    ),
    (
        {"processing": {"hilbert": {"band": 0.4}}},
        f"processing.hilbert.band: 0.4 given, but {FFT} {OUT} processing.estimator: hilbert",
    ),
    ({"processing": {"estimator": "hilbert", "esprit": {"poles": 5}}}, "processing.esprit.poles:"),
    ({"processing": {"depth": "2 um"}}, f"processing.depth: 2 um given, but {FFT}"),
    (
        {"processing": {"sinusoid": {"weights": "shot"}}},
        f"{FFT} read it (only calibration, by calibration.estimator: sinusoid, does)",
    ),
    ({"processing": {"estimator": "sinusoid", "read_noise": 2.0}}, "processing.read_noise: 2.0"),
    (
        {"processing": {"centre_degree": 2}},
        f"but processing.centre: midpoint does not {OUT} processing.centre: polynomial",
    ),
    ({"grid": {"tracing.accuracy": [1e-3, 1e-4]}}, "grid.tracing.accuracy: [0.001, 0.0001] given"),
    ({"grid": {"processing.hilbert": [{"band": 0.4}, {"band": 0.5}]}}, "grid.processing.hilbert: "),
]


@pytest.mark.parametrize(("overlay", "line"), UNREAD, ids=[line[:40] for _, line in UNREAD])
def test_a_key_that_is_not_read_is_named_once_with_its_remedy(
    overlay: dict[str, Any], line: str
) -> None:
    (only,) = said(overlay)
    assert line in only
    # as the workflow gives it: the file, and what snakemake has merged of it
    assert said(overlay, overlay) == [only]


READ: list[dict[str, Any]] = [
    {"tracing": {"preset": "standard"}},
    {"tracing": {"preset": "standard", "accuracy": 1e-5}},
    {"tracing": {"rays": 100, "min_amplitude": 1e-4}},
    {"tracing": {"preset": None}},
    {"grid": None},
    {"processing": {"estimator": "sinusoid", "sinusoid": {"weights": "shot"}, "read_noise": 2.0}},
    {"processing": {"estimator": "maximum_likelihood", "read_noise": 2.0}},
    {"processing": {"sinusoid": {"weights": "shot"}}, "calibration": {"step": "0.2 nm"}},
    {"tracing": {"rays": 100, "accuracy": 1e-3}, "grid": {"tracing.scheme": ["vogel", "paths"]}},
    {"grid": {"processing.estimator": ["fft", "hilbert"], "processing.hilbert.band": [0.3, 0.4]}},
]


@pytest.mark.parametrize("overlay", READ, ids=map(str, READ))
def test_nothing_is_said_of_what_is_read_at_some_combination(overlay: dict[str, Any]) -> None:
    assert said(overlay) == []


def test_whole_configs_load_in_silence(tmp_path: Path) -> None:
    default = ROOT / "config" / "default.yaml"
    assert said(default) == said(default, yaml.safe_load(default.read_text())) == []
    for overlay, _ in UNREAD:
        config = load_config(overlay)
        for recorded in (config.to_dict(), config.to_record()):
            if config.tracing.preset and config.tracing.scheme == "vogel":
                continue  # as by hand, in a copy of config/default.yaml
            file = tmp_path / "config.json"
            file.write_text(json.dumps(recorded))
            assert said(file) == said(file, json.loads(file.read_text())) == []


@pytest.mark.parametrize(
    "file", sorted((ROOT / "tests" / "old").rglob("*.nc")), ids=lambda f: f.parent.name + f.stem
)
def test_configs_of_older_versions_load_in_silence(file: Path) -> None:
    with xr.open_dataset(file) as dataset:
        assert said(json.loads(dataset.attrs["config"])) == []


def test_of_a_whole_config_what_is_edited_is_said() -> None:
    default = ROOT / "config" / "default.yaml"
    edited = yaml.safe_load(default.read_text())
    edited["tracing"]["accuracy"] = 1e-6
    assert [line[:16] for line in said(edited)] == ["tracing.accuracy"]
    assert said(default, {"tracing": {"accuracy": 1e-6}}) == said(default, edited) == said(edited)
    recorded = Config().to_dict()
    assert said(recorded, {"tracing": {"accuracy": 1e-6}}) == said(edited)
    preset = yaml.safe_load(default.read_text())
    preset["tracing"]["preset"] = "standard"
    assert [line[:14] for line in said(preset)] == ["tracing.preset"]


def test_counted_rays_are_read_by_the_focus_scan_alone_whatever_the_scheme() -> None:
    assert [stage for stage in STAGES if CATALOG[stage].counts_rays] == ["focus_scan"]


class Watched:
    """A part of a config that notes which of its keys are read."""

    def __init__(self, part: BaseModel, read: set[str], prefix: str = "") -> None:
        self._part, self._read, self._prefix = part, read, prefix

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._part, name)
        if isinstance(value, BaseModel):
            return Watched(value, self._read, f"{self._prefix}{name}.")
        self._read.add(self._prefix + name)
        return value


@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize("weights", ["equal", "shot"])
def test_an_estimator_reads_the_options_that_are_said_to_be_read(
    estimator: str, weights: str
) -> None:
    processing = Processing.model_validate(
        {"estimator": estimator, "sinusoid": {"weights": weights}}
    )
    k, depth = np.linspace(7, 9.7, 200), np.array([1.9])
    spectra = 2 + np.cos(2 * 1.9 * (k - k.mean()) + 0.3)[np.newaxis]
    read: set[str] = set()
    phases(spectra, k, depth, Watched(processing, read))  # type: ignore[arg-type]
    # the transform reads them for fourier.nc, whatever the estimator; and all read a given depth
    read -= {"estimator", "centre", "window", "centre_degree"}
    if estimator == "fft":
        read.discard("depth")  # whose phase is not that of the depth
    if weights == "equal":
        read.discard("read_noise")  # which equal weights have no use for
    assert read == options_read(processing)
    assert {*ESTIMATORS, "maximum_likelihood"} == set(
        get_args(Processing.model_fields["estimator"].annotation)
    )


def test_a_gap_without_a_cylinder_is_said_to_be_read_by_nothing() -> None:
    film = {"medium": "water", "thickness": "swept"}
    scene = {"layers": ["glass", film, "glass"], "cylinders": [], "gap": "7 nm"}
    config = Config.model_validate(merge(Config().to_dict(), {"scene": scene}))
    (said,) = unread_scene(config, {"scene.gap": "7 nm"})
    assert said == (
        "scene.gap: 7 nm given, but there is no cylinder, so nothing reads it; leave it out"
    )
