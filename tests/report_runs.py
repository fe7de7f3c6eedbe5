"""Runs in folders, as a report finds them."""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from made_runs import CALIBRATED, every_stage

import octsim
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.datasets.files import write
from octsim.phase.measured_series import read_series
from octsim.studies.calibration.expansion import series_expansion
from octsim.studies.effects import study as study_of_effects
from octsim.studies.effects.study import effects
from octsim.studies.effects.variants import EffectStatus, Variant, variants
from octsim.studies.validity import study as study_of_validity
from octsim.studies.validity.cases import AS_CONFIGURED, cases
from octsim.studies.validity.study import validity

TRIED = "falloff cosine"
SMALL = {
    "tracing": {"rays": 150},
    "spectrum": {"samples": 40},
    "focus_scan": {"focus": {"num": 5}},
    "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 9}},
    "sweep": {"diameters": {"num": 5}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
}


def written(datasets: Mapping[str, xr.Dataset], folder: Path) -> Path:
    for name, dataset in datasets.items():
        write(dataset, folder / f"{name}.nc")
    return folder


def full_run(folder: Path, calibrated: xr.Dataset) -> Path:
    """Write a run with everything beside it that a report shows; its studies are small.

    Its calibration is that of `CALIBRATED`, as a table does not depend on a run's rays.
    """
    folder.mkdir()
    series = folder.parent / "phases.csv"
    time = np.linspace(0, 0.02, 60)
    change = np.where(time > 0.008, 0.03, 0.0) + 1e-3 * np.sin(900 * time)
    rows = "".join(f"{t},{p}\n" for t, p in zip(time, change, strict=True))
    series.write_text(f"time (s),phase (rad)\n{rows}", encoding="utf-8")
    config = load_config(
        SMALL,
        CALIBRATED,
        {
            "run": "looked",
            "tracing": {"rays": 300},
            "sweep": {"diameters": {"num": 9}},
            "expansion": {"series": str(series), "diameter": "1.4 um"},
        },
    )
    made = every_stage(config)
    made["phase_slope"] = octsim.phase_slope(config, made["fourier"], made["spectra"])
    named = json.loads(calibrated.attrs["config"]) | {"run": config.run}
    made["calibration"] = calibrated.assign_attrs(config=json.dumps(named))
    made["expansion"] = series_expansion(config, read_series(series), calibrated)
    return written(made | _studies(config), folder)


def _studies(config: Config) -> dict[str, xr.Dataset]:
    """Return both studies with what takes little time."""

    def listed(own: Config) -> list[Variant]:
        return [
            one
            if one.effect.name == TRIED or one.effect.focus or one.configured or not one.measured
            else one._replace(status=EffectStatus.NOT_IN_THIS_SCENE)
            for one in variants(own)
        ]

    chosen = [case for case in cases(config) if case.name == AS_CONFIGURED]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study_of_effects, "variants", listed)
        patch.setattr(study_of_validity, "cases", lambda _: chosen)
        return {"effects": effects(config, number=5), "validity": validity(config, number=3)}
