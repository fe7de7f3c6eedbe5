"""Target archive: a run as one file, for a data repository."""

import logging
import sys
from pathlib import Path

from job import job

from octsim.archive.pack import pack

with job(snakemake) as config:
    file = Path(snakemake.output[0])
    packed = pack(file.parent, config, file)
    for remark in packed.remarks:
        logging.warning("octsim: warning: %s", remark)
        print(f"octsim: warning: {remark}", file=sys.stderr)
    logging.info("%s", packed)
