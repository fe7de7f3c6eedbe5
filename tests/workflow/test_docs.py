"""What the docs say works as it is written."""

import re
from pathlib import Path

import matplotlib as mpl
import pytest
import yaml

from octsim.config.load import load_config

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def test_the_python_example_runs(capsys: pytest.CaptureFixture[str]) -> None:
    mpl.use("Agg")
    (example,) = blocks("python")
    exec(example, {})
    law_slope, phase_slope, unit = capsys.readouterr().out.split()
    assert float(law_slope) == pytest.approx(0.58, abs=0.02)
    assert float(phase_slope) == pytest.approx(23.14, rel=0.01)
    assert unit == "mrad/nm"


def test_the_example_configs_are_valid() -> None:
    runs = [load_config(yaml.safe_load(example)).run for example in blocks("yaml")]
    assert runs == ["thick", "sweep"]


def test_the_example_of_a_grid_is_the_file_that_the_docs_show() -> None:
    text = (ROOT / "docs" / "sweeps.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"```yaml\n(.*?)```", text, flags=re.DOTALL)
    assert load_config(yaml.safe_load(shown)) == load_config(ROOT / "config" / "gaps.yaml")


def test_every_dependency_is_justified() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    runtime = text.split("dependencies = [")[1].split("]")[0]
    for name in re.findall(r'"([A-Za-z0-9-]+)', runtime):
        assert re.search(rf"^\|.*\b{name}\b.*\|", README, flags=re.MULTILINE), name


def test_every_file_that_is_linked_is_there() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
