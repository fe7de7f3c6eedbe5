"""What differs between two runs, as lines for a person."""

from collections.abc import Iterable, Iterator

from octsim.archive.compare import Comparison, DatasetComparison, Scalar, VariableComparison
from octsim.archive.compare_origins import Change
from octsim.archive.compare_values import ValueKind
from octsim.base.errors import printable

_SIDES = ("A", "B")


def lines(comparison: Comparison) -> Iterator[str]:
    """Return a comparison line by line: config, versions, numbers, what the runs come to."""
    # names and versions are what stands in files
    return map(printable, _lines(comparison))


def _lines(comparison: Comparison) -> Iterator[str]:
    for side, name, run in zip(_SIDES, comparison.names, comparison.runs, strict=True):
        yield f"{side}: {name} (run {run})"
    yield from ("", "config, A -> B", *_changes(comparison.config))
    yield from ("", "versions, A -> B", *_changes(comparison.versions))
    yield from (
        "",
        f"numbers, the largest relative difference; * differs (beyond {comparison.tolerance:g})",
        *_conditions(comparison),
    )
    for side, stages in zip(_SIDES, comparison.missing, strict=True):
        yield from (f"* {stage}.nc: missing in {side}" for stage in stages)
    for dataset in comparison.datasets:
        yield from _dataset(dataset, comparison.tolerance)
    if comparison.scalars:
        yield from ("", *_table(comparison.scalars))
    yield from ("", _verdict(comparison))


def _conditions(comparison: Comparison) -> list[str]:
    if not any(one.allowed for dataset in comparison.datasets for one in dataset.variables):
        return []
    return ["made in another environment: * differs beyond the tolerance that a line tells"]


def _changes(changes: tuple[Change, ...]) -> Iterable[str]:
    return [f"  {what}: {one} -> {other}" for what, one, other in changes] or ["  none"]


def _dataset(dataset: DatasetComparison, tolerance: float) -> Iterator[str]:
    yield f"  {dataset.stage}.nc"
    for dimension, common, (one, other) in dataset.unshared:
        yield f"*   {dimension}: compared at {common} of {one} (A) and {other} (B)"
    if dataset.uneven:
        yield f"*   rays: not compared at {dataset.uneven} points that have not as many in A and B"
    for side, names in zip(_SIDES, dataset.missing, strict=True):
        yield from (f"*   {name}: missing in {side}" for name in names)
    width = max((len(variable.name) for variable in dataset.variables), default=0)
    for variable in dataset.variables:
        mark = "*" if variable.differs(tolerance) else " "
        yield f"{mark}   {variable.name:{width}}  {_variable(variable)}"


def _variable(variable: VariableComparison) -> str:
    apart = variable.deviation
    if variable.kind is ValueKind.MEASURED:
        return "measured, not judged"
    if variable.unlike:
        return variable.unlike
    if variable.kind is ValueKind.EXACT:
        return f"{apart.unequal} of {apart.values} not equal" if apart.unequal else "equal"
    text = f"{apart.relative:.2e}" if apart.relative else "0"
    elsewhere = f", NaN at {apart.misplaced} of {apart.values} places in one alone"
    unknown = f", {apart.unknown} of {apart.values} left out: rounding alone in one"
    return (
        text
        + (f" (tolerance {variable.allowed:.0e})" if variable.allowed else "")
        + (elsewhere if apart.misplaced else "")
        + (unknown if apart.unknown else "")
    )


def _table(scalars: tuple[Scalar, ...]) -> Iterator[str]:
    rows = [
        (
            f"{one.name} ({one.units})" if one.units != "1" else one.name,
            f"{one.first:.6g}",
            f"{one.second:.6g}",
            f"{one.second - one.first:+.3g}",
        )
        for one in scalars
    ]
    table = [("what it comes to", *_SIDES, "B - A"), *rows]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for name, *cells in table:
        numbers = (f"{cell:>{width}}" for cell, width in zip(cells, widths[1:], strict=True))
        yield f"{name:{widths[0]}}  {'  '.join(numbers)}"


def _verdict(comparison: Comparison) -> str:
    if not comparison.differs:
        conditioned = bool(_conditions(comparison))
        return "the same: every number within " + (
            "its tolerance" if conditioned else f"{comparison.tolerance:g}"
        )
    variables = [
        f"{dataset.stage}.{variable.name}"
        for dataset in comparison.datasets
        for variable in dataset.variables
        if variable.differs(comparison.tolerance)
    ]
    what = f"{len(variables)} variables" if len(variables) != 1 else variables[0]
    return f"different: {what}" if variables else "different: not all is in both"
