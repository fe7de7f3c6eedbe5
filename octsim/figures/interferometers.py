"""The thesis's section 2: a Michelson interferometer, and plates."""

import xarray as xr
from matplotlib.figure import Figure

from octsim.figures.style import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, label, title

_LOOKS = (
    (GREEN, "-"), (BLUE, "--"), (ORANGE, "-."), (SKY, (0, (8, 2))), (PURPLE, (0, (3, 1, 1, 1))),
    (VERMILION, (0, (5, 1, 1, 1, 1, 1))), ("0.4", ":"),
)  # fmt: skip
_DEEPEST = 8.0
"""Of the transforms that are drawn, µm."""


def michelson_figure(table: xr.Dataset) -> Figure:
    """Draw the spectrum with the reference arm, its transform, and the light over its length."""
    figure = Figure(figsize=(6.4, 7.2))
    spectrum, transform, moved = figure.subplots(3)
    k = table["wavenumber"]
    spectrum.plot(k, table["michelson_intensity"], color=BLUE, label="octsim")
    spectrum.plot(k, table["michelson_closed_form"], color=ORANGE, linestyle=":", label="eq. (1)")
    spectrum.set_xlabel(label(k))
    spectrum.set_ylabel("Intensity")
    spectrum.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=2)
    figure.suptitle(title(table, "Michelson interferometer"))
    transform.plot(table["depth"], table["michelson_magnitude"], color=BLUE, marker=".")
    transform.set_xlim(0, 2 * _DEEPEST)
    transform.set_xlabel(f"Length L, one way (µm); shown to {2 * _DEEPEST:g} µm")
    transform.set_ylabel("Magnitude")
    arm = table["arm"]
    moved.plot(
        arm, table["one_wavelength_intensity"], color=ORANGE, linewidth=0.9, label="one wavelength"
    )
    moved.plot(arm, table["band_intensity"], color=BLUE, label="the band")
    moved.set_xlabel(label(arm, "length of the moved arm, one way"))
    moved.set_ylabel("Intensity over\nboth arms' own")
    figure.legend(*moved.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def plates_figure(table: xr.Dataset) -> Figure:
    """Draw spectra and transforms of one thickness, and the slope over the thickness."""
    figure = Figure(figsize=(6.4, 8.4))
    spectrum, transform, slope = figure.subplots(3)
    for place, (colour, line) in enumerate(_LOOKS):
        one = table.isel(case=place)
        shown = one["plates_intensity"]
        scaled = (shown - shown.min()) / (shown.max() - shown.min())
        spectrum.plot(one["wavenumber"], scaled, color=colour, linestyle=line)
        magnitude = one["magnitude"] / one["magnitude"].max()
        name = str(one["case"].item())
        transform.plot(
            one["depth"], magnitude, color=colour, linestyle=line, marker=".", label=name
        )
        slope.plot(one["diameter"], one["phase_slope"], color=colour, linestyle=line)
    slope.axhline(
        float(table["predicted_phase_slope"]), color="black", linestyle=":", label="eq. (2)"
    )
    thickness = float(table["shown_thickness"])
    spectrum.set_title(title(table, f"Plates, {thickness:.3g} µm"))
    spectrum.set_xlabel(label(table["wavenumber"]))
    spectrum.set_ylabel("Intensity (0 to 1)")
    transform.set_xlim(0, _DEEPEST)
    transform.set_xlabel(f"{label(table['depth'])}; shown to {_DEEPEST:g} µm")
    transform.set_ylabel("Magnitude (largest = 1)")
    slope.set_xlabel(label(table["diameter"], "thickness"))
    slope.set_ylabel(label(table["phase_slope"], "phase slope"))
    figure.legend(loc="outside lower center", ncols=2, handlelength=4)
    return figure
