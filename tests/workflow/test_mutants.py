"""Mutation testing finds what no test notices, in a copy, and leaves the checkout alone."""

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest
from marked import marks, write_part
from mutants.changes import changes
from mutants.page import lines
from mutants.tests_of import OwnTests

ROOT = Path(__file__).parents[2]
MODULE = '''"""A docstring with 1."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

FIRST = 2.0


def half(value: "Sequence[float]", least: float = 0) -> "list[float]":
    """Return halves."""
    if not value:
        raise ValueError(f"no {1 + 1} values")
    return [one / FIRST for one in value if one > least and one < 9]


def nothing() -> None:
    return None
'''
TESTS = """
from octsim.optics.part import half

def test_half():
    assert half([4.0]) == [2.0]

def test_that_fails_without_any_change():
    assert False
"""
TRY = """
import json, sys
from pathlib import Path
from mutants.changes import changes
from mutants.trials import Trial, load, run
load(compiled=False)
root, found = Path(sys.argv[1]), {}
files, without = ("tests/optics/test_part.py",), ("tests/optics/test_part.py::" + sys.argv[2],)
def ended(trial, how):
    found[f"{trial.change.was} -> {trial.change.now}"] = how.failed or how.slow
every = [Trial(one, files, without) for one in changes(root, "octsim/optics/part.py")]
run(root, every, 5.0, 2, ended)
print(json.dumps(found))
"""

SLOW = """
import pytest

@pytest.mark.parametrize("case", range(4))
def test_slow(case):
    with open({ran!r}, "a") as file:
        file.write(str(case))
    while True:
        pass

def test_quick():
    assert True

def test_fails():
    assert False
"""
TIME = """
import json, sys
from pathlib import Path
from mutants.trials import Trial, load, run
load(compiled=False)
def ended(trial, how):
    print(json.dumps(how.seconds))
run(Path(sys.argv[1]), [Trial(None, ("tests/optics/test_part.py",))], 0.3, 1, ended)
"""


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    for name, text in {
        "octsim/__init__.py": "", "octsim/optics/__init__.py": "", "octsim/optics/part.py": MODULE,
        "octsim/optics/user.py": "from octsim.optics.part import half\n",
        "octsim/optics/farther.py": 'NAMES = ["octsim.optics.user"]\n',
        "octsim/optics/alone.py": "",
        "tests/optics/test_part.py": TESTS, "tests/optics/test_alone.py": "",
        "tests/config/test_farther.py": "import octsim.optics.farther\n",
        "tests/studies/test_whole.py": "from octsim.optics import part\n",
    }.items():  # fmt: skip
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def test_changes_are_of_what_computes_and_of_nothing_else(checkout: Path) -> None:
    found = changes(checkout, "octsim/optics/part.py")
    assert [(one.was, one.now) for one in found] == [
        ("2.0", "3.0"),
        ("0", "1"),
        ("not value", "not not value"),
        ("not value", "value"),
        ("[one / FIRST for one in value if one > least and one < 9]", "None"),
        ("one / FIRST", "one * FIRST"),
        ("one > least", "one <= least"),
        ("one > least", "one >= least"),
        ("one > least and one < 9", "one > least or one < 9"),
        ("one < 9", "one <= 9"),
        ("one < 9", "one >= 9"),
        ("9", "10"),
    ]
    assert len({one.name for one in found}) == len(found)


def test_a_change_leaves_the_rest_of_a_file_as_it_was(checkout: Path) -> None:
    source = MODULE.replace("half", "hälfte").encode()
    (checkout / "octsim/optics/part.py").write_bytes(source)
    for one in changes(checkout, "octsim/optics/part.py"):
        made = one.made(source)
        compile(made, "part.py", "exec")
        assert made.startswith(source[: one.begin])
        assert made.endswith(source[one.end :])
        assert made != source


def test_changes_that_read_the_same_are_told_apart(checkout: Path) -> None:
    twice = "def two(x: int) -> bool:\n    return x + 1 < 1\n"
    (checkout / "octsim/optics/part.py").write_text(twice + twice)
    found = changes(checkout, "octsim/optics/part.py")
    assert sum((one.was, one.now) == ("1", "2") for one in found) == 4
    assert len({one.name for one in found}) == len(found)


def test_tests_of_a_module_have_its_name_or_import_it_or_what_imports_it(checkout: Path) -> None:
    tests = OwnTests(checkout)
    near, far = "tests/optics/test_part.py", "tests/config/test_farther.py"
    assert tests.files("octsim/optics/part.py") == [near, far]
    assert tests.files("octsim/optics/alone.py") == ["tests/optics/test_alone.py"]
    assert tests.files("octsim/optics/user.py") == ["tests/config/test_farther.py"]


def test_a_trial_tells_what_is_noticed_and_leaves_the_checkout_alone(checkout: Path) -> None:
    def whole() -> dict[Path, bytes]:
        return {path: path.read_bytes() for path in checkout.rglob("*") if path.is_file()}

    before = whole()
    failing = "test_that_fails_without_any_change"
    done = subprocess.run(
        [sys.executable, "-c", TRY, str(checkout), failing], check=True, capture_output=True,
        text=True, env={"PYTHONPATH": str(ROOT / "benchmarks"), "PATH": ""},
    )  # fmt: skip
    found = json.loads(done.stdout)
    assert {change for change, by in found.items() if not by} == {
        "0 -> 1", "9 -> 10", "one > least -> one >= least", "one < 9 -> one <= 9",
        "one > least and one < 9 -> one > least or one < 9",
    }  # fmt: skip
    assert set(found.values()) == {"", "tests/optics/test_part.py::test_half"}
    assert whole() == before


def test_without_a_change_tests_are_timed_and_of_one_that_is_slow_two_cases_are_run(
    checkout: Path,
) -> None:
    ran = checkout / "ran.txt"
    (checkout / "tests/optics/test_part.py").write_text(SLOW.format(ran=str(ran)))
    done = subprocess.run(
        [sys.executable, "-c", TIME, str(checkout)], check=True, capture_output=True,
        text=True, env={"PYTHONPATH": str(ROOT / "benchmarks"), "PATH": ""},
    )  # fmt: skip
    taken = {name.partition("::")[2]: took for name, took in json.loads(done.stdout).items()}
    assert taken.pop("test_quick") < 0.3
    assert taken == {
        **{f"test_slow[{case}]": math.inf for case in range(4)}, "test_fails": math.inf,
    }  # fmt: skip
    assert ran.read_text() == "01"


def test_the_page_counts_what_is_noticed_and_lists_the_rest(checkout: Path) -> None:
    drawn = changes(checkout, "octsim/optics/part.py")[:4]
    noticed = {one.name: "a test" for one in drawn} | {drawn[3].name: ""}
    page = checkout / "page.md"
    begin, end = marks("mutants")
    page.write_text(f"Head.\n\n{begin}\nold\n{end}\n\nFoot.\n")
    told = lines({"all of it": ["octsim/*"]}, drawn, noticed, "seed", (3, 60))
    write_part(page, "mutants", told)
    text = page.read_text()
    assert text.startswith("Head.")
    assert text.endswith("Foot.\n")
    assert "old" not in text
    assert "| all of it | 4 | 3 | 0 | 1 | 75% |" in text
    assert "- `octsim/optics/part.py`, line 12: `not value` to `value`: not looked into" in text
