"""Stage focus_sweep: intensity over the focus, for the diameters of the focus law."""

from job import job, points

from octsim.focus import focus_sweep
from octsim.netcdf import write_stream
from octsim.progress import watched

with job(snakemake) as config, points(snakemake, config) as whence:
    sweep = focus_sweep.stream(config, snakemake.threads, whence)
    write_stream(watched(sweep), snakemake.output[0])
