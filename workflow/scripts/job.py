"""Every job of the workflow: told as plain data to the process with the libraries, or done here."""

import sys
from pathlib import Path

# a script of the user's that is called octsim.py too, on PYTHONPATH, is not the package
for place in sys.path[:]:
    if Path(place, "octsim.py").is_file() and not Path(place, "octsim").is_dir():
        sys.path.remove(place)
from octsim.base.surroundings import settle  # noqa: E402
from octsim.cli.job_server import ask  # noqa: E402

settle()

# not the rule's name, which is another where this workflow is a module of one of the user's
named, log = snakemake.wildcards, Path(snakemake.log[0])
files = {name: file for name, file in snakemake.output.items() if isinstance(file, str)}
task = {
    "name": named.get("stage", log.stem),
    "folder": str(next(above for above in log.parents if above.name == "logs").parent),
    "config": snakemake.config,
    "input": {name: file for name, file in snakemake.input.items() if isinstance(file, str)},
    "output": files or {"only": snakemake.output[0]},
    "shares": list(snakemake.input.get("shares", [])),
    "log": str(log),
    "threads": snakemake.threads,
    "share": [int(named.get(name, 1)) for name in ("number", "of")],
    "figures": bool(snakemake.output.get("figures")),
}
status = ask(task)
if status is None:
    from octsim.cli.job import Task, do

    status = do(Task(**task))
sys.exit(status)
