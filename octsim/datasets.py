"""Datasets: what each variable means, where a dataset came from, and files that appear whole."""

import json
from collections.abc import Mapping
from enum import IntEnum
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config import Config
from octsim.errors import DatasetError
from octsim.files import reason, whole
from octsim.provenance import source_digest
from octsim.reading import keys_behind, part_of

MEANINGS: Mapping[str, tuple[str, str]] = {
    # name: (units, long_name)
    "accuracy_status": ("1", "whether the accuracy that was asked for is reached"),
    "amplitude": ("1", "amplitude"),
    "centre": ("um", "focus of greatest intensity"),
    "component": ("1", "component of the Fourier transform"),
    "component_phase_slope": ("mrad/nm", "phase slope of each component"),
    "depth": ("um", "optical depth, half of the optical path difference"),
    "diameter": ("um", "diameter of the cylinder"),
    "field_amplitude": ("1", "magnitude of the field at the middle of the band"),
    "field_phase": ("rad", "phase of the field at the middle of the band, in (-pi, pi]"),
    "focus": ("um", "height of the focus above the glass"),
    "fraction": ("1", "height of the focus over the diameter"),
    "ideal_component": ("1", "strongest component for a spectrum cos(2ndk)"),
    "ideal_phase_slope_standard_deviation": (
        "mrad/nm",
        "scatter of the phase slope about its mean, for a spectrum cos(2ndk)",
    ),
    "ideal_phase_slope": ("mrad/nm", "phase slope for a spectrum cos(2ndk)"),
    "intensity": ("1", "intensity, relative to all launched light in phase"),
    "intensity_error": ("1", "estimated error of the intensity, over the largest"),
    "intercept": ("um", "intercept of the focus law"),
    "largest_deviation": ("mrad/nm", "largest deviation of the phase slope from the prediction"),
    "largest_deviation_diameter": ("um", "diameter at which the deviation is largest"),
    "magnitude": ("1", "magnitude of the component"),
    "mean_ideal_phase_slope": ("mrad/nm", "mean phase slope for a spectrum cos(2ndk)"),
    "mean_optical_path_length": ("um", "mean optical path length of the rays"),
    "mean_phase_slope": ("mrad/nm", "mean phase slope"),
    "missing_field": ("1", "estimated field of what was left out"),
    "offset": ("1", "constant below the Gaussian"),
    "optical_path_length": ("um", "optical path length from the focus to the detector"),
    "outcome": ("1", "how a segment of ray ended, or why it was not traced"),
    "outcomes": ("1", "number of segments of ray with each outcome"),
    "path": ("1", "light path: P plane, C cylinder; R reflected, T transmitted"),
    "path_code": ("1", "code of the light path"),
    "path_rays": ("1", "number of rays on the path"),
    "phase": ("rad", "phase of the component, in (-pi, pi]"),
    "phase_slope": ("mrad/nm", "phase slope of the strongest component"),
    "phase_slope_standard_deviation": ("mrad/nm", "scatter of the phase slope about its mean"),
    "predicted_phase_slope": ("mrad/nm", "predicted phase slope, n_neuron (k_min + k_max)"),
    "rays_detected": ("1", "number of rays detected"),
    "residual": ("1", "root mean square residual of the fit"),
    "rough_amplitude": ("1", "amplitude by a rougher rule, to estimate the error"),
    "segments_traced": ("1", "number of straight pieces of ray traced"),
    "share": ("1", "share of the intensity, as a mean over the band"),
    "slope": ("1", "slope of the focus law"),
    "standard_deviation_from_ideal": (
        "mrad/nm",
        "scatter of the phase slope about that of a spectrum cos(2ndk)",
    ),
    "status": ("1", "whether the fit has a peak"),
    "wavenumber": ("um-1", "wavenumber in vacuum, 2 pi / wavelength"),
    "width": ("um", "standard deviation of the Gaussian"),
    # the stability matrix; its bound is max(1e-9, 8 ε × condition number)
    "cell": ("1", "cell of the stability matrix: corner / factor / value"),
    "corner": ("1", "config from which one factor is changed"),
    "factor": ("1", "what is changed"),
    "value": ("1", "what it is changed to"),
    "paths_compared": ("1", "number of detected light paths that were compared"),
    "paths_at_edge": ("1", "number of light paths that rounding decides about"),
    "optical_path_length_error": ("um", "largest error of the optical path length"),
    "phase_error": ("rad", "largest error of the phase at the largest wavenumber"),
    "phase_condition": ("rad", "condition number where the phase's share of the bound is largest"),
    "phase_share": ("1", "largest error of the phase over its bound"),
    "amplitude_error": ("1", "largest relative error of the amplitude"),
    "amplitude_condition": ("1", "condition number where the amplitude's share is largest"),
    "amplitude_share": ("1", "largest error of the amplitude over its bound"),
    "phase_slope_error": ("mrad/nm", "rounding of the phase slope of the brightest far path"),
    "phase_slope_condition": ("rad", "condition number of that path's phase"),
    "phase_slope_share": ("1", "rounding of the phase slope over its bound"),
    "spectrum_error": ("1", "largest error of the intensity's sum, over the largest intensity"),
    "spectrum_condition": ("1", "condition number of that sum"),
    "spectrum_share": ("1", "error of the sum over its bound"),
    "launch_error": ("1", "largest error of a ray's place, over the objective's radius"),
    "launch_condition": ("1", "condition number of the objective's radius"),
    "launch_share": ("1", "error of a ray's place over its bound"),
    "single_phase_error": ("rad", "largest error of the phase in float32"),
    "single_amplitude_error": ("1", "largest relative error of the amplitude in float32"),
    "single_lost": ("1", "fraction of light paths that float32 loses"),
    "reason": ("1", "why a cell is refused, warned of or beyond the bound"),
    # what accuracy costs; errors are those from a converged reference
    "setting": ("1", "setting: the key that is varied and its value"),
    "scheme": ("1", "how rays are placed"),
    "worst_intensity_error": ("1", "error of the intensity over its maximum, largest of the sweep"),
    "median_intensity_error": ("1", "error of the intensity over its maximum, median of the sweep"),
    "intensity_change": ("1", "change of the intensity by rays that are dropped"),
    "phase_slope_rms_error": ("mrad/nm", "error of the phase slope, rms over the sweep"),
    "phase_slope_largest_error": ("mrad/nm", "largest error of the phase slope"),
    "law_slope_error": ("1", "error of the focus law's slope"),
    "law_intercept_error": ("um", "error of the focus law's intercept"),
    "focus_error": ("um", "largest error of the focus by the law, over the sweep"),
    "segments_per_diameter": ("1", "mean number of straight pieces of ray traced a diameter"),
    "cpu_seconds": ("s", "processor time to trace and sum the sweep"),
    "peak_memory": ("MiB", "growth of the process's largest resident set"),
    "unreached": ("1", "number of diameters whose accuracy is said not to be reached"),
    "beyond_accuracy": ("1", "number of diameters whose error is above the accuracy asked for"),
    "diameters_traced": ("1", "number of diameters that were traced"),
    "frontier": ("1", "whether no setting has a smaller error with as few segments"),
    "phase_slope_frontier": ("1", "whether none has a smaller slope error in as little time"),
    "default": ("1", "whether it is the run's own setting"),
    "preset": ("1", "name of the preset that it is"),
    "target": ("1", "what error the schemes are compared at"),
    "target_error": ("1", "error that the schemes are compared at"),
    "rays_segments": ("1", "segments a diameter that counted rays need for it"),
    "rays_measured": ("1", "whether those are between measured ones, or by the power law"),
    "paths_segments": ("1", "segments a diameter of the cheapest accuracy measured within it"),
    "segments_ratio": ("1", "how many times fewer segments that is"),
    "paths_segments_between": ("1", "segments a diameter between the efficient accuracies"),
    "segments_ratio_between": ("1", "how many times fewer segments those are"),
    "rays_law_factor": ("1", "factor of the power law error = factor * segments^exponent"),
    "rays_law_exponent": ("1", "exponent of that law, of counted rays"),
    "rays_law_error": ("1", "error by that law"),
    # from a phase to nanometres; what is held while the diameter changes is in docs/calibration.md
    "fixed_focus_phase_slope": ("mrad/nm", "phase slope at a fixed focus and gap"),
    "diameter_per_phase": ("nm/mrad", "change of the diameter for each mrad of phase"),
    "phase_curvature": ("mrad/nm2", "change of that phase slope with the diameter, focus held"),
    "difference_error": ("mrad/nm", "error of that phase slope as a finite difference"),
    "interpolation_error": ("mrad/nm", "error between every second of the diameters"),
    "following_phase_slope": ("mrad/nm", "phase slope if the focus follows the diameter"),
    "focus_phase_slope": ("mrad/nm", "change of the phase with the focus"),
    "fft_fixed_focus_phase_slope": ("mrad/nm", "phase slope at a fixed focus, of the fft"),
    "fft_following_phase_slope": ("mrad/nm", "phase slope if the focus follows, of the fft"),
    "near_side_phase_slope": ("mrad/nm", "change of the phase of the near side's light by itself"),
    "far_side_phase_slope": ("mrad/nm", "change of the phase of the far side's light by itself"),
    "rays_phase_slope": ("mrad/nm", "phase slope at a fixed focus, by 3000 rays"),
    "parameter": ("1", "what may differ from what is believed"),
    "budget": ("mrad/nm", "standard error of the phase slope by a parameter's tolerance"),
    "budget_error": ("mrad/nm", "error of that standard error as a finite difference"),
    "diameter_sensitivity": ("mrad/nm2", "change of the phase slope with the diameter at rest"),
    "gap_sensitivity": ("mrad/nm2", "change of the phase slope with the gap"),
    "glass_sensitivity": ("mrad/nm", "change of the phase slope with the index of glass"),
    "water_sensitivity": ("mrad/nm", "change of the phase slope with the index of water"),
    "neuron_sensitivity": ("mrad/nm", "change of the phase slope with the index of the neuron"),
    "focus_sensitivity": ("mrad/nm2", "change of the phase slope with the focus"),
    "numerical_aperture_sensitivity": ("mrad/nm", "change of the phase slope with the NA"),
    "detector_radius_sensitivity": ("mrad/nm2", "change of the phase slope with R_det"),
    "wavelength_min_sensitivity": ("mrad/nm2", "change of the phase slope with the band's edge"),
    "wavelength_max_sensitivity": ("mrad/nm2", "change of the phase slope with the band's edge"),
    "time": ("s", "time"),
    "phase_change": ("rad", "change of the phase from rest"),
    "expansion": ("nm", "change of the diameter from rest"),
    "statistical_error": ("nm", "standard error of that change, by the phase's"),
    "systematic_error": ("nm", "standard error of that change, by the calibration's"),
    "samples_missing": ("1", "number of samples without a phase"),
    "true_expansion": ("nm", "change of the diameter that was simulated"),
    "fft_expansion": ("nm", "phase of the fft over the predicted slope: the thesis's way"),
    "seed": ("1", "seed of the noise"),
    "trip_diameter": ("um", "diameter at rest of the round trips"),
    "trip_expansion": ("nm", "change of the diameter that a round trip recovers"),
    "trip_statistical_error": ("nm", "standard error of that, by the phase's"),
    "trip_systematic_error": ("nm", "standard error of that, by the calibration's"),
    "trip_bias": ("1", "mean error of the round trips, over the expansion"),
    "coverage_both": ("1", "fraction of round trips within their standard error"),
    "coverage_noise": ("1", "the same of an instrument as believed, by the statistical error"),
    "coverage_instrument": ("1", "the same without noise, by the systematic error"),
}
_STANDARD_ERROR = "_standard_error"
_COMPRESSION = {"zlib": True, "complevel": 4, "shuffle": True}


def _meaning(name: str) -> dict[str, str]:
    if name.endswith(_STANDARD_ERROR):
        units, long_name = MEANINGS[name.removesuffix(_STANDARD_ERROR)]
        return {"units": units, "long_name": f"standard error of the {long_name}"}
    units, long_name = MEANINGS[name]
    return {"units": units, "long_name": long_name}


def make(
    stage: str,
    config: Config,
    title: str,
    variables: Mapping[str, Any],
    coordinates: Mapping[str, Any],
    module: str,
) -> xr.Dataset:
    """Put a stage's results together with what they mean and what made them.

    Parameters
    ----------
    stage : str
        Name of the stage; the dataset's file is ``<stage>.nc``.
    config : Config
        The config that the results follow from.
    title : str
        One line on what is held.
    variables, coordinates : mapping
        As `xarray.Dataset` takes them; each name has its entry in `MEANINGS`.
    module : str
        Module that the stage's function stands in, for the digest of the sources.
    """
    dataset = xr.Dataset(variables, coordinates)
    for name in map(str, dataset.variables):
        dataset[name].attrs = _meaning(name) | dataset[name].attrs
    file = f"results/{config.run}/{stage}.nc"
    dataset.attrs = {
        "Conventions": "CF-1.11",
        "title": title,
        "stage": stage,
        "config": json.dumps(config.to_dict()),
        "octsim_version": version("octsim"),
        "source_digest": source_digest(module),
        "creation_command": (
            "save the attribute 'config' of this file as config.json, then: "
            f".venv/bin/snakemake {file} --cores 2 --configfile config.json"
        ),
    }
    return dataset


def write(dataset: xr.Dataset, path: str | Path) -> None:
    """Write a dataset so that the file is there whole or not at all.

    Raises
    ------
    FileError
        If it can't be written; what stood at `path` before is still there.
    """
    encoding = {
        name: (_COMPRESSION if variable.ndim and variable.dtype.kind in "iuf" else {})
        | ({"_FillValue": None} if variable.dtype.kind == "f" else {})
        for name, variable in dataset.variables.items()
    }
    with whole(Path(path)) as temporary:
        dataset.to_netcdf(temporary, engine="netcdf4", encoding=encoding)


def read(path: str | Path, stage: str, config: Config | None = None) -> xr.Dataset:
    """Read a dataset of a stage into memory.

    Parameters
    ----------
    path : path
        The file.
    stage : str
        Stage that it has to be of.
    config : Config, optional
        Config that it has to follow from, as far as its stage depends on one.

    Raises
    ------
    DatasetError
        If the file is missing, damaged, not a dataset of that stage, or made from another config.
    """
    path = Path(path)
    remedy = f"move it away and run again to make {path.name} anew"
    try:
        dataset = xr.load_dataset(path, engine="netcdf4")
    except FileNotFoundError:
        raise DatasetError(f"{path}: not there; run the stage {stage} first") from None
    except (OSError, RuntimeError, ValueError) as error:
        raise DatasetError(f"{path}: can't be read ({reason(error)}); {remedy}") from None
    if dataset.attrs.get("stage") != stage:
        raise DatasetError(f"{path}: not octsim's dataset of the stage {stage}; {remedy}")
    if config is not None:
        made_from, asked = json.loads(dataset.attrs["config"]), config.to_dict()
        keys = keys_behind(stage, config)
        differ = [key for key in keys if part_of(made_from, key) != part_of(asked, key)]
        if differ:
            raise DatasetError(
                f"{path}: made from another config (its {', '.join(differ)} differ); {remedy}"
            )
    return dataset


def flags(
    codes: type[IntEnum], values: NDArray[np.int64]
) -> tuple[NDArray[np.int8], dict[str, Any]]:
    """Give the values of an enumeration with the CF attributes that name them."""
    members = list(codes)
    return np.asarray(values, np.int8), {
        "flag_values": np.array([m.value for m in members], np.int8),
        "flag_meanings": " ".join(m.name.lower() for m in members),
    }
