"""What it takes to add a scheme, or a dataset: a row of a table, and a module."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr
import yaml
from checkout import GIVEN, ROOT, TINY, merged

SCHEME = '''"""The light of the axial ray alone."""

from octsim.optics.beam import vogel_beam
from octsim.schemes.field_sum import field_of_rays
from octsim.schemes.light import AccuracyStatus, Light
from octsim.tracing.tree import trace


def tracer(optics, options):
    beam = vogel_beam(1, optics.detector.objective_radius, optics.detector.focus_distance)

    def light_at(scene, focus):
        found = trace(scene, beam, optics.detector, focus, optics.max_intersections)
        return Light(
            found.path, found.amplitude, found.amplitude, found.optical_path_length, 0.0,
            found.segments, AccuracyStatus.NOT_CONTROLLED,
        )

    return light_at


def field(light, wavenumber, optics, options):
    return field_of_rays(
        light.amplitude, light.rough_amplitude, light.optical_path_length, wavenumber
    )
'''

SCHEME_ROW = """
AXIAL_RAY = Scheme(
    name="axial", module="octsim.schemes.axial", options=("rays",), effort="rays", cost=of_rays
)
SCHEMES = {**SCHEMES, AXIAL_RAY.name: AXIAL_RAY}
"""
STAGE = '''"""The brightest wavenumber of each spectrum."""

from octsim.datasets.layout import Layout
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part, Stream, Streamed


@Streamed
def brightest(config, spectra):
    def own(config):
        return {"diameter": ("diameter", config.sweep.diameters.values())}

    layout = Layout("brightest", config, "Brightest wavenumbers", own, "diameter")
    stored = Stored(spectra, "spectra", config, layout)

    def part(at):
        one = stored.part(at)
        place = one["intensity"].argmax("wavenumber").values
        found = ("diameter", one["wavenumber"].values[place])
        return Part(at, 0, layout.count(at), {"brightest_wavenumber": found})

    return Stream(layout, (part(at) for at in layout.combinations))
'''
STAGE_ROW = """    Stage(
        "brightest", "octsim.stages.brightest:brightest", "Find the brightest wavenumbers",
        after=("spectra",),
    ),
)  # fmt: skip

_BESIDE = ("""


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """Copy what a checkout consists of."""
    skipped = shutil.ignore_patterns("__pycache__")
    for part in ("octsim", "workflow", "profiles"):
        shutil.copytree(ROOT / part, tmp_path / part, ignore=skipped)
    shutil.copy(ROOT / "Snakefile", tmp_path)
    return tmp_path


def run(checkout: Path, overlay: dict[str, object], compiled: Path, *targets: str) -> None:
    file = checkout / "mine.yaml"
    file.write_text(yaml.safe_dump(overlay), encoding="utf-8")
    snakemake = [sys.executable, "-m", "snakemake", *targets, "--cores", "2"]
    command = [*snakemake, "--configfile", str(file)]
    environment = os.environ | {"PYTHONPATH": str(checkout), "NUMBA_CACHE_DIR": str(compiled)}
    done = subprocess.run(
        command, cwd=checkout, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_scheme_is_a_row_and_a_module(checkout: Path, compiled: Path) -> None:
    (checkout / "octsim" / "schemes" / "axial.py").write_text(SCHEME, encoding="utf-8")
    table = checkout / "octsim" / "schemes" / "table.py"
    table.write_text(table.read_text(encoding="utf-8") + SCHEME_ROW, encoding="utf-8")
    overlay = merged(TINY, GIVEN, {"tracing": {"scheme": "axial"}})
    run(checkout, overlay, compiled, "results/tiny/spectra.nc")
    with xr.open_dataset(checkout / "results" / "tiny" / "spectra.nc") as spectra:
        # off the glass |r|², and from both sides of the neuron
        assert 0.001 < float(spectra["intensity"].mean()) < 0.02


def test_a_stage_is_a_row_a_module_and_what_its_variables_mean(
    checkout: Path, compiled: Path
) -> None:
    (checkout / "octsim" / "stages" / "brightest.py").write_text(STAGE, encoding="utf-8")
    catalog = checkout / "octsim" / "datasets" / "catalog.py"
    text = catalog.read_text(encoding="utf-8")
    assert text.count(")  # fmt: skip\n\n_BESIDE = (") == 1
    catalog.write_text(text.replace(")  # fmt: skip\n\n_BESIDE = (", STAGE_ROW), encoding="utf-8")
    variables = checkout / "octsim" / "datasets" / "variables.py"
    text = variables.read_text(encoding="utf-8")
    meaning = '"brightest_wavenumber": ("um-1", "wavenumber of the largest intensity"),'
    variables.write_text(
        text.replace('"centre": (', f'{meaning}\n    "centre": ('), encoding="utf-8"
    )
    run(checkout, merged(TINY, GIVEN), compiled, "results/tiny/brightest.nc")
    folder = checkout / "results" / "tiny"
    with (
        xr.open_dataset(folder / "brightest.nc") as found,
        xr.open_dataset(folder / "spectra.nc") as spectra,
    ):
        expected = spectra["intensity"].idxmax("wavenumber")
        assert found["brightest_wavenumber"].values.tolist() == expected.values.tolist()
        assert found["brightest_wavenumber"].attrs["units"] == "um-1"


def test_the_workflow_serves_as_a_module_of_another(checkout: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    (other / "Snakefile").write_text(
        f"""
module octsim:
    snakefile: "{checkout}/workflow/Snakefile"
    config: config


use rule * from octsim as octsim_*


rule mine:
    default_target: True
    input: "results/tiny/focus_law.nc"
    output: "law.txt"
    shell: "ls {{input}} > {{output}}"
""",
        encoding="utf-8",
    )
    file = other / "mine.yaml"
    file.write_text(yaml.safe_dump(TINY), encoding="utf-8")
    command = [sys.executable, "-m", "snakemake", "--cores", "2", "--configfile", str(file)]
    done = subprocess.run(command, cwd=other, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (other / "law.txt").read_text(encoding="utf-8") == "results/tiny/focus_law.nc\n"
