"""Spectra: the detected light of each diameter over the wavenumbers (figure 8)."""

from collections.abc import Iterator, Mapping

import numpy as np
import xarray as xr

from octsim.base.threads import each_block
from octsim.config.grid import Combination
from octsim.config.models import Config
from octsim.config.scheme import point_cost, scheme_of
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout, filling
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.instrument.instrument import Instrument
from octsim.schemes.light import AccuracyStatus, Found
from octsim.stages.kept_light import lights_in, stored_by_kind
from octsim.stages.workload import points_per_block

_ROUGH = 0.1  # of the largest intensity; an error that a slope does not survive


@Streamed
def spectra(
    config: Config,
    detected: xr.Dataset | None = None,
    threads: int = 1,
    fields: xr.Dataset | None = None,
) -> Stream:
    """Turn the detected light of each diameter into a spectrum.

    Parameters
    ----------
    config : Config
        The run.
    detected : Dataset
        Of the stage detections, where the run has it.
    threads : int
        How many sum at the same time.
    fields : Dataset
        Of the stage fields, where the run has it.

    Returns
    -------
    Dataset
        intensity(diameter, wavenumber) and focus(diameter), with the estimated error of the
        intensity and whether that is as asked (diameter).

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "tracing": {"rays": 200},
    ...         "sweep": {
    ...             "diameters": {"stop": "1.1 um", "num": 3},
    ...             "focus": {"slope": 0.58, "intercept": "66 nm"},
    ...         },
    ...     }
    ... )
    >>> spectra = octsim.spectra(config, octsim.detections(config))
    >>> dict(spectra["intensity"].sizes)
    {'diameter': 3, 'wavenumber': 1000}
    """

    def own(config: Config) -> dict[str, Coordinate]:
        return {
            "diameter": ("diameter", config.sweep.diameters.values()),
            "wavenumber": ("wavenumber", config.spectrum.wavenumbers()),
        }

    title = "Spectrum of the detected light, for each diameter"
    layout = Layout("spectra", config, title, own, "diameter")
    stored = stored_by_kind(layout, detected, fields)
    return Stream(layout, _summed(layout, stored, threads))


def _summed(layout: Layout, stored: Mapping[str, Stored], threads: int) -> Iterator[Part]:
    parts: dict[int, xr.Dataset] = {}

    def points_of(block: tuple[Combination, slice]) -> Iterator[tuple[Instrument, Found]]:
        at, span = block
        kind = scheme_of(at.config).light
        part = stored[kind].part(at, span)
        parts[id(block)] = part[["accuracy_status", "focus"]]
        instrument = Instrument(at.config)
        return ((instrument, light) for light in lights_in(part, kind))

    def most(config: Config) -> int:
        return points_per_block(8 * config.spectrum.samples + point_cost(config).size)

    blocks = list(layout.blocks(most))
    for block, found in each_block(lambda p: p[0].sum(p[1]), blocks, points_of, threads):
        (at, span), part = block, parts.pop(id(block))
        intensity, error, _ = zip(*found, strict=True)
        status = part["accuracy_status"].values
        # the error is judged at the samples themselves
        late = np.array(error) > at.config.tracing.accuracy
        reached = status == AccuracyStatus.REACHED
        status = np.where(reached & late, AccuracyStatus.NOT_REACHED, status)
        nothing = np.where(status == AccuracyStatus.NO_FOCUS, np.nan, 0.0)
        variables = {
            "intensity": (("diameter", "wavenumber"), np.stack(intensity) + nothing[:, None]),
            "intensity_error": ("diameter", np.array(error) + nothing),
            "accuracy_status": ("diameter", *flags(AccuracyStatus, status)),
            "focus": ("diameter", part["focus"].values),
        }
        yield Part(at, span.start, len(found), variables)


def doubts(measured: xr.Dataset) -> list[str]:
    """Say, a line each, where a run's spectra are not what one would want."""
    status, error = measured["accuracy_status"].values, measured["intensity_error"].values
    none = status == AccuracyStatus.NO_FOCUS
    fine = (AccuracyStatus.REACHED, AccuracyStatus.NOT_CONTROLLED, filling(status.dtype))
    missed = ~np.isin(status, fine) & ~none
    rough = (status == AccuracyStatus.NOT_CONTROLLED) & (error > _ROUGH)
    said = []
    if missed.any():
        said.append(
            f"the accuracy is not, or not surely, reached at {missed.sum()} of {missed.size} "
            f"points (accuracy_status says where and why; estimated error up to "
            f"{error[missed].max():.2g}): {AccuracyStatus.NOT_REACHED.remedy}"
        )
    if rough.any():
        said.append(
            f"the estimated error of the intensity is above {_ROUGH} of its largest at "
            f"{rough.sum()} of {rough.size} points (intensity_error; up to "
            f"{error[rough].max():.2g}), so their slopes mean little: "
            f"{AccuracyStatus.NOT_CONTROLLED.remedy}"
        )
    if none.any():
        laws = none.reshape(-1, none.shape[-1]).all(axis=1)
        said.append(
            f"there is no focus law at {laws.sum()} of {laws.size} combinations, which are NaN "
            f"(focus_law.nc has the status of each fit): {AccuracyStatus.NO_FOCUS.remedy}"
        )
    return said
