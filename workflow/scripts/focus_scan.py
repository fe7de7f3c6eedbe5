"""Stage focus_scan: intensity and detected rays over the focus, for one diameter."""

from job import job, trace

from octsim.stages.focus_scan import focus_scan

with job(snakemake) as config:
    threads = snakemake.threads
    trace(
        snakemake, config, lambda whence, share: focus_scan.stream(config, threads, whence, share)
    )
