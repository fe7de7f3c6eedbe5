"""Whether every value that a dataset lacks has a status that says why."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

FRINGE = frozenset({"saturated", "far_from_nominal", "mixed", "poor_fit"})
DOUBTS: dict[str, frozenset[str]] = {
    # a value is there, and to be doubted
    "fringe_status": FRINGE,
    "ray_fringe_status": FRINGE,
    "spectrum_status": FRINGE,
    "accuracy_status": frozenset({"budget_spent", "not_reached", "not_controlled", "at_an_edge"}),
    "separability": frozenset({"not_separable", "too_few"}),
    "separability_with_other": frozenset({"not_separable", "too_few"}),
    # where the error is from
    "error_status": frozenset({"scatter", "rounding"}),
    "exact_status": frozenset({"by_maxwell", "not_reached"}),
}
"""By status, meanings with which there is a value nevertheless."""
PARTS: dict[tuple[str, str], frozenset[str]] = {
    # one status for a group, some of whose variables are there with some of its meanings
    ("focus_law", "law_centre"): frozenset({"too_few"}),
    ("paths", "field_phase"): frozenset({"no_amplitude"}),
    ("diffraction", "peak_focus"): frozenset({"no_width"}),
    ("diffraction", "peak_height"): frozenset({"no_width"}),
    ("expansion", "measured_phase"): frozenset({"left_out"}),
    ("tradeoff", "rays_segments"): frozenset({"none_tried"}),
    ("tradeoff", "target_error"): frozenset({"none_tried"}),
    **{
        ("effects", f"{name}{noise}"): frozenset({"no_fringe"})
        for name in ("spectrum_change", "shape_change", "signal_ratio", "cost_ratio")
        for noise in ("", "_noise")
    },
    ("effects", "intensity_error"): frozenset({"no_fringe"}),
    # of the spectrum's shape, which there is without a fringe
    ("validity", "ray_spectrum_error"): frozenset(
        {"too_few_oscillations", "not_resolved", "no_fringe", "within_error", "other_depths"}
    ),
    ("detector", "shape_difference"): frozenset(
        {"too_few_oscillations", "not_resolved", "no_fringe", "within_error", "other_depths"}
    ),
}
"""By dataset and variable, further ones."""
SOMETIMES: frozenset[tuple[str, str]] = frozenset(
    {
        # there is a brightest focus without a Gaussian's peak, at an end of the range
        ("gaussian_fits", "brightest_focus"), ("focus_law", "brightest_focus"),
        # the largest number of a component is there where its phase is rounding alone
        ("fourier", "magnitude"),
        # an error may be given of a phase that is missing
        ("expansion", "measured_phase_error"),
        # a number of a few rays, which there is without a fringe
        ("detector", "edge_amplitude"), ("detector", "outermost_amplitude"),
        ("detector", "signal"),
    }
)  # fmt: skip
"""Variables that may be there whatever the status says; where they are missing it says why."""


def unexplained(dataset: xr.Dataset) -> Iterator[str]:
    """Say, a line each, which values are missing without a status, or there in spite of one."""
    stage = str(dataset.attrs["stage"])
    for name, variable in dataset.data_vars.items():
        if variable.dtype.kind != "f":
            continue
        statuses = str(variable.attrs.get("ancillary_variables", "")).split()
        nowhere = variable.isnull()
        if not statuses:
            if nowhere.any():
                yield f"{stage}.{name}: no status"
            continue
        if lacking := [status for status in statuses if status not in dataset]:
            yield f"{stage}.{name}: {lacking} not in the dataset"
            continue
        there = PARTS.get((stage, str(name)), frozenset())
        missing = xr.zeros_like(nowhere)
        for status in statuses:
            missing = missing | _missing(dataset[status], there)
        beyond = [d for d in missing.dims if d not in variable.dims]
        # a number of several is missing where some of them are, or all
        some, every = (
            one.transpose(*variable.dims) for one in (missing.any(beyond), missing.all(beyond))
        )
        if bool((nowhere & ~some).any()):
            yield f"{stage}.{name}: missing at {int((nowhere & ~some).sum())}, unsaid by {statuses}"
        exact = any(bool((nowhere == one).all()) for one in (some, every))
        if not exact and (stage, str(name)) not in SOMETIMES:
            yield f"{stage}.{name}: there, though {statuses} say that it is missing"


def _missing(status: xr.DataArray, there: frozenset[str]) -> xr.DataArray:
    """Return where a status says that there is no value."""
    words = str(status.attrs["flag_meanings"]).split()
    codes = np.atleast_1d(status.attrs["flag_values"]).tolist()
    assert len(words) == len(codes) == len(set(codes)), status.name
    fine = {words[codes.index(0)]} | DOUBTS.get(str(status.name), frozenset()) | there
    kept = [code for code, word in zip(codes, words, strict=True) if word in fine]
    return ~status.isin(kept)
