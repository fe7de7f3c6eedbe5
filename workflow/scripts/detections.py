"""Stage detections: the rays that reach the detector, for each diameter of the sweep."""

from job import fitted_law, job, trace

from octsim.stages.detections import detections

with job(snakemake) as config:
    law, threads = fitted_law(snakemake, config), snakemake.threads
    trace(
        snakemake, config,
        lambda whence, share: detections.stream(config, law, threads, whence, share),
    )  # fmt: skip
