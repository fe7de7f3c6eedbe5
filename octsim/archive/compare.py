"""Two runs, or two datasets, side by side: what differs, and by how much."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from octsim.archive.compare_conditions import TOLERANCE, Condition, condition, same_environment
from octsim.archive.compare_origins import Change, config_changes, version_changes
from octsim.archive.compare_points import Common, blocks, common_points
from octsim.archive.compare_values import UNKNOWN, Deviation, ValueKind, deviation, value_kind
from octsim.archive.recorded import Recorded, recorded
from octsim.base.errors import DatasetError
from octsim.datasets.files import guarded, opened
from octsim.datasets.status_variables import STATUSES

ADDED = frozenset(
    {
        *STATUSES,
        "phase_status", "fringe_status", "fringe_visibility", "centre_use", "brightest_focus",
        "relative_residual", "error_status", "rest_scatter", "smallest_step", "drift",
        "exact_phase_slope", "exact_status", "law_scheme",
    }
)  # fmt: skip
"""Variables that older files lack, and that say of others where they hold nothing or how good they
are. Rounding decides at the limit, so that they are judged within one environment alone."""
SCALARS: Mapping[str, tuple[str, ...]] = {
    "focus_law": ("slope", "intercept"),
    "phase_slope": (
        "mean_phase_slope",
        "phase_slope_standard_deviation",
        "predicted_phase_slope",
        "standard_deviation_from_ideal",
        "mean_ideal_phase_slope",
        "ideal_phase_slope_standard_deviation",
        "largest_deviation",
        "largest_deviation_diameter",
    ),
}
"""What a run comes to, by stage."""


class VariableComparison(NamedTuple):
    """A variable of a dataset in two runs."""

    name: str
    kind: ValueKind
    deviation: Deviation
    unlike: str = ""
    """Why its values can't be compared, if they can't."""
    allowed: float = 0.0
    """Relative difference that its condition allows, where another environment made it."""

    def differs(self, tolerance: float) -> bool:
        """Return whether it is another than in the other run; what is measured never is."""
        if self.kind is ValueKind.MEASURED:
            return False
        apart = self.deviation
        beyond = not apart.relative <= max(tolerance, self.allowed)
        return bool(self.unlike or beyond or apart.misplaced or apart.unequal)


class Unshared(NamedTuple):
    """Points along a dimension that are not all in both runs."""

    dimension: str
    common: int
    sizes: tuple[int, int]


class DatasetComparison(NamedTuple):
    """A stage's dataset in two runs."""

    stage: str
    variables: tuple[VariableComparison, ...]
    """Those that both have."""
    missing: tuple[tuple[str, ...], tuple[str, ...]] = ((), ())
    """Variables that the first run, and that the second run lacks."""
    unshared: tuple[Unshared, ...] = ()
    uneven: int = 0
    """Number of shared points that have not as many rays, which are not compared."""

    def differs(self, tolerance: float) -> bool:
        """Return whether it is another than in the other run."""
        apart = any(self.missing) or self.unshared or self.uneven
        return bool(apart) or any(one.differs(tolerance) for one in self.variables)


class Scalar(NamedTuple):
    """A number that a run comes to, in both."""

    name: str
    """Of its stage and of itself."""
    units: str
    first: float
    second: float


class Comparison(NamedTuple):
    """Two runs side by side."""

    names: tuple[str, str]
    """As they were given."""
    runs: tuple[str, str]
    """Names of the runs."""
    tolerance: float
    config: tuple[Change, ...]
    versions: tuple[Change, ...]
    datasets: tuple[DatasetComparison, ...]
    """Those that both have."""
    missing: tuple[tuple[str, ...], tuple[str, ...]]
    """Stages whose dataset the first run, and the second run lacks."""
    scalars: tuple[Scalar, ...]

    @property
    def differs(self) -> bool:
        """Whether any number is beyond the tolerance, or not in both.

        Another config or version is none by itself: numbers tell what it did.
        """
        return any(self.missing) or any(one.differs(self.tolerance) for one in self.datasets)


def compare(first: str | Path, second: str | Path, tolerance: float | None = None) -> Comparison:
    """Compare two runs variable by variable, on the points that they share.

    Parameters
    ----------
    first, second : path
        A run's folder as ``results/thesis``, or the file of one of its datasets.
    tolerance : float, optional
        Largest relative difference, max ``|a − b|`` / max ``|b|`` over a variable, of what is the
        same. If none is given, `TOLERANCE` where both were made in one environment, else what the
        condition of each variable allows.

    Returns
    -------
    Comparison
        What differs in config, versions and numbers.

    Raises
    ------
    DatasetError
        If one of them can't be read, or they have no dataset in common.

    Examples
    --------
    >>> import octsim
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> scan = octsim.focus_scan(octsim.load_config({"tracing": {"rays": 200}}))
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "focus_scan.nc")
    ...     scan.to_netcdf(file)
    ...     octsim.compare(file, file).differs
    False
    """
    with recorded(Path(first)) as one, recorded(Path(second)) as other:
        return compare_recorded(one, other, tolerance)


def compare_recorded(
    first: Recorded, second: Recorded, tolerance: float | None = None
) -> Comparison:
    """Compare two runs that are at hand; see `compare`."""
    shared = [stage for stage in first.datasets if stage in second.datasets]
    if not shared:
        held = " and ".join(", ".join(one.datasets) for one in (first, second))
        raise DatasetError(f"{first.name}, {second.name}: no dataset in common ({held})")
    compared, scalars = [], []
    for stage in shared:
        with _both(stage, first, second) as (one, other):
            by_condition = tolerance is None and not same_environment(one, other)
            conditioned = condition(other, stage, second.config) if by_condition else None
            compared.append(_dataset(stage, one, other, conditioned))
            scalars += _scalars(stage, one, other)
    return Comparison(
        names=(first.name, second.name),
        runs=(first.config.run, second.config.run),
        tolerance=TOLERANCE if tolerance is None else tolerance,
        config=config_changes(first.config, second.config),
        versions=version_changes(first.datasets, second.datasets),
        datasets=tuple(compared),
        missing=(_lacking(first, second), _lacking(second, first)),
        scalars=tuple(scalars),
    )


def _lacking(one: Recorded, other: Recorded) -> tuple[str, ...]:
    return tuple(stage for stage in other.datasets if one.whole and stage not in one.datasets)


@contextmanager
def _both(stage: str, first: Recorded, second: Recorded) -> Iterator[tuple[xr.Dataset, xr.Dataset]]:
    files = first.datasets[stage], second.datasets[stage]
    with (
        opened(files[0], stage) as one,
        opened(files[1], stage) as other,
        # whatever a damaged or hostile file makes of its sizes and types
        guarded(" or ".join(map(str, files)), "make anew the one that is damaged"),
    ):
        yield one, other


def _dataset(
    stage: str, first: xr.Dataset, second: xr.Dataset, conditioned: Condition | None
) -> DatasetComparison:
    names = [str(name) for name in first.variables]
    common, uneven = common_points(first, second)
    compared = [_variable(n, first, second, common) for n in names if n in second.variables]
    if conditioned is not None:
        compared = [_allowed(one, second, conditioned) for one in compared]
    return DatasetComparison(
        stage,
        tuple(compared),
        (
            tuple(str(n) for n in second.variables if n not in first.variables and n not in ADDED),
            tuple(n for n in names if n not in second.variables and n not in ADDED),
        ),
        tuple(
            Unshared(dimension, points.first.size, points.sizes)
            for dimension, points in common.items()
            if not points.is_all
        ),
        uneven,
    )


def _allowed(one: VariableComparison, dataset: xr.Dataset, by: Condition) -> VariableComparison:
    """Judge a variable as its condition allows."""
    if one.name in ADDED:
        return one._replace(kind=ValueKind.MEASURED)
    if one.kind not in (ValueKind.NUMBER, ValueKind.ANGLE) or one.unlike:
        return one
    units = str(dataset[one.name].attrs.get("units", "1"))
    return one._replace(allowed=by.tolerance(one.name, units, one.deviation.scale))


def _variable(
    name: str, first: xr.Dataset, second: xr.Dataset, common: Mapping[str, Common]
) -> VariableComparison:
    one, other = first.variables[name], second.variables[name]
    kind = value_kind(name, one.dtype, name in first.coords or name in second.coords)
    unlike = _unlike(one, other, common)
    if unlike or kind is ValueKind.MEASURED:
        return VariableComparison(name, kind, Deviation(), unlike)
    apart = deviation(blocks(one, other, common), kind, name in UNKNOWN)
    return VariableComparison(name, kind, apart)


def _unlike(one: xr.Variable, other: xr.Variable, common: Mapping[str, Common]) -> str:
    """Return why two variables' values can't be compared, if they can't."""
    if one.dims != other.dims:
        return f"dimensions {_listed(one)} -> {_listed(other)}"
    types = _type(one.dtype), _type(other.dtype)
    if types[0] != types[1]:
        return f"type {types[0]} -> {types[1]}"
    units = one.attrs.get("units"), other.attrs.get("units")
    if units[0] != units[1]:
        return f"units {units[0]} -> {units[1]}"
    empty = [
        str(d) for d in one.dims if common[str(d)].first.size == 0 != max(common[str(d)].sizes)
    ]
    return f"no {' or '.join(empty)} in common" if empty else ""


def _type(dtype: np.dtype[Any]) -> str:
    return "text" if dtype.kind in "OSUT" else str(dtype)


def _listed(variable: xr.Variable) -> str:
    return f"({', '.join(map(str, variable.dims))})"


def _scalars(stage: str, first: xr.Dataset, second: xr.Dataset) -> list[Scalar]:
    """Return what both runs come to; of a grid nothing is one number."""
    there = [
        name
        for name in SCALARS.get(stage, ())
        if all(name in dataset and not dataset[name].ndim for dataset in (first, second))
    ]
    return [
        Scalar(
            f"{stage} {name}",
            str(second[name].attrs.get("units", "1")),
            float(first[name]),
            float(second[name]),
        )
        for name in there
    ]
