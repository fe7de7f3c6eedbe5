"""What an edit makes anew: nothing that does not follow from the code that was edited."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from octsim.datasets.code import figures_code
from octsim.datasets.stage import Figure

ROOT = Path(__file__).parents[2]
KERNELS = (
    "octsim.tracing.kernel", "octsim.schemes.field_sum", "octsim.schemes.paths.integrate",
    "octsim.schemes.paths.path_sum",
)  # fmt: skip
DIGESTS = f"""
import json
from octsim.base.provenance import source_digest
from octsim.config.load import load_config
from octsim.datasets.catalog import TARGETS
from octsim.datasets.code import code_of
from octsim.datasets.keys import stages_of
def all_of(config):
    return (*stages_of(config), *TARGETS)
found = {{name: source_digest(name) for name in {KERNELS}}}
for scheme in ("vogel", "paths"):
    config = load_config({{"tracing": {{"scheme": scheme}}}})
    found |= {{f"{{scheme}} {{stage}}": code_of(stage, config) for stage in all_of(config)}}
config = load_config({{"processing": {{"estimator": "maximum_likelihood"}}}})
found |= {{f"model {{stage}}": code_of(stage, config) for stage in all_of(config)}}
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def changed(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., set[str]]:
    """Return what an edit of files of the package changes: machine code, and stages by scheme."""
    tmp_path = tmp_path_factory.mktemp("code")
    skipped = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "octsim", tmp_path / "octsim", ignore=skipped)

    def digests() -> dict[str, str]:
        code = f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n{DIGESTS}"
        command = [sys.executable, "-c", code]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        found: dict[str, str] = json.loads(done.stdout)
        return found

    before = digests()

    def changed(*names: str) -> set[str]:
        files = [tmp_path / "octsim" / name for name in names]
        texts = [file.read_text(encoding="utf-8") for file in files]
        for file, text in zip(files, texts, strict=True):
            file.write_text(f"{text}\nEDITED = 1\n", encoding="utf-8")
        after = digests()
        for file, text in zip(files, texts, strict=True):
            file.write_text(text, encoding="utf-8")
        return {one for one in before if before[one] != after[one]}

    return changed


def test_what_no_number_follows_from_retraces_and_compiles_nothing(
    changed: Callable[..., set[str]],
) -> None:
    names = (
        "config/archive.py", "cli/main.py", "cli/cache.py", "archive/pack.py", "archive/compare.py",
        "figures/style.py", "figures/phase_slope.py", "instrument/points.py",
        "instrument/point_store.py", "stages/progress.py", "stages/cost_estimate.py",
        "datasets/catalog.py", "datasets/catalog_of_thesis.py", "datasets/gallery.py",
        "schemes/table.py", "schemes/cost.py",
    )  # fmt: skip
    assert changed(*names) == set()


@pytest.mark.parametrize("name", ["schemes/paths/refine.py", "schemes/paths/scheme.py"])
def test_an_edit_of_the_scheme_paths_touches_no_run_by_counted_rays(
    changed: Callable[..., set[str]], name: str
) -> None:
    found = changed(name)
    beside = {
        "stability", "tradeoff", "validity", "causes", "estimators", "calibration",
        "action_potential", "detector", "effects", "diffraction", "interferometers", "responses",
        "scenes", "match",
    }  # fmt: skip
    assert {one for one in found if one.startswith("vogel")} == {f"vogel {n}" for n in beside}
    assert {"paths detections", "paths focus_sweep", "paths focus_scan", "paths spectra"} <= found
    assert not {"octsim.tracing.kernel", "octsim.schemes.field_sum"} & found
    # whose estimator compares with spectra by light paths
    run = {one for one in found if one.startswith("model")} - {f"model {n}" for n in beside}
    assert run == {"model fourier", "model phase_slope", "model measured"}


def test_an_edit_of_a_stage_touches_that_stage_alone(changed: Callable[..., set[str]]) -> None:
    assert changed("stages/gaussian_fits.py") == {
        f"{scheme} {stage}"
        for scheme in ("vogel", "paths", "model")
        # the law reads how the fits ended, and who follows the law reads the law
        for stage in (
            "gaussian_fits", "focus_law", "detections", "spectra", "paths", "causes",
            "estimators", "calibration", "action_potential", "tradeoff", "design", "validity",
            "detector", "effects", "responses", "scenes", "match",
        )
    }  # fmt: skip


def test_an_edit_of_what_writes_files_makes_all_anew(changed: Callable[..., set[str]]) -> None:
    found = changed("datasets/writer.py")
    assert {"vogel focus_scan", "vogel phase_slope", "paths spectra", "vogel calibration"} <= found
    assert not set(KERNELS) & found


def test_figures_follow_from_what_draws_them_and_from_their_captions() -> None:
    def drawn(*modules: str, caption: str = "Phases.") -> str:
        return figures_code(
            *(Figure("a", f"octsim.figures.{module}:draw", caption) for module in modules)
        )

    one = drawn("focus_scan")
    assert len({one, drawn("focus_law"), drawn("focus_scan", "focus_law")}) == 3
    code, caption = drawn("focus_scan", caption="Slopes.").split()
    assert code == one.split()[0]
    assert caption != one.split()[1]
