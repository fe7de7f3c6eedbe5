"""Each bad config of the tests through each entrance of its own process: lines, status, seconds.

Run from the checkout, on a machine that has nothing else to do:

    PYTHONPATH=tests .venv/bin/python benchmarks/bad_inputs.py
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

from bad_configs import BAD, Bad

ROOT = Path(__file__).resolve().parents[1]
BIN = Path(sys.executable).parent
ENTRANCES: dict[str, list[str]] = {
    "octsim check": [str(BIN / "octsim"), "check", "{file}"],
    "octsim run": [str(BIN / "octsim"), "run", "{file}"],
    "make results": ["make", "-s", "-o", ".venv/run", "results", "CONFIG={file}"],
    "Python": [
        sys.executable, "-P", "-c",
        "import sys, octsim\n"
        "try:\n    octsim.load_config(sys.argv[1])\n"
        "except octsim.ConfigError as error:\n"
        "    print(*(f'octsim: {line}' for line in str(error).splitlines()), sep='\\n')\n"
        "    sys.exit(2)",
        "{file}",
    ],
}  # fmt: skip
"""What a config is given to."""
FROM_MAKE = "make: ***"
"""What make adds of its own."""


def wrong_with(bad: Bad, lines: list[str], status: int) -> str:
    """Say what of an answer is not as it should be; nothing where all is."""
    told = [line for line in lines if not line.startswith(FROM_MAKE)]
    if status != 2:
        return f"status {status}"
    if not any(bad.says in line for line in told):
        return f"it does not say {bad.says!r} but {told[:2]}"
    if len(told) != bad.lines or not all(line.startswith("octsim: ") for line in told):
        return f"{len(told)} lines"
    return ""


def main() -> int:
    """Print, for each entrance, how many are answered as they should be, and how fast."""
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "bad.yaml"
        for entrance, command in ENTRANCES.items():
            seconds = []
            for bad in BAD:
                file.write_bytes(bad.content)
                begin = time.perf_counter()
                done = subprocess.run(
                    [part.replace("{file}", str(file)) for part in command],
                    cwd=ROOT, capture_output=True, text=True, check=False,
                )  # fmt: skip
                seconds.append((time.perf_counter() - begin, bad.name))
                lines = (done.stdout + done.stderr).splitlines()
                if wrong := wrong_with(bad, lines, done.returncode):
                    failed += 1
                    print(f"{entrance}: {bad.name}: {wrong}")
            seconds.sort()
            print(
                f"{entrance}: {len(BAD)} bad configs, median {seconds[len(seconds) // 2][0]:.2f} s,"
                f" longest {seconds[-1][0]:.2f} s ({seconds[-1][1]})"
            )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
