"""The workflow: a run from nothing, what an edit reruns, what is refused, what survives."""

import json
import os
import shutil
import subprocess
import sys
import zipfile
from datetime import date
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
import yaml
from checkout import DATASETS, GIVEN, GRID, ROOT, TINY, Checkout, Finished, counts, merged
from edits import EDITS, EVERYTHING, edit_of
from trials import trials

from octsim.config.known_keys import known_keys
from octsim.config.models import Config
from octsim.datasets.gallery import CAPTIONS, FORMS

STAGES = [
    "focus_scan", "focus_sweep", "gaussian_fits", "focus_law", "detections", "spectra", "paths",
    "fourier", "phase_slope",
]  # fmt: skip
FIGURES = [*(f"figure_{number}" for number in (1, 6, 7, 8, 9, 10, 11, 12)), "paths"]


@pytest.fixture(scope="module")
def law(finished: Finished, tmp_path_factory: pytest.TempPathFactory) -> Checkout:
    return finished.copy(tmp_path_factory.mktemp("law"))


@pytest.fixture(scope="module")
def given(tmp_path_factory: pytest.TempPathFactory) -> Checkout:
    checkout = Checkout(tmp_path_factory.mktemp("given"))
    checkout.run(merged(TINY, GIVEN), *DATASETS)
    return checkout


def test_a_run_leaves_every_dataset_figure_log_and_benchmark(law: Checkout) -> None:
    folder = law.folder / "results" / "tiny"
    for stage in STAGES:
        with xr.open_dataset(folder / f"{stage}.nc") as dataset:
            assert dataset.attrs["stage"] == stage
    for figure in FIGURES:
        for form in ("png", "svg"):
            assert (folder / "figures" / f"{figure}.{form}").stat().st_size > 1000
    for stage, points in {"focus_scan": 5, "focus_sweep": 27, "detections": 9}.items():
        counts = json.loads((folder / "logs" / f"{stage}.json").read_text())
        assert sum(counts.values()) == points
        assert set(counts) == {"points_traced", "points_from_cache"}
        assert (folder / "benchmarks" / f"{stage}.tsv").exists()
        assert (folder / "logs" / f"{stage}.log").exists()


def test_a_second_run_does_nothing(law: Checkout) -> None:
    assert law.would_run(TINY) == set()


def test_the_same_config_in_other_units_and_order_reruns_nothing(law: Checkout) -> None:
    other = merged(TINY, {"scene": {"gap": "0.005 um"}, "objective": {"magnification": 20.0}})
    assert law.would_run(dict(reversed(other.items()))) == set()


def test_snakemakes_own_report_has_every_figure_with_its_caption(law: Checkout) -> None:
    law.run(TINY, "--report", "report.html")
    text = (law.folder / "report.html").read_text(encoding="utf-8")
    for figure in FIGURES:
        assert f"{figure}.png" in text
        assert CAPTIONS[figure] in text
    (law.folder / "report.html").unlink()


# of targets that are no part of a run
OTHERS: dict[str, Any] = {
    "measured": {"average": 2, "dispersion": {"a2": 1.0, "a3": 0.5}},
    "calibration": {
        "diameters": {"num": 9},
        "step": "0.2 nm",
        "estimator": "fft",
        "scheme": "paths",
        "tolerances": {
            "diameter": "1 nm",
            "gap": "1 nm",
            "glass": 0.01,
            "water": 0.01,
            "neuron": 0.01,
            "focus": "1 nm",
            "numerical_aperture": 0.1,
            "detector_radius": "1 nm",
            "fill": 0.1,
            "polarisation": "1 deg",
            "offset": "1 nm",
            "wavelength_min": "1 nm",
            "wavelength_max": "1 nm",
            "scene.cylinders.0.azimuth": "1 deg",
        },
    },
    "expansion": {
        "series": "phases.csv",
        "diameter": "1.5 um",
        "rest": 5,
        "outliers": "drop",
        "drift": "linear",
        "fit": ["diameter", "gap"],
        "bands": [["650 nm", "760 nm"], ["760 nm", "900 nm"]],
    },
    "responses": {
        "diameters": {"num": 2},
        "membrane": {"thickness": "4 nm", "index": 1.45},
    },
    "action_potential": {"diameter": "1.5 um", "expansion": "2 nm", "photons": 1e9, "seed": 2},
    "design": {
        "photons": 1e5,
        "expansion": "2 nm",
        "diameters": {"num": 2},
        "fills": [0.4],
        "focus_offsets": {"num": 3},
        "apertures": [],
        "bands": [],
    },
    "archive": {
        "title": "Ours",
        "description": "Of ours.",
        "creators": [{"name": "Ada Ray"}],
        "license": "MIT",
        "date": "2026-01-31",
    },
}

# and of those, what goes with spectra only
SPECTRA: dict[str, Any] = {"measured": {"spectra": "counts.csv"}, "expansion": {"slope": "match"}}


def keys_in(part: Any, prefix: str = "") -> set[str]:
    """Give the dotted keys of an overlay, ranges as one."""
    if not isinstance(part, dict) or "num" in part:
        return {prefix.rstrip(".")}
    return {key for name, value in part.items() for key in keys_in(value, f"{prefix}{name}.")}


def test_every_key_is_edited_below() -> None:
    part: Any
    leaves = set()
    for key in known_keys():
        part = Config().to_dict()
        for name in key.split("."):
            part = part.get(name) if isinstance(part, dict) else None
        is_range = isinstance(part, dict) and "num" in part
        if is_range or (part is not None and not isinstance(part, dict)):
            leaves.add(key)
    ends = {f"{key}.{end}" for key in leaves for end in ("start", "stop", "num")}
    optional = {
        "expansion.series", "measured.spectra", "archive.title", "archive.description",
        "archive.date", "calibration.scheme", "calibration.tolerances.scene.cylinders.0.azimuth",
    }  # fmt: skip
    assert leaves - ends == set(EDITS) | (keys_in(OTHERS) | keys_in(SPECTRA)) - optional


def test_keys_of_other_targets_rerun_nothing_of_a_run(law: Checkout, given: Checkout) -> None:
    assert law.would_run(merged(TINY, OTHERS)) == set()
    assert law.would_run(merged(TINY, SPECTRA)) == set()
    assert given.would_run(merged(TINY, GIVEN, OTHERS), *DATASETS) == set()


# tests/datasets/test_keys.py has every key, without snakemake; these ask snakemake too
@pytest.mark.parametrize(
    "key",
    [
        "scene.gap",
        *trials("run", "tracing.accuracy", "focus_law.fraction", "processing.window"),
    ],
)
def test_an_edit_reruns_only_what_reads_the_key(key: str, law: Checkout, given: Checkout) -> None:
    _, with_law, with_focus = EDITS[key]
    assert law.would_run(merged(TINY, edit_of(key))) == with_law
    overlay = merged(TINY, GIVEN, edit_of(key))
    assert given.would_run(overlay, *DATASETS) == with_focus - {"figures"}


@pytest.mark.trial
def test_comments_and_formatting_of_the_sources_rerun_nothing(
    tmp_path: Path, compiled: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    checkout = Checkout(tmp_path)
    shutil.copytree(
        ROOT / "octsim", tmp_path / "octsim", ignore=shutil.ignore_patterns("__pycache__")
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(compiled))
    checkout.run(TINY, "--until", "focus_law")
    untouched = {"focus_scan", "detections", "spectra", "phase_slope", "figures"}
    source = tmp_path / "octsim" / "stages" / "gaussian_fits.py"
    text = source.read_text()
    source.write_text("# a comment\n" + text.replace("config, sweep", "config,  sweep"))
    assert checkout.would_run(TINY) == untouched
    source.write_text(text + "\nMORE = 1\n")
    assert checkout.would_run(TINY) == untouched | {"focus_law"}


@pytest.mark.parametrize(
    ("overlay", "message"),
    [
        ({"objective": {"na": 1}}, "octsim: objective.na: unknown key; the nearest known one is"),
        ({"scene": {"gap": 5}}, "octsim: scene.gap: 5 given; a length needs its unit"),
        ({"run": "../up"}, "octsim: run: '../up' given; it should be a plain name"),
    ],
)
def test_a_bad_config_is_one_line_and_touches_nothing(
    overlay: dict[str, Any], message: str, tmp_path: Path
) -> None:
    done = Checkout(tmp_path).snakemake(overlay)
    assert done.returncode != 0
    said = [line for line in done.stderr.splitlines() if "profile" not in line]
    assert len(said) == 1
    assert said[0].startswith(message)
    assert "Traceback" not in done.stdout + done.stderr
    assert not (tmp_path / "results").exists()


def test_a_key_that_stands_twice_is_refused(tmp_path: Path) -> None:
    checkout = Checkout(tmp_path)
    (tmp_path / "twice.yaml").write_text("scene: {gap: 1 nm}\nscene: {gap: 2 nm}\n")
    done = checkout.snakemake(TINY, "--configfile", "twice.yaml")
    assert done.returncode != 0
    assert "the key 'scene' stands twice" in done.stderr


def test_a_failed_stage_keeps_the_old_dataset_and_runs_again(
    finished: Finished, tmp_path: Path
) -> None:
    checkout = finished.copy(tmp_path)
    assert checkout.would_run(TINY) == set()
    before = checkout.results()["tiny/detections.nc"]
    no_law = merged(TINY, {"focus_law": {"fraction": {"stop": 0.42}}})
    for _ in range(2):  # the second time too: nothing that failed counts as done
        done = checkout.snakemake(no_law)
        assert done.returncode != 0
        assert "octsim: sweep.focus: 'law' given, but there is no law" in done.stderr
        assert "Traceback" not in done.stderr
        assert checkout.results()["tiny/detections.nc"] == before
    checkout.run(TINY, "--until", "detections")
    assert checkout.results()["tiny/detections.nc"] == before


def test_a_diameter_step_that_aliases_is_warned_of_once(tmp_path: Path) -> None:
    coarse = merged(TINY, {"sweep": {"diameters": {"num": 5}}})
    done = Checkout(tmp_path).snakemake(coarse, "--dry-run")
    assert done.returncode == 0
    assert done.stderr.count("octsim: warning: sweep.diameters: a step of 0.25 um") == 1


def test_a_dataset_is_made_again_by_the_command_that_it_records(
    law: Checkout, tmp_path: Path
) -> None:
    checkout = Checkout(tmp_path)
    with xr.open_dataset(law.folder / "results" / "tiny" / "focus_law.nc") as dataset:
        (tmp_path / "config.json").write_text(dataset.attrs["config"])
        command = dataset.attrs["creation_command"].split("then: ")[1]
    arguments = command.removeprefix(".venv/bin/snakemake").split()
    done = subprocess.run(
        [sys.executable, "-m", "snakemake", *arguments],
        cwd=tmp_path,
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    again = checkout.results()
    assert again == {name: law.results()[name] for name in again}
    assert set(again) == {"tiny/focus_sweep.nc", "tiny/gaussian_fits.nc", "tiny/focus_law.nc"}


def test_a_key_that_is_not_read_is_said_once(tmp_path: Path) -> None:
    done = Checkout(tmp_path).snakemake(merged(TINY, {"tracing": {"accuracy": 1e-6}}), "--dry-run")
    assert done.returncode == 0
    assert done.stderr.count("octsim: warning: tracing.accuracy: 1e-06 given") == 1


@pytest.mark.parametrize(
    "name",
    ["1e5", *trials("2024_06_01", "007")],
)
def test_a_name_that_reads_as_a_number_is_taken_as_the_line_says(name: str, tmp_path: Path) -> None:
    checkout = Checkout(tmp_path)
    refused = checkout.snakemake(TINY, "--dry-run", "--config", f"run='{name}'")
    assert refused.returncode != 0
    assert "write --config 'run=!!str NAME' on the command line" in refused.stderr
    for overlay, given in ((TINY, ["--config", f"run=!!str {name}"]), (TINY | {"run": name}, [])):
        done = checkout.snakemake(overlay, "--dry-run", *given)
        assert f"results/{name}/" in done.stdout, done.stdout + done.stderr


def test_every_run_has_its_own_folder_and_the_same_bits(law: Checkout, tmp_path: Path) -> None:
    checkout = Checkout(tmp_path)
    checkout.run(TINY, "--cores", "1", *DATASETS)
    assert checkout.datasets() == law.datasets()


def test_an_archive_is_packed_when_something_of_it_has_changed(law: Checkout) -> None:
    def archived(overlay: dict[str, Any]) -> str:
        done = law.snakemake(overlay, "--cores", "2", "archive")
        assert done.returncode == 0, done.stderr
        return done.stderr

    def would_run(overlay: dict[str, Any]) -> bool:
        done = law.snakemake(overlay, "--dry-run", "archive")
        assert done.returncode == 0, done.stderr
        return "Nothing to be done" not in done.stdout + done.stderr

    file = law.folder / "results" / "tiny" / "tiny.zip"
    before = law.results()
    assert "octsim: warning: archive.date: not given" in archived(TINY)
    with zipfile.ZipFile(file) as zipped:
        kept = {name: zipped.read(name) for name in zipped.namelist()}
    for name, data in before.items():
        assert kept[name.removeprefix("tiny/")] == data
    assert b"octsim run tiny" in kept["report.html"]
    first = file.read_bytes()
    assert not would_run(TINY)
    assert not would_run(merged(TINY, {"cache": {"gigabytes": 1}}))
    about = merged(
        TINY, {"archive": {"creators": [{"name": "Ada Ray"}], "date": date(2026, 1, 31)}}
    )
    assert would_run(about)
    assert "octsim: warning: archive" not in archived(about)
    assert law.results() == before
    assert file.read_bytes() != first
    archived(TINY)
    assert file.read_bytes() == first


def test_the_profile_of_a_cluster_cures_what_the_default_one_does() -> None:
    default, slurm = (
        yaml.safe_load((ROOT / "profiles" / name / "config.yaml").read_text())
        for name in ("default", "slurm")
    )
    assert {key: slurm[key] for key in default if key != "cores"} == {
        key: value for key, value in default.items() if key != "cores"
    }


def test_a_cache_file_s_unset_variable_is_refused_in_a_line(tmp_path: Path) -> None:
    checkout = Checkout(tmp_path)
    done = checkout.snakemake(
        merged(TINY, {"cache": {"file": "$OCTSIM_NOT_SET/points.sqlite"}}), "--until", "focus_scan"
    )
    assert done.returncode != 0
    assert "octsim: cache.file: '$OCTSIM_NOT_SET/points.sqlite' given, but" in done.stderr
    assert "Traceback" not in done.stderr


def as_a_job(folder: Path, file: str, **environment: str) -> str:
    """Do what a cluster's job does on a node of 64 cores; give what it says."""
    command = [
        sys.executable, "-m", "snakemake", "--configfile", "mine.yaml", "--mode", "remote",
        "--cores", "64", "--force", "--no-hooks", "--nolock", f"results/tiny/{file}",
    ]  # fmt: skip
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=False,
        env={**os.environ, "OCTSIM_CORES": "4", **environment},
    )  # fmt: skip
    return done.stdout + done.stderr


def test_a_job_of_a_run_that_another_has_followed_does_nothing(tmp_path: Path) -> None:
    checkout = Checkout(tmp_path)
    checkout.run(TINY, "--until", "focus_scan")
    file = tmp_path / "results" / "tiny" / "focus_scan.nc"
    before = file.stat().st_mtime_ns
    said = as_a_job(tmp_path, file.name, OCTSIM_RUN_ID="of an earlier run")
    assert "octsim: this job's run has ended, and another of its name has begun" in said
    assert file.stat().st_mtime_ns == before
    as_a_job(tmp_path, file.name)
    assert file.stat().st_mtime_ns > before


def test_a_job_has_the_threads_that_its_run_counted(tmp_path: Path) -> None:
    Checkout(tmp_path)
    script = tmp_path / "workflow" / "scripts" / "job.py"
    script.write_text("import pathlib; pathlib.Path('threads').write_text(str(snakemake.threads))")
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump(merged(TINY, GIVEN)))
    as_a_job(tmp_path, "detections.nc")
    assert (tmp_path / "threads").read_text() == "4"


@pytest.fixture(scope="module")
def grid(tmp_path_factory: pytest.TempPathFactory) -> Checkout:
    checkout = Checkout(tmp_path_factory.mktemp("grid"))
    checkout.run(GRID)
    return checkout


def test_a_grid_gives_one_dataset_a_stage_with_its_keys_as_dimensions(grid: Checkout) -> None:
    folder = grid.folder / "results" / "grid"
    dimensions = {}
    for stage in STAGES:
        with xr.open_dataset(folder / f"{stage}.nc") as dataset:
            dimensions[stage] = {d for d in dataset.dims if d in ("gap", "window")}
    assert dimensions.pop("fourier") == dimensions.pop("phase_slope") == {"gap", "window"}
    assert set(map(frozenset, dimensions.values())) == {frozenset({"gap"})}
    figures = sorted(path.name for path in (folder / "figures").iterdir())
    assert figures == [f"{one}.{form}" for one in ("figure_1", "grid") for form in sorted(FORMS)]
    assert sum(counts(grid, "grid")["detections"].values()) == 18  # not once a window


def test_an_edit_of_the_grid_reruns_only_what_has_the_key(grid: Checkout) -> None:
    wider = merged(GRID, {"grid": {"processing.window": ["hann", "hamming", "boxcar"]}})
    assert grid.would_run(wider) == {"phase_slope", "figures"}
    rewritten = merged(
        GRID, {"grid": {"scene.gap": {"start": "0.005 um", "stop": "20 nm", "num": 2}}}
    )
    assert grid.would_run(rewritten) == set()


def test_what_is_found_of_a_grid_lies_where_every_node_sees_it_until_its_run_ends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("OCTSIM_LOOKED", raising=False)
    checkout = Checkout(tmp_path)
    script = tmp_path / "workflow" / "scripts" / "job.py"
    script.write_text(
        "import os, pathlib; found = pathlib.Path(os.environ['OCTSIM_LOOKED']).iterdir()\n"
        "pathlib.Path('found').write_text('\\n'.join(map(str, found)))"
    )
    checkout.snakemake(GRID, "--cores", "1", "results/grid/detections.nc")
    (found,) = map(Path, (tmp_path / "found").read_text().splitlines())
    assert found.parents[1] == tmp_path / ".snakemake"
    assert found.suffix == ".json"
    assert not found.parent.exists()


def test_an_estimate_is_printed_first_and_a_large_run_wants_to_be_confirmed(tmp_path: Path) -> None:
    checkout = Checkout(tmp_path)
    large = merged(GRID, {"sweep": {"diameters": {"num": 1_000_000}}, "tracing": {"rays": 3000}})
    done = checkout.snakemake(large)
    assert done.returncode != 0
    lines = [line for line in done.stderr.splitlines() if line.startswith("octsim: ")]
    assert lines[0].startswith("octsim: 4 combinations, at most 2000064 points to trace")
    assert "of processor time" in lines[0]
    assert lines[1].startswith("octsim: budget.cpu_hours: 1 given, but this run takes about 2.")
    assert not (tmp_path / "results").exists()
    # what is asked for counts, and a dry run takes nothing
    assert checkout.snakemake(large, "--dry-run").returncode == 0
    checkout.run(large, "--until", "focus_law")


def test_points_are_kept_for_other_runs_and_for_going_back(tmp_path: Path) -> None:
    checkout = Checkout(tmp_path)
    start = merged(TINY, GIVEN)
    stages = ("--until", "focus_scan", "focus_sweep", "detections")
    checkout.run(start, *stages)
    shutil.rmtree(tmp_path / "results")
    shutil.rmtree(tmp_path / ".snakemake")
    for overlay, traced in (
        (start, 0),
        (merged(start, {"run": "other", "spectrum": {"wavelength": {"min": "700 nm"}}}), 0),
        (merged(start, {"sweep": {"diameters": {"num": 17}}}), 8),
        (merged(start, {"scene": {"gap": "6 nm"}}), 41),
        (start, 0),
    ):
        checkout.run(overlay, *stages)
        found = counts(checkout, overlay["run"])
        assert sum(one["points_traced"] for one in found.values()) == traced
        assert sum(sum(one.values()) for one in found.values()) == (49 if traced == 8 else 41)


@pytest.mark.trial
def test_no_result_depends_on_the_cache(law: Checkout, tmp_path: Path) -> None:
    checkout = Checkout(tmp_path)
    without = merged(TINY, {"cache": {"gigabytes": 0}})
    checkout.run(without, *DATASETS)
    assert checkout.datasets() == law.datasets()
    assert not (tmp_path / ".octsim").exists()
    assert {one["points_from_cache"] for one in counts(checkout, "tiny").values()} == {0}


@pytest.mark.trial
def test_a_scattered_run_is_the_same_bits_and_goes_on_from_its_shares(
    grid: Checkout, tmp_path: Path
) -> None:
    checkout = Checkout(tmp_path)
    scattered = merged(GRID, {"scatter": {"minutes": 4.6e-5}, "cache": {"gigabytes": 0}})
    assert checkout.would_run(scattered) == EVERYTHING | {"share"}
    share = "results/grid/shares/detections-2-of-2.npz"
    checkout.run(scattered, "--notemp", share)
    made = (tmp_path / share).stat()
    checkout.run(scattered, *DATASETS)
    assert checkout.datasets() == grid.datasets()
    assert counts(checkout, "grid") == counts(grid, "grid")
    assert made.st_mtime < (tmp_path / "results/grid/detections.nc").stat().st_mtime
    said = (tmp_path / "results" / "grid" / "logs" / "shares").glob("detections-*")
    assert sorted(path.name for path in said) == ["detections-1-of-2.log", "detections-2-of-2.log"]
    assert not list((tmp_path / "results" / "grid" / "shares").glob("*"))
    # where a stage is cut decides nothing
    assert checkout.would_run(scattered) == checkout.would_run(GRID) == {"figures"}


@pytest.mark.parametrize("kind", ["foreign", "future"])
def test_a_cache_that_is_none_is_refused_in_a_line_and_stays(kind: str, tmp_path: Path) -> None:
    checkout, folder = Checkout(tmp_path), tmp_path / ".octsim" / "points"
    file = folder / "notes" if kind == "foreign" else folder / "octsim-points.json"
    if kind == "foreign":
        folder.mkdir(parents=True)
        file.write_text("somebody's notes")
    else:
        checkout.run(TINY, "--until", "focus_scan")
        file.write_text(file.read_text().replace('"version": 2', '"version": 99'))
    before = file.read_bytes()
    done = checkout.snakemake(merged(TINY, {"run": "next"}))
    assert done.returncode != 0
    said = [line for line in done.stderr.splitlines() if line.startswith("octsim: ")]
    assert len(said) == 1
    assert ".octsim/points: " in said[0]
    assert "Traceback" not in done.stderr
    assert file.read_bytes() == before
    assert not (tmp_path / "results" / "next").exists()
