"""The config's sections on what a run takes: no result depends on them."""

from typing import Annotated

from pydantic import Field

from octsim.config.fields import Number, PositiveNumber, Section
from octsim.config.fields import key as _key


class Cache(Section):
    """Where traced points are kept; no result depends on it."""

    file: Annotated[str, Field(min_length=1)] = _key(
        ".octsim/points", "folder for them, beside the run's results or one that several share"
    )
    gigabytes: Annotated[Number, Field(ge=0, le=1e6)] = _key(
        4.0, "its largest size; 0 keeps and reads nothing"
    )


class Budget(Section):
    """What a run may take by its estimate; raise it to confirm a larger one."""

    cpu_hours: PositiveNumber = _key(1.0, "processor time")
    disk_gigabytes: PositiveNumber = _key(20.0, "datasets of the run")


class Scatter(Section):
    """How a stage that takes long is scattered over several jobs; no result depends on it."""

    minutes: PositiveNumber = _key(5.0, "of processor time in a job, by the run's estimate")
