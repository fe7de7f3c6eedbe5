"""What stands in a run's archive, and what each file of it is."""

import json
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import netCDF4
import yaml

from octsim.archive.origin import Origin, origin_of
from octsim.archive.report_file import REPORT, SHOWN, is_report_of
from octsim.archive.run_folder import FIGURES, Run
from octsim.base.errors import one_line
from octsim.base.provenance import LOCK, environment, lock_file
from octsim.config.archive import ArchiveConfig
from octsim.config.models import Config
from octsim.datasets.catalog import TARGETS
from octsim.datasets.files import guarded
from octsim.datasets.gallery import ANIMATION, CAPTIONS, FORMS, drawn_with, figures_of
from octsim.datasets.keys import stages_of

CONFIG = "config.yaml"
ENVIRONMENT = "environment.json"
README = "README.md"
METADATA = "ro-crate-metadata.json"
ORCID = "https://orcid.org/"
_DESCRIPTION = (
    "Simulated optical coherence tomography of a neuron: by ray tracing, from a microscope "
    "objective and a cylinder on a glass slide to the phase slope, the change of phase with "
    "diameter."
)


class Item(NamedTuple):
    """A file of an archive."""

    name: str
    about: str
    """What it is, in a line."""
    source: Path | bytes
    """Where it stands, or what it holds."""
    form: str
    """Media type."""
    variables: tuple[str, ...] = ()
    """What a dataset holds, with units."""
    origin: Origin | None = None
    """What a dataset was made with."""
    stages: tuple[str, ...] = ()
    """Stages whose datasets a figure is drawn from."""


def title_of(config: Config) -> str:
    """Return the title of a run's archive."""
    return config.archive.title or f"octsim run {config.run}"


def description_of(given: ArchiveConfig) -> str:
    """Return the description of a run's archive."""
    return given.description or _DESCRIPTION


def origins_of(items: Iterable[Item]) -> dict[str, Origin]:
    """Return what each dataset was made with, by stage."""
    return {item.name.removesuffix(".nc"): item.origin for item in items if item.origin}


def items_of(run: Run, config: Config) -> list[Item]:
    """Return the files of a run's archive but for those that describe it.

    Parameters
    ----------
    run : Run
        The run.
    config : Config
        The config that is archived with it.
    """
    datasets = [_dataset(stage, file) for stage, file in run.datasets.items()]
    # the config without what no result depends on, and with what is said of the archive
    plain = {"archive": config.to_dict()["archive"]} | config.to_record()
    text = yaml.safe_dump(plain, sort_keys=True, allow_unicode=True)
    origins = {stage: origin._asdict() for stage, origin in origins_of(datasets).items()}
    lock = lock_file()
    return [
        *datasets,
        *_figures(run, config),
        *([] if config.grid.varied else _animation(run)),  # it is of a run without a grid
        *_report(run),
        Item(CONFIG, "config of the run, every key", text.encode(), "application/yaml"),
        Item(
            ENVIRONMENT,
            "of each dataset: version of octsim, digest of its sources, libraries, processor",
            f"{json.dumps(origins, indent=2)}\n".encode(),
            "application/json",
        ),
        *([Item(LOCK, _ABOUT_LOCK.format(version("octsim")), lock, "text/plain")] if lock else []),
    ]


_ABOUT_LOCK = "versions that octsim {} is installed with, pinned with hashes"


def _dataset(stage: str, file: Path) -> Item:
    with guarded(file), netCDF4.Dataset(file) as dataset:
        attributes = {name: dataset.getncattr(name) for name in dataset.ncattrs()}
        variables = tuple(
            one_line(f"{name} ({getattr(one, 'units', '1')})")
            for name, one in dataset.variables.items()
        )
    about = one_line(attributes.get("title", stage))
    form = "application/x-netcdf"
    return Item(f"{stage}.nc", about, file, form, variables, origin_of(attributes))


def _figures(run: Run, config: Config) -> list[Item]:
    stages = _stages_of_figures(run, config)
    return [
        Item(
            f"{FIGURES}/{file.name}", CAPTIONS[file.stem], file, FORMS[file.suffix[1:]],
            stages=tuple(stage for stage in stages[file.stem] if stage in run.datasets),
        )
        for file in run.figures
        if file.stem in stages and file.suffix[1:] in FORMS
    ]  # fmt: skip


def _animation(run: Run) -> list[Item]:
    """Return the animation of a run, if it was asked for."""
    name = f"{ANIMATION.name}.gif"
    stages = tuple(stage for stage in ANIMATION.of if stage in run.datasets)
    return [
        Item(f"{FIGURES}/{name}", ANIMATION.caption, file, "image/gif", stages=stages)
        for file in run.figures
        if file.name == name and stages
    ]


def _report(run: Run) -> list[Item]:
    """Return the report of a run, if it is there and shows the datasets as they are."""
    file = _folder_of(run) / REPORT
    if not file.is_file() or file.is_symlink() or not is_report_of(file, run):
        return []
    about = "the run as one page, to be looked at in a browser"
    stages = tuple(name for name in SHOWN if name in run.datasets)
    return [Item(REPORT, about, file, "text/html", stages=stages)]


def _folder_of(run: Run) -> Path:
    return next(iter(run.datasets.values())).parent


def _stages_of_figures(run: Run, config: Config) -> dict[str, tuple[str, ...]]:
    """Return the stages of each figure of a run, and of the targets whose datasets it has."""
    there: Mapping[str, tuple[str, ...]] = {
        name: drawn.sources
        for target in TARGETS
        if target in run.datasets
        for name, drawn in drawn_with(target).items()
    }
    return {**figures_of(config), **there}


def omissions(run: Run, config: Config, items: Iterable[Item]) -> list[str]:
    """Return what a reader may miss in the archive of a run, a line each."""
    packed = {item.name for item in items}
    drawn = {Path(name).stem for name in packed if name.startswith(f"{FIGURES}/")}
    missing = [f"{stage}.nc" for stage in stages_of(config) if stage not in run.datasets]
    missing += [
        f"{FIGURES}/{name}" for name in _stages_of_figures(run, config) if name not in drawn
    ]
    folder = _folder_of(run)
    beside = [*folder.glob("*.nc"), *(folder / FIGURES).glob("*")]
    names = {file.relative_to(folder).as_posix() for file in beside if file.name[0] != "."}
    left = sorted(names - packed)
    elsewhere = [
        stage for stage, one in origins_of(items).items() if one.environment != environment()
    ]
    lines = []
    if missing:
        lines.append(f"the archive goes without {', '.join(missing)}, which are not made")
    if (folder / REPORT).exists() and REPORT not in packed:
        lines.append(
            f"the archive goes without {REPORT}, which is of other datasets than these; make it "
            "again by octsim report"
        )
    if left:
        lines.append(f"left out, as no datasets or figures of this run: {', '.join(left)}")
    if not lock_file():
        lines.append(f"the archive goes without {LOCK}, which stands in a checkout of octsim alone")
    elif elsewhere:
        lines.append(
            f"{LOCK} is this octsim's, but {', '.join(elsewhere)} was computed with other "
            f"libraries or on another processor ({ENVIRONMENT} tells)"
        )
    return lines
