"""What a dataset's file looks like, by number: files of an older octsim are read or refused."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr
from pydantic import ValidationError

from octsim.base.errors import DatasetError, one_line
from octsim.config.derive import merge
from octsim.config.messages import explain
from octsim.config.models import Config

SCHEMA = 2
"""Of the files that this octsim writes; those of 0.2.0 have 1, those of 0.1.0 none, as 0 counts."""
_GREW: Mapping[str, tuple[str, ...]] = {
    # while files had no number; early ones lack what later stages read
    "focus_scan": ("intensity_error", "accuracy_status"),
    "focus_sweep": ("intensity_error", "accuracy_status"),
    "focus_law": ("status",),
    "detections": ("path_code", "rough_amplitude", "missing_field", "accuracy_status"),
    "spectra": ("intensity_error", "accuracy_status"),
}
_RENAMED: Mapping[str, Mapping[str, str]] = {
    # up to schema 1 it had the name of a dimension, which broke selection by label
    "phase_slope": {"component": "strongest_component"},
}


_CALIBRATED = {"calibration": {"scheme": "paths"}}
_THEN: Mapping[str, Mapping[str, Any]] = dict.fromkeys(
    ("calibration", "expansion", "action_potential"), _CALIBRATED
)
"""What was done for a dataset before there was a key for it, where that is not the default."""


def recorded_config(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the config that a dataset's attributes hold, as plain data, with every key of today.

    Keys that the config had no name for yet do what was done then: most are at their defaults.

    Raises
    ------
    ValueError
        If there is none, or one that this octsim has no meaning for.
    """
    try:
        recorded, then = (
            json.loads(attributes["config"]),
            _THEN.get(str(attributes.get("stage")), {}),
        )
        return Config.model_validate(merge(merge(Config().to_dict(), then), recorded)).to_dict()
    except ValidationError as error:
        raise ValueError(f"its config: {explain(error.errors()[0])}") from None
    except (KeyError, TypeError, AttributeError, ValueError, RecursionError):
        raise ValueError("it has no config") from None


def recorded_environment(attributes: Mapping[str, Any]) -> dict[str, str] | None:
    """Return the versions that a dataset says it was computed with; None without any."""
    try:
        found = json.loads(attributes["environment"])
    except (KeyError, TypeError, ValueError, RecursionError):
        return None
    if not isinstance(found, dict):
        return None
    return {one_line(name): one_line(version) for name, version in found.items()}


def upgraded(dataset: xr.Dataset, path: Path) -> xr.Dataset:
    """Return an octsim dataset as this octsim writes it.

    Parameters
    ----------
    dataset : Dataset
        As it stands in the file.
    path : path
        The file.

    Raises
    ------
    DatasetError
        If this octsim can't read it; with the version that can.
    """
    try:
        number = int(dataset.attrs.get("schema_version", 0))
    except (TypeError, ValueError, OverflowError):
        number = SCHEMA + 1
    by = one_line(dataset.attrs.get("octsim_version", "of an unknown version"))
    if number > SCHEMA:
        raise DatasetError(
            f"{path}: written by octsim {by}, as schema {number}; this octsim reads up to schema "
            f"{SCHEMA}: read it with octsim {by} or later"
        )
    try:
        config = recorded_config(dataset.attrs)
    except ValueError as error:
        raise _refused(path, by, str(error)) from None
    if number == SCHEMA:
        return dataset
    missing = [n for n in _GREW.get(dataset.attrs["stage"], ()) if n not in dataset.variables]
    if missing:
        raise _refused(path, by, f"it lacks {', '.join(missing)}")
    renamed = {
        old: new
        for old, new in _RENAMED.get(dataset.attrs["stage"], {}).items()
        if old in dataset.variables
    }
    # of the name of a dimension, it was read as a coordinate
    dataset = dataset.rename_vars(renamed).reset_coords(list(renamed.values()))
    return dataset.assign_attrs(config=json.dumps(config), schema_version=SCHEMA)


def _refused(path: Path, by: str, why: str) -> DatasetError:
    return DatasetError(
        f"{path}: written by octsim {by}, and this octsim can't read it ({why}); read it with "
        f"octsim {by}, or move it away and run again to make {path.name} anew"
    )
