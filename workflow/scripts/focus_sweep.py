"""Stage focus_sweep: intensity over the focus, for the diameters of the focus law."""

from job import job, trace

from octsim.stages.focus_sweep import focus_sweep

with job(snakemake) as config:
    threads = snakemake.threads
    trace(
        snakemake, config, lambda whence, share: focus_sweep.stream(config, threads, whence, share)
    )
