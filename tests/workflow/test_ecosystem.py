"""Files for other tools say what pyproject.toml and the locks say."""

import re
import subprocess
import sys
import tomllib
from datetime import date
from pathlib import Path

import yaml
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
APPTAINER = (ROOT / "apptainer.def").read_text(encoding="utf-8")
ENVIRONMENT = yaml.safe_load((ROOT / "environment.yml").read_text(encoding="utf-8"))


def pinned(lock: str) -> dict[str, set[str]]:
    """Versions that a lock holds, by name."""
    found: dict[str, set[str]] = {}
    lines = (ROOT / lock).read_text(encoding="utf-8")
    for name, version in re.findall(r"^([a-z0-9._-]+)==([^ ;]+)", lines, flags=re.MULTILINE):
        found.setdefault(name, set()).add(version)
    return found


def test_the_version_is_one_wherever_it_stands() -> None:
    assert CITATION["version"] == PROJECT["version"]
    assert f"image.version {PROJECT['version']}\n" in APPTAINER


def test_the_citation_has_a_date_and_authors_of_the_project() -> None:
    assert isinstance(CITATION["date-released"], date)
    assert [one["name"] for one in CITATION["authors"] if "name" in one] == [
        one["name"] for one in PROJECT["authors"]
    ]
    assert CITATION["license"] == PROJECT["license"]


def test_every_file_has_a_licence_whose_text_is_there() -> None:
    reuse = tomllib.loads((ROOT / "REUSE.toml").read_text(encoding="utf-8"))
    (every,) = reuse["annotations"]
    assert every["path"] == "**"
    assert every["SPDX-License-Identifier"] == PROJECT["license"]
    text = (ROOT / "LICENSES" / f"{PROJECT['license']}.txt").read_text(encoding="utf-8")
    assert text == (ROOT / "LICENSE").read_text(encoding="utf-8")


def test_the_lock_holds_what_the_project_needs_at_versions_that_it_allows() -> None:
    versions = pinned("requirements.lock")
    needs = [*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["run"]]
    for requirement in map(Requirement, needs):
        found = versions[requirement.name.lower()]
        assert all(version in requirement.specifier for version in found), requirement


def test_a_conda_environment_is_the_lock_for_the_projects_python() -> None:
    python, pip, packages = ENVIRONMENT["dependencies"]
    assert SpecifierSet(python.removeprefix("python ")) == SpecifierSet(PROJECT["requires-python"])
    assert (pip, packages) == ("pip", {"pip": ["--requirement requirements.lock"]})


def test_an_image_has_the_lock_for_the_projects_python_and_files_that_are_there() -> None:
    (version,) = re.findall(r"^From: python:([\d.]+)", APPTAINER, flags=re.MULTILINE)
    assert f"{version}.0" in SpecifierSet(PROJECT["requires-python"])
    assert "--require-hashes -r requirements.lock" in APPTAINER
    copied = APPTAINER.split("%files")[1].split("%post")[0].split()
    names = set(copied[::2])
    assert {"octsim", "Snakefile", "workflow", "requirements.lock", "pyproject.toml"} <= names
    assert all((ROOT / name).exists() for name in names)
    assert copied[1::2] == [f"/opt/octsim/{name}" for name in copied[::2]]


def test_snakemakes_own_check_of_the_workflow_finds_nothing(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile"), "--lint"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Lints for" not in done.stdout + done.stderr
