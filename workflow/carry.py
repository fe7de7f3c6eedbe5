"""Puts the workflow into a wheel; one that is installed in place has it from the checkout."""

from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

CARRIED = ("Snakefile", "workflow/scripts/job.py", "profiles", "config/default.yaml")


class Carry(BuildHookInterface):
    """Adds files of the checkout to the package, as `octsim.base.carried` looks for them."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Name the files."""
        if version != "editable":
            build_data["force_include"] |= {file: f"octsim/carried/{file}" for file in CARRIED}
