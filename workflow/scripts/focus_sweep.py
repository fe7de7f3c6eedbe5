"""Stage focus_sweep: intensity over the focus, for the diameters of the focus law."""

from job import count_points, job

from octsim.datasets import write
from octsim.focus import focus_sweep

with job(snakemake) as config:
    sweep = focus_sweep(config, snakemake.threads)
    write(sweep, snakemake.output[0])
    count_points(snakemake, sweep)
