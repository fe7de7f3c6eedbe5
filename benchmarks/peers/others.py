"""Scripts of peers that need a Python of their own, and marks in the page."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
DEBIAN = Path("/usr/bin/python3")
"""The Python that Debian's packages are for, Meep among them."""


class LeftOutError(RuntimeError):
    """A peer could not be had or did not do it; says why, in one line."""


def environment(name: str) -> Path:
    """Return the Python of one of the environments that `make bench-peers` makes."""
    return ROOT / ".venv-peers" / name / "bin" / "python"


def asked(python: Path, script: str, job: object) -> Any:
    """Run a script beside this one on a job, both as JSON; raise LeftOutError if it fails."""
    if not python.exists():
        raise LeftOutError(f"{python} does not exist")
    known = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    # -P: a peer's own modules must not be taken for those that lie beside the script
    done = subprocess.run(
        [python, "-P", HERE / script],
        input=json.dumps(job),
        capture_output=True,
        text=True,
        env=known,
    )
    # a peer's own messages can stand before it on the line
    _, mark, answer = done.stdout.partition("RESULT ")
    if mark:
        return json.JSONDecoder().raw_decode(answer)[0]
    raise LeftOutError((done.stderr.strip() or "it said nothing").splitlines()[-1])


def table(head: list[str], rows: list[list[str]]) -> str:
    """Return a table of Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
