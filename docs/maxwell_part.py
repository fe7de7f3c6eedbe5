"""The thesis's claim for rays, answered with what was measured: a part of docs/tradeoff.md."""

import numpy as np
import xarray as xr
from markdown import table

from octsim.studies.tradeoff.settings import OF_WAVES

_THESIS, _STANDARD, _EXACT = (
    "the thesis's 3000 rays",
    "preset standard (rays to 1e-4)",
    "preset exact (fullwave at 1e-4)",
)
_SHOWN = {
    "100 rays": ("tracing.rays", 100),
    _THESIS: ("tracing.rays", 3000),
    "preset draft (rays to 3e-2)": ("tracing.accuracy", 3e-2),
    _STANDARD: ("tracing.accuracy", 1e-4),
    "fullwave at 1e-2": (OF_WAVES, 1e-2),
    _EXACT: (OF_WAVES, 1e-4),
    "fullwave at 1e-8": (OF_WAVES, 1e-8),
}
_HEAD = [
    "", "CPU (s)", "times that of 3000 rays", "shape of I(k), worst", "median",
    "phase slope, rms (mrad/nm)", "bias",
]  # fmt: skip


def claim(trade: xr.Dataset) -> str:
    """Answer the thesis's claim: what rays and Maxwell's equations cost, and how far apart."""
    number = {
        name: int(np.flatnonzero((trade["factor"] == factor) & (trade["value"] == value))[0])
        for name, (factor, value) in _SHOWN.items()
    }
    of = {name: trade.isel(setting=place) for name, place in number.items()}
    thesis, standard, exact = of[_THESIS], of[_STANDARD], of[_EXACT]
    rows = [
        [
            name,
            f"{float(one['cpu_seconds']):.2g}",
            f"{float(one['cpu_seconds'] / thesis['cpu_seconds']):.2g}",
            f"{float(one['maxwell_spectrum_worst_error']):.1e}",
            f"{float(one['maxwell_spectrum_median_error']):.1e}",
            f"{float(one['maxwell_slope_rms_error']):.1e}",
            f"{float(one['maxwell_slope_bias']):+.1e}".replace("-", "−"),
        ]
        for name, one in of.items()
    ]
    return _TEMPLATE.format(
        rows=table(_HEAD, rows),
        slower=f"{float(exact['cpu_seconds'] / thesis['cpu_seconds']):.0f}",
        seconds=f"{float(exact['cpu_seconds']):.1f}",
        shape=f"{100 * float(standard['maxwell_spectrum_median_error']):.0f}",
        thesis_shape=f"{100 * float(thesis['maxwell_spectrum_median_error']):.0f}",
        bias=f"{float(standard['maxwell_slope_bias']):+.2f}".replace("-", "−"),
        rms=f"{float(standard['maxwell_slope_rms_error']):.2f}",
    )


_TEMPLATE = """{rows}
The thesis (section 4) takes rays, as a solver of the whole field can take hours, and rays are much
faster and give very usable results. That a field takes hours is true of a grid in space and time
([peers.md](peers.md)), and not of Maxwell's equations: for a cylinder over a plane they are summed
in partial waves, and the sweep takes {seconds} s of processor time, {slower} times that of 3000
rays. How usable rays are is what they are used for: the shape of the spectrum stays {shape} % from
Maxwell's (median over the diameters) however well each path is integrated, and {thesis_shape} %
with 3000 rays: no ray has the pupil's diffraction, and the thesis's instrument, a uniform pupil
and a cut by position, is not the fibre's mode that waves are weighed with unless the config says
otherwise. The phase slope is off by {bias} mrad/nm on average, and by {rms} mrad/nm rms. More rays,
or a finer accuracy of paths, bring no truth beyond that.
"""
