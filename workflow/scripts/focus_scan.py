"""Stage focus_scan: intensity and detected rays over the focus, for one diameter."""

from job import job, points

from octsim.focus import focus_scan
from octsim.netcdf import write_stream
from octsim.progress import watched

with job(snakemake) as config, points(snakemake, config) as whence:
    scan = focus_scan.stream(config, snakemake.threads, whence)
    write_stream(watched(scan), snakemake.output[0])
