"""A run on a cluster: jobs that fail in each way are tried again, and the bits are the same.

`make test-slurm` runs these on a private Slurm of one node, and of two where one dies.
"""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import yaml
from checkout import GRID, TINY, Checkout, Finished, counts, merged
from cluster import Cluster, ClusterError, cluster
from made_once import Once

pytestmark = pytest.mark.skipif(
    "OCTSIM_SLURM" not in os.environ, reason="OCTSIM_SLURM is not set; run by `make test-slurm`"
)
# about what a job takes: the next looks at it come ten seconds later each
SOON = ("--cores", "2", "--slurm-init-seconds-before-status-checks", "12")
PROFILE = ("--workflow-profile", "profiles/slurm", *SOON)
_PATIENCE = 600.0  # s, on machines that have other work


@contextmanager
def cluster_or_none(nodes: int) -> Iterator[Cluster]:
    try:
        with cluster(nodes) as started:
            yield started
    except ClusterError as error:
        pytest.skip(f"Slurm can't be started here: {error}")


@pytest.fixture(scope="module")
def slurm() -> Iterator[Mapping[str, str]]:
    with cluster_or_none(1) as started:
        yield started.environment


@pytest.fixture
def two_nodes() -> Iterator[Cluster]:
    with cluster_or_none(2) as started:
        yield started


def the_first_time(name: str, statement: str) -> str:
    return f"[(Path('{name}').touch(), {statement}) for _ in 'x' if not Path('{name}').exists()]"


def start(
    checkout: Checkout,
    slurm: Mapping[str, str],
    *arguments: str,
    overlay: Mapping[str, Any] = TINY,
) -> subprocess.Popen[str]:
    (checkout.folder / "mine.yaml").write_text(yaml.safe_dump(overlay), encoding="utf-8")
    return subprocess.Popen(
        [sys.executable, "-m", "snakemake", "--configfile", "mine.yaml", *arguments],
        cwd=checkout.folder, env=slurm, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip


def run(checkout: Checkout, slurm: Mapping[str, str], *arguments: str) -> str:
    said, _ = (started := start(checkout, slurm, *arguments)).communicate()
    assert started.returncode == 0, said
    return said


def in_full(checkout: Checkout) -> str:
    """Give all that snakemake wrote of the runs in a folder, of which a terminal shows a part."""
    logs = (checkout.folder / ".snakemake" / "log").glob("*.log")
    return "".join(file.read_text(encoding="utf-8") for file in sorted(logs))


def told_of(slurm: Mapping[str, str], job: str, form: str) -> str:
    command = ["squeue", "--states=all", "--noheader", f"--jobs={job}", f"--format={form}"]
    done = subprocess.run(command, env=slurm, capture_output=True, text=True, check=True)
    return done.stdout.strip()


def state_of(slurm: Mapping[str, str], job: str) -> str:
    return told_of(slurm, job, "%T")


def caught(checkout: Checkout, slurm: Mapping[str, str], *files: str) -> str:
    """Give the number of the job that runs alone, once files are made."""
    command = ["squeue", "--noheader", "--states=RUNNING,COMPLETING", "--format=%i"]
    until = time.monotonic() + _PATIENCE
    while time.monotonic() < until:
        done = subprocess.run(command, env=slurm, capture_output=True, text=True, check=True)
        running = done.stdout.split()
        if len(running) == 1 and all((checkout.folder / file).exists() for file in files):
            return running[0]
        time.sleep(0.1)
    raise AssertionError(f"no job ran alone with {', '.join(files)} made")


@pytest.fixture(scope="module")
def local(finished: Finished) -> dict[str, bytes]:
    return finished.checkout.results()


@pytest.fixture(scope="module")
def troubled(slurm: Mapping[str, str], once: Once) -> tuple[Checkout, str]:
    return once.made("troubled", lambda folder: troubled_in(folder, slurm))


def troubled_in(folder: Path, slurm: Mapping[str, str]) -> tuple[Checkout, str]:
    """Give a run in which three jobs end as jobs do on clusters, and what it said."""
    checkout = Checkout(folder)
    # more than it asks for at first, less than it asks for then; Slurm looks once a second
    checkout.at_start("focus_scan", "held = b'x' * 1_500_000_000; time.sleep(3); del held")
    checkout.at_start("focus_sweep", the_first_time("failed", "1 / 0"))
    checkout.at_start("detections", the_first_time("waits", "time.sleep(300)"))
    started = start(checkout, slurm, *PROFILE, "--until", "focus_scan", "detections")
    subprocess.run(["scancel", caught(checkout, slurm, "waits")], env=slurm, check=True)
    said, _ = started.communicate()
    assert started.returncode == 0, said
    return checkout, in_full(checkout)


def slurm_logs(checkout: Checkout, stage: str) -> list[str]:
    """Give what Slurm kept of a stage's jobs: of those that failed."""
    logs = checkout.folder / ".snakemake" / "slurm_logs" / f"rule_{stage}"
    return [file.read_text() for file in sorted(logs.rglob("*.log"))]


def test_a_run_on_slurm_has_the_bits_of_a_local_one(
    troubled: tuple[Checkout, str], local: dict[str, bytes]
) -> None:
    made = troubled[0].results()
    assert "tiny/detections.nc" in made
    assert made == {name: local[name] for name in made}


@pytest.mark.parametrize(
    ("stage", "said", "state"),
    [
        ("focus_sweep", "ZeroDivisionError", "FAILED"),
        ("focus_scan", "exceeded memory limit", "FAILED"),
        ("detections", "CANCELLED", "CANCELLED"),
    ],
)
def test_a_job_that_fails_or_lacks_memory_or_is_cancelled_is_tried_again(
    stage: str, said: str, state: str, troubled: tuple[Checkout, str]
) -> None:
    checkout, told = troubled
    (log,) = slurm_logs(checkout, stage)
    assert said in log
    assert told.count(f"/rule_{stage}/") >= 2  # submitted twice
    assert f"SLURM status is: '{state}'" in told
    assert told.count("Trying to restart job") == 3


@pytest.mark.trial
def test_a_job_that_fails_each_time_keeps_the_old_dataset_and_a_rerun_resumes(
    slurm: Mapping[str, str], local: dict[str, bytes], tmp_path: Path
) -> None:
    checkout = Checkout(tmp_path)
    checkout.run(TINY, "--until", "focus_law")
    before = checkout.results()
    script = tmp_path / "workflow" / "scripts" / "job.py"
    plain = script.read_text()
    checkout.at_start("focus_law", "raise SystemExit(1)")
    again = ("--until", "focus_law", "--forcerun", "focus_law", "--restart-times", "0")
    broken = start(checkout, slurm, *PROFILE, *again)
    broken.communicate()
    assert broken.returncode != 0
    assert "SLURM status is: 'FAILED'" in in_full(checkout)
    assert checkout.results() == before
    script.write_text(plain)
    assert "focus_law" in checkout.would_run(TINY)  # what failed does not count as done
    checkout.run(TINY, "--until", "focus_law")
    assert checkout.results() == {name: local[name] for name in before}


@pytest.mark.trial
def test_a_scattered_stage_is_gathered_to_the_bits_of_one_job_whatever_becomes_of_a_share(
    slurm: Mapping[str, str], tmp_path: Path
) -> None:
    target = "results/grid/detections.nc"
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
    here, there = Checkout(tmp_path / "here"), Checkout(tmp_path / "there")
    alone = merged(GRID, {"cache": {"gigabytes": 0}})  # what is stopped is to be traced again
    here.run(alone, "--cores", "2", target)
    second = "snakemake.wildcards.get('number') == '2' and not Path('waits').exists()"
    there.at_start(
        "detections",
        f"[(Path('waits').touch(), time.sleep(300)) for _ in 'x' if {second}]",
    )  # fmt: skip
    scattered = merged(alone, {"scatter": {"minutes": 4.6e-5}})
    started = start(there, slurm, *PROFILE, target, overlay=scattered)
    waiting = caught(there, slurm, "waits", "results/grid/shares/detections-1-of-2.npz")
    subprocess.run(["scancel", waiting], env=slurm, check=True)
    said, _ = started.communicate()
    assert started.returncode == 0, said
    assert (
        in_full(there).count("has been submitted with SLURM jobid") == 4
    )  # one share of two again
    assert there.results() == here.results()
    assert counts(there, "grid") == counts(here, "grid")


@pytest.mark.trial
def test_a_killed_run_s_job_ends_with_the_next_run_which_has_the_same_bits(
    slurm: Mapping[str, str], local: dict[str, bytes], tmp_path: Path
) -> None:
    checkout = Checkout(tmp_path)
    checkout.at_start("focus_scan", the_first_time("waits", "time.sleep(300)"))
    arguments = ("--profile", "profiles/slurm", *SOON, "--until", "focus_scan")
    killed = start(checkout, slurm, *arguments)
    orphan = caught(checkout, slurm, "waits")
    killed.send_signal(signal.SIGKILL)
    killed.communicate()
    assert state_of(slurm, orphan) == "RUNNING"
    run(checkout, slurm, *arguments)
    assert state_of(slurm, orphan) == "FAILED"
    assert checkout.results() == {"tiny/focus_scan.nc": local["tiny/focus_scan.nc"]}


def on_a_node_that_dies(
    cluster: Cluster, checkout: Checkout, stage: str, *arguments: str, **environment: str
) -> str:
    """Kill the node that a stage's job is on; give what else the run that goes on wrote."""
    checkout.at_start(stage, the_first_time("waits", "time.sleep(600)"))
    slurm = {**cluster.environment, **environment}
    started = start(checkout, slurm, *PROFILE, *arguments)
    job = caught(checkout, slurm, "waits")
    dead = told_of(slurm, job, "%N")
    cluster.kill(dead)
    said, _ = started.communicate()
    assert started.returncode == 0, said
    nodes = subprocess.run(
        ["sinfo", "--Node", "--noheader", "--format=%N %T"],
        env=slurm, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert f"{dead} down*" in nodes.stdout.splitlines()  # noticed by Slurm; the others went on
    return in_full(checkout)


@pytest.mark.trial
def test_a_run_whose_node_dies_goes_on_on_the_other_to_the_same_bits(
    two_nodes: Cluster, local: dict[str, bytes], tmp_path: Path
) -> None:
    checkout = Checkout(tmp_path)
    told = on_a_node_that_dies(two_nodes, checkout, "detections")
    assert checkout.results() == local
    assert "SLURM status is: 'NODE_FAIL'" in told
    assert told.count("Trying to restart job") == 1


@pytest.mark.trial
def test_a_job_that_slurm_itself_queues_again_when_its_node_dies_is_waited_for(
    two_nodes: Cluster, local: dict[str, bytes], tmp_path: Path
) -> None:
    checkout = Checkout(tmp_path)
    told = on_a_node_that_dies(
        two_nodes, checkout, "focus_sweep", "--until", "focus_law",
        SBATCH_REQUEUE="1",  # as most clusters have it: JobRequeue, which the private one has not
    )  # fmt: skip
    made = checkout.results()
    assert "tiny/focus_law.nc" in made
    assert made == {name: local[name] for name in made}
    assert "Trying to restart job" not in told
    assert told.count("has been submitted with SLURM jobid") == 2
