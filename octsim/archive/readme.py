"""What an archive says of itself to people: its README.md."""

from collections.abc import Sequence
from importlib.metadata import version

from octsim.archive.contents import (
    METADATA,
    ORCID,
    README,
    Item,
    description_of,
    origins_of,
    title_of,
)
from octsim.config.archive import ArchiveConfig, Creator
from octsim.config.models import Config


def readme(items: Sequence[Item], config: Config) -> Item:
    """Return the README.md of an archive.

    Parameters
    ----------
    items : sequence of Item
        What else is in the archive, but for what follows from it.
    config : Config
        The config that is archived.
    """
    given = config.archive
    about = {item.name: item.about for item in items}
    about |= {README: _ABOUT, METADATA: "metadata of this archive (RO-Crate)"}
    text = _README.format(
        title=title_of(config),
        description=description_of(given),
        creators=_creators(given),
        license=given.license,
        published=f", published {given.date}" if given.date else "",
        rows="".join(f"| `{name}` | {about[name]} |\n" for name in sorted(about)),
        versions=" and ".join(
            sorted({origin.octsim_version for origin in origins_of(items).values()})
        ),
        version=version("octsim"),
        run=config.run,
    )
    return Item(README, _ABOUT, text.encode(), "text/markdown")


def _creators(given: ArchiveConfig) -> str:
    lines = [f"- {_creator(one)}\n" for one in given.creators]
    return "".join([*lines, "\n"] if lines else [])


def _creator(one: Creator) -> str:
    orcid = f"{ORCID}{one.orcid}" if one.orcid else None
    return ", ".join(part for part in (one.name, one.affiliation, orcid) if part)


_ABOUT = "what each file is"
_README = """# {title}

{description}

{creators}Licence: {license}{published}.

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
