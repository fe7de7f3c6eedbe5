"""Where the package is, and the workflow: in the checkout, or in the package, which carries it."""

from pathlib import Path

PACKAGE = Path(__file__).parents[1]
"""Folder of the package."""
CARRIED = PACKAGE / "carried"
"""What a wheel has of a checkout: the Snakefile, its scripts, profiles and the thesis's config."""


def workflow_folder() -> Path:
    """Return the folder with the Snakefile: the checkout that the package stands in, if in one."""
    checkout = PACKAGE.parent
    is_one = (checkout / "Snakefile").is_file() and (checkout / "pyproject.toml").is_file()
    return checkout if is_one else CARRIED
