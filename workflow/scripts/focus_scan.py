"""Stage focus_scan: intensity and detected rays over the focus, for one diameter."""

from job import count_points, job

from octsim.datasets import write
from octsim.focus import focus_scan

with job(snakemake) as config:
    scan = focus_scan(config, snakemake.threads)
    write(scan, snakemake.output[0])
    count_points(snakemake, scan)
