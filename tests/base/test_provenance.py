"""What reruns a stage: code that it uses, and nothing that only reads differently."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    shutil.copytree(
        ROOT / "octsim", tmp_path / "octsim", ignore=shutil.ignore_patterns("__pycache__")
    )
    return tmp_path


def run_in(copy: Path, code: str) -> str:
    command = [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(copy)!r})\n{code}"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def digest_in(copy: Path, source: str) -> str:
    return run_in(
        copy,
        "from pathlib import Path\nfrom octsim.base.provenance import source_digest\n"
        f"print(source_digest({source}))",
    )


def edit(file: Path, old: str, new: str) -> None:
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new), encoding="utf-8")


SPECTRA = "Path('workflow/scripts/spectra.py').resolve()"


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        (
            "octsim/optics/interface.py",
            '"""Return a direction turned by the law of',
            '"""Return a ray sent back by the law of',
        ),
        ("octsim/optics/interface.py", "twice = 2 * cos_i", "twice = 2*cos_i  # twice"),
        ("octsim/figures/phase_slope.py", "linewidth=1.0", "linewidth=2.0"),
    ],
    ids=["docstring", "comment and format", "a module that is not used"],
)
def test_what_changes_no_result_changes_no_digest(
    copy: Path, file: str, old: str, new: str
) -> None:
    before = digest_in(copy, "'octsim.schemes.vogel'")
    edit(copy / file, old, new)
    assert digest_in(copy, "'octsim.schemes.vogel'") == before


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("octsim/optics/beam.py", "41475558", "41475559"),
        ("octsim/optics/interface.py", "twice = 2 * cos_i", "twice = 3 * cos_i"),
    ],
)
def test_a_changed_formula_changes_the_digest_of_what_uses_it(
    copy: Path, file: str, old: str, new: str
) -> None:
    users = ("'octsim.schemes.vogel'", "'octsim.schemes.paths.integrate'")
    others = ("'octsim.config.units'", "'octsim.phase.transform'")
    before = {source: digest_in(copy, source) for source in users + others}
    edit(copy / file, old, new)
    after = {source: digest_in(copy, source) for source in users + others}
    assert {source for source in before if before[source] != after[source]} == set(users)


@pytest.mark.parametrize(
    "line",
    [
        "import octsim.room.formula",
        "from octsim.room import formula",
        "from octsim.room.formula import value",
        "from octsim import room\nfrom octsim.room import formula as other",
        "from .room import formula",
        "from .room.formula import value",
        "def late():\n    from octsim.room import formula",
    ],
)
def test_a_digest_follows_packages_and_the_modules_in_them(copy: Path, line: str) -> None:
    (copy / "octsim" / "room").mkdir()
    (copy / "octsim" / "room" / "__init__.py").write_text('"""A room."""\n', encoding="utf-8")
    formula, user = copy / "octsim" / "room" / "formula.py", copy / "octsim" / "user.py"
    formula.write_text("value = 1\n", encoding="utf-8")
    user.write_text(f"{line}\n", encoding="utf-8")
    before = digest_in(copy, "'octsim.user'")
    edit(formula, "1", "2")
    assert digest_in(copy, "'octsim.user'") != before


def test_what_only_a_type_checker_imports_changes_no_digest(copy: Path) -> None:
    user = copy / "octsim" / "user.py"
    user.write_text(
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from octsim.base import files\n",
        encoding="utf-8",
    )
    before = digest_in(copy, "'octsim.user'")
    edit(copy / "octsim" / "base" / "files.py", "SPACE = 32", "SPACE = 33")
    assert digest_in(copy, "'octsim.user'") == before


def test_a_formula_changed_in_another_file_is_compiled_anew(copy: Path) -> None:
    code = (
        "from octsim.config.load import load_config\n"
        "from octsim.instrument.instrument import Instrument\n"
        "config = load_config({'tracing': {'rays': 1, 'max_intersections': 1}})\n"
        "print(Instrument(config).light(1.4, 0.5).amplitude[0])"
    )
    before = float(run_in(copy, code))
    edit(copy / "octsim" / "optics" / "interface.py", "r = math.sqrt(0.5", "r = math.sqrt(2.0")
    assert float(run_in(copy, code)) == pytest.approx(before * 2)
