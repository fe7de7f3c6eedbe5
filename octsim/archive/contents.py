"""What stands in a run's archive, and what each file of it is."""

import json
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import netCDF4
import yaml

from octsim.archive.run_folder import FIGURES, Run
from octsim.base.environment import environment
from octsim.base.provenance import LOCK, lock_file
from octsim.config.models import Config
from octsim.datasets.catalog import STAGES, TARGETS
from octsim.datasets.gallery import CAPTIONS, drawn_with, figures_of
from octsim.datasets.versions import printable, recorded_environment

CONFIG = "config.yaml"
ENVIRONMENT = "environment.json"
README = "README.md"
_FORMS = {".png": "image/png", ".svg": "image/svg+xml"}


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
    stages: tuple[str, ...] = ()
    """Stages whose datasets a figure is drawn from."""


class Made(NamedTuple):
    """What a dataset records of its making."""

    octsim_version: str
    schema_version: int
    source_digest: str
    environment: Mapping[str, str] | None
    """None of a file of octsim 0.1.0."""


def figures_expected(run: Run, config: Config) -> dict[str, tuple[str, ...]]:
    """Give the figures of a run and of the targets whose datasets it has, and their stages."""
    beside = {
        name: drawn.sources
        for target in TARGETS
        if target in run.datasets
        for name, drawn in drawn_with(target).items()
    }
    return figures_of(config) | beside


def items(run: Run, config: Config) -> tuple[list[Item], dict[str, Made]]:
    """Give the files of a run's archive but for those that describe it, and how its data was made.

    Parameters
    ----------
    run : Run
        The run.
    config : Config
        The config that is archived with it.
    """
    found: list[Item] = []
    made: dict[str, Made] = {}
    for stage, file in run.datasets.items():
        with netCDF4.Dataset(file) as dataset:
            recorded = {name: dataset.getncattr(name) for name in dataset.ncattrs()}
            measured = tuple(
                f"{name} ({getattr(one, 'units', '1')})" for name, one in dataset.variables.items()
            )
        made[stage] = _made(recorded)
        about = printable(recorded.get("title", stage))
        found.append(Item(f"{stage}.nc", about, file, "application/x-netcdf", measured))
    expected = figures_expected(run, config)
    for file in run.figures:
        if file.stem in expected and file.suffix in _FORMS:
            drawn = tuple(stage for stage in expected[file.stem] if stage in run.datasets)
            about, form = CAPTIONS[file.stem], _FORMS[file.suffix]
            found.append(Item(f"{FIGURES}/{file.name}", about, file, form, stages=drawn))
    plain = {"archive": config.to_dict()["archive"]} | config.to_record()
    text = yaml.safe_dump(plain, sort_keys=True, allow_unicode=True)
    found.append(Item(CONFIG, "config of the run, every key", text.encode(), "application/yaml"))
    lock = lock_file()
    if lock:
        about = f"versions that octsim {version('octsim')} is installed with, pinned with hashes"
        found.append(Item(LOCK, about, lock, "text/plain"))
    told = json.dumps({stage: one._asdict() for stage, one in made.items()}, indent=2) + "\n"
    about = "of each dataset: version of octsim, digest of its sources, libraries, processor"
    found.append(Item(ENVIRONMENT, about, told.encode(), "application/json"))
    return found, made


def remarks(run: Run, config: Config, holds: list[Item], made: Mapping[str, Made]) -> list[str]:
    """Say what a reader may miss in an archive of a run, a line each."""
    packed = {item.name for item in holds}
    drawn = {Path(name).stem for name in packed if name.startswith(f"{FIGURES}/")}
    missing = [f"{stage}.nc" for stage in STAGES if stage not in run.datasets]
    missing += [f"{FIGURES}/{name}" for name in figures_expected(run, config) if name not in drawn]
    folder = next(iter(run.datasets.values())).parent
    beside = [*folder.glob("*.nc"), *(folder / FIGURES).glob("*")]
    names = {file.relative_to(folder).as_posix() for file in beside if file.name[0] != "."}
    left = sorted(names - packed)
    elsewhere = [stage for stage, one in made.items() if one.environment != environment()]
    said = []
    if missing:
        said.append(f"the archive goes without {', '.join(missing)}, which are not made")
    if left:
        said.append(f"left out, as no datasets or figures of this run: {', '.join(left)}")
    if not lock_file():
        said.append(f"the archive goes without {LOCK}, which stands in a checkout of octsim alone")
    elif elsewhere:
        said.append(
            f"{LOCK} is this octsim's, but {', '.join(elsewhere)} was computed with other "
            f"libraries or on another processor ({ENVIRONMENT} tells)"
        )
    return said


def readme(
    title: str, described: str, holds: list[Item], made: Mapping[str, Made], config: Config
) -> str:
    """Write what an archive's README.md says."""
    given = config.archive
    people = [
        ", ".join(
            part for part in (one.name, one.affiliation, one.orcid and _ORCID + one.orcid) if part
        )
        for one in given.creators
    ]
    by = "".join(f"- {person}\n" for person in people) + ("\n" if people else "")
    rows = "".join(f"| `{item.name}` | {item.about} |\n" for item in sorted(holds))
    versions = sorted({one.octsim_version for one in made.values()})
    return _README.format(
        title=title, described=described, rows=rows, versions=" and ".join(versions),
        version=version("octsim"), run=config.run, by=by, license=given.license,
        published=f", published {given.date}" if given.date else "",
    )  # fmt: skip


def _made(recorded: Mapping[str, Any]) -> Made:
    return Made(
        printable(recorded.get("octsim_version", "")),
        int(recorded.get("schema_version", 0)),
        printable(recorded.get("source_digest", "")),
        recorded_environment(recorded),
    )


_ORCID = "https://orcid.org/"
_README = """# {title}

{described}

{by}Licence: {license}{published}.

| file | what it is |
| --- | --- |
{rows}| `SHA256SUMS` | SHA-256 of every file but itself |

Made by octsim {versions}.

## Check it

In the folder of these files, with nothing but coreutils:

```sh
sha256sum -c SHA256SUMS
```

or with octsim, which finds additional files too: `octsim verify` and the folder or the zip.

## Read it

Datasets are netCDF-4 after the CF conventions; each variable has its unit and meaning.

```python
import xarray

dataset = xarray.open_dataset("phase_slope.nc")
```

`config.yaml` is the whole config; `octsim.load_config("config.yaml")` reads it.
`ro-crate-metadata.json` describes all of this for machines (RO-Crate).

## Make it again

In a checkout of octsim {version}, which packed this and whose libraries `requirements.lock` pins:

```sh
make reproduce FILE={run}.zip INTO=again
```

It takes the config that the datasets record, makes them anew and names what differs;
`environment.json` has what each was computed with.
"""
