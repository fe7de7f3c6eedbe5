"""What differs between two runs, as lines for a person."""

from collections.abc import Iterable, Iterator

from octsim.archive.compare import Contrast, DatasetContrast, Scalar, VariableContrast
from octsim.archive.compare_origins import Change
from octsim.archive.compare_values import Kind

_SIDES = ("A", "B")


def lines(found: Contrast) -> Iterator[str]:
    """Give a comparison line by line: config, versions, numbers, what the runs come to."""
    for side, name, run in zip(_SIDES, found.names, found.runs, strict=True):
        yield f"{side}: {name} (run {run})"
    yield from ("", "config, A -> B", *_changes(found.config))
    yield from ("", "versions, A -> B", *_changes(found.versions))
    yield from (
        "",
        f"numbers, the largest relative difference; * differs (beyond {found.tolerance:g})",
        *_conditions(found),
    )
    for side, stages in zip(_SIDES, found.missing, strict=True):
        yield from (f"* {stage}.nc: missing in {side}" for stage in stages)
    for dataset in found.datasets:
        yield from _dataset(dataset, found.tolerance)
    if found.scalars:
        yield from ("", *_table(found.scalars))
    yield from ("", _verdict(found))


def _conditions(found: Contrast) -> list[str]:
    if not any(one.allowed for dataset in found.datasets for one in dataset.variables):
        return []
    return ["made in another environment: * differs beyond the tolerance that a line tells"]


def _changes(changes: tuple[Change, ...]) -> Iterable[str]:
    return [f"  {what}: {one} -> {other}" for what, one, other in changes] or ["  none"]


def _dataset(dataset: DatasetContrast, tolerance: float) -> Iterator[str]:
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


def _variable(variable: VariableContrast) -> str:
    found = variable.deviation
    if variable.kind is Kind.MEASURED:
        return "measured, not judged"
    if variable.unlike:
        return variable.unlike
    if variable.kind is Kind.EXACT:
        return f"{found.unequal} of {found.values} not equal" if found.unequal else "equal"
    said = f"{found.relative:.2e}" if found.relative else "0"
    elsewhere = f", NaN at {found.misplaced} of {found.values} places in one alone"
    unknown = f", {found.unknown} of {found.values} left out: rounding alone in one"
    return (
        said
        + (f" (tolerance {variable.allowed:.0e})" if variable.allowed else "")
        + (elsewhere if found.misplaced else "")
        + (unknown if found.unknown else "")
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


def _verdict(found: Contrast) -> str:
    if not found.differs:
        conditioned = bool(_conditions(found))
        return "the same: every number within " + (
            "its tolerance" if conditioned else f"{found.tolerance:g}"
        )
    variables = [
        f"{dataset.stage}.{variable.name}"
        for dataset in found.datasets
        for variable in dataset.variables
        if variable.differs(found.tolerance)
    ]
    what = f"{len(variables)} variables" if len(variables) != 1 else variables[0]
    return f"different: {what}" if variables else "different: not all is in both"
