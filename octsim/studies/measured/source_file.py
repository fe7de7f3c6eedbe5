"""The source of a lab's spectra as a file that the config's `spectrum.source` reads."""

from pathlib import Path

import numpy as np

from octsim.base.errors import ConfigError
from octsim.base.files import whole
from octsim.config.models import Config
from octsim.measured.axis import Axis, axis_of
from octsim.measured.background import lit, without_sample
from octsim.studies.measured.study import opened


def write_source(config: Config, path: Path) -> None:
    """Write the power of ``measured.reference``, without the dark, at all that a spectrometer sees.

    Parameters
    ----------
    config : Config
    path : path
        Of a CSV file, with columns wavelength (nm) and power, over its largest.

    Raises
    ------
    OctsimError
        If there is no reference, it can't be read, or the file can't be written.
    """
    if config.measured.reference is None:
        raise ConfigError(
            "measured.reference: not given, and --source is written from it; give the file with "
            "the source's own spectra"
        )
    with opened(config) as recording:
        k = axis_of(recording, config.measured.axis)
        order = np.argsort(k)
        dark, reference = without_sample(config.measured, k.size, Axis(k[order], order))
    assert reference is not None
    net, largest = lit(reference, dark)
    columns = np.column_stack([2e3 * np.pi / k[order], np.maximum(net, 0) / largest])[::-1]
    with whole(path) as file:
        np.savetxt(file, columns, "%.9g", ",", header="wavelength (nm),power", comments="")
