"""What a run says of itself: which edit it follows, and what it has come to."""

from collections.abc import Collection, Iterable, Sequence
from pathlib import Path

from octsim.base.errors import OctsimError
from octsim.config.derive import overlap
from octsim.config.models import Config
from octsim.datasets.catalog import jobs
from octsim.datasets.keys import differing, jobs_of

_MOST = 4
"""Keys that are told of one by one."""


def edit_of(folder: Path, config: Config, planned: Collection[str]) -> str | None:
    """Return in a line which keys have been edited, and which jobs are done anew for that.

    Parameters
    ----------
    folder : path
        Of the run.
    config : Config
        The run's.
    planned : collection of str
        Jobs that are to be done.

    Returns
    -------
    str, optional
        None if nothing that is there is made anew.
    """
    from octsim.archive.compare_origins import config_changes
    from octsim.archive.run_folder import stage_and_config

    rows = {**jobs_of(config), **jobs(beside=True)}
    every = (*rows, "figures", "animation", "report", "archive")
    remade = [name for name in every if name in planned]
    changes: dict[str, str] = {}
    there = False
    for row in (row for name in remade for row in rows.get(name, ())):
        if not (file := folder / f"{row.name}.nc").is_file():
            continue
        try:
            recorded = stage_and_config(file)[1]
        except OctsimError:  # whoever reads it says so
            continue
        there = True
        keys = [
            key.removeprefix("grid.") for key in differing(row.name, config, recorded.to_dict())
        ]
        for change in config_changes(recorded, config) if keys else ():
            if any(overlap(change.what.removeprefix("grid."), key) for key in keys):
                changes[change.what] = f"{change.what}: {change.first} → {change.second}"
    if not changes:
        of_what = f"octsim: remaking {', '.join(remade)}, as octsim or a file has changed"
        return of_what if there else None
    more = [f"{len(changes) - _MOST} more keys"] if len(changes) > _MOST else []
    told = ", ".join([*list(changes.values())[:_MOST], *more])
    return f"octsim: {told}; remaking {', '.join(remade)}"


def result_of(
    folder: Path, config: Config, asked: Collection[str], remarks: Iterable[str] = ()
) -> list[str]:
    """Return what a run has come to, a line each: warnings, where it is, and at last its results.

    Parameters
    ----------
    folder : path
        Of the run.
    config : Config
        The run's.
    asked : collection of str
        Jobs that it consists of, done now or before.
    remarks : iterable of str
        Warnings of the config.
    """
    every = (*jobs_of(config), *jobs(beside=True), "report", "archive")
    lines = [line for name in every if name in asked for line in _logged(folder, name)]
    warnings = [line for line in lines if line.startswith("octsim: warning: ")]
    return [
        *(f"octsim: warning: {remark}" for remark in remarks),
        *warnings,
        f"octsim: datasets and figures are in {folder}/",
        *(line for line in lines if line not in warnings),
    ]


def _logged(folder: Path, name: str) -> Sequence[str]:
    file = folder / "logs" / f"{name}.log"
    # there is none of what has never been made
    lines = file.read_text("utf-8").splitlines() if file.is_file() else []
    return [line for line in lines if line.startswith("octsim: ")]
