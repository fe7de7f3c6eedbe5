"""What a calibration says of itself: what it found, and where it is not what one would want."""

import numpy as np
import xarray as xr

from octsim.config.maxwell import beyond_maxwell
from octsim.config.models import Config
from octsim.datasets.versions import recorded_config
from octsim.schemes.light import AccuracyStatus
from octsim.stages.beside_maxwell import pupil_name
from octsim.studies.calibration.scheme import MODEL, ModelStatus, rays_because


def summary(table: xr.Dataset) -> str:
    """Return what a calibration found, in one line, with what its number is of."""
    config = Config.model_validate(recorded_config(table.attrs))
    slope, error = table["fixed_focus_phase_slope"], table["fixed_focus_phase_slope_standard_error"]
    share = float((error / np.abs(slope)).max(skipna=False))
    sure = f"{share:.2%} or less" if np.isfinite(share) else "not known everywhere"
    line = f"{float(table['slope']):.3g} d {1e3 * float(table['intercept']):+.3g} nm"
    waves = f"Maxwell's equations ({pupil_name(config)} pupil)"
    scheme = "light paths" if rays_because(config) else waves
    return (
        f"phase slope by {scheme}, at a fixed focus (held at {line}) and by the estimator "
        f"{config.calibration.estimator}: {float(slope.min()):.3f} to {float(slope.max()):.3f} "
        f"mrad/nm, standard error {sure}, most of it {_largest(table)}"
    )


def _largest(table: xr.Dataset) -> str:
    """Say what the standard error is mostly of."""
    parts = {
        str(name): float(table["budget"].sel(parameter=name).mean("diameter", skipna=False))
        for name in table["parameter"].values
    }
    parts["interpolation"] = float(table["interpolation_error"].mean())
    unknown = [name for name, part in parts.items() if np.isnan(part)]
    largest = unknown[0] if unknown else max(parts, key=lambda name: parts[name])
    others = {
        MODEL: "as far as rays are off",
        "interpolation": "by interpolation (raise calibration.diameters.num)",
    }
    return others.get(largest, f"from calibration.tolerances.{largest}")


def doubts(table: xr.Dataset) -> list[str]:
    """Say, a line each, where a calibration is not what one would want."""
    said, status = _doubts_of_spectra(table) + _unseen(table), table["model_status"].values
    compared, unknown = (status == one for one in (ModelStatus.COMPARED, ModelStatus.NOT_COMPARED))
    slope = table["fixed_focus_phase_slope"].values
    lost = np.abs(slope) < table["fixed_focus_phase_slope_standard_error"].values
    if lost.any() or (np.sign(slope) != np.sign(slope[0])).any():
        said.append(
            f"the slope changes its sign, or its standard error is larger than it, at "
            f"{max(lost.sum(), 1)} of {slope.size} diameters: there the calibration means nothing; "
            "give another pupil, focus or calibration.estimator (docs/design.md)"
        )
    if not (compared.any() or unknown.any()):
        return said
    config = Config.model_validate(recorded_config(table.attrs))
    reason = rays_because(config).partition("; ")[0]
    beyond = beyond_maxwell(config).partition("; ")[0] or "their accuracy was not reached"
    if compared.any():
        off = (table["fixed_focus_phase_slope"] / table["maxwell_phase_slope"] - 1)[compared]
        said.append(
            f"the slope is by rays ({reason}), {float(off.min()):+.1%} to {float(off.max()):+.1%} "
            "from Maxwell's equations, which its standard error has as budget 'model'; leave "
            "calibration.scheme out"
        )
    if unknown.any():
        said.append(
            f"the slope is by rays ({reason}) and is not compared with Maxwell's equations at "
            f"{unknown.sum()} of {unknown.size} diameters ({beyond}), so its standard error is not "
            "known there (NaN); where it was compared it is often 10 % off (docs/validity.md)"
        )
    return said


def _unseen(table: xr.Dataset) -> list[str]:
    """Say which tolerances of the scene's numbers the slope's error has nothing of."""
    tolerances = Config.model_validate(recorded_config(table.attrs)).calibration.tolerances
    lacking = [key for key in tolerances.of_scene if key not in table["parameter"].values]
    if not lacking:
        return []
    return [
        f"calibration.tolerances.{lacking[0]}{f' and {len(lacking) - 1} more' * bool(lacking[1:])} "
        "given, which the scheme of the slope does not see, so its standard error has nothing of "
        "it; leave it out, or give another calibration.scheme"
    ]


def _doubts_of_spectra(table: xr.Dataset) -> list[str]:
    late = table["accuracy_status"].values != AccuracyStatus.REACHED
    if not late.any():
        return []
    error = float(table["intensity_error"].values[late].max())
    return [
        f"the accuracy of the spectra is not, or not surely, reached at {late.sum()} of "
        f"{late.size} diameters (accuracy_status; estimated error up to {error:.2g}): give other "
        "calibration.diameters, or another calibration.scheme"
    ]
