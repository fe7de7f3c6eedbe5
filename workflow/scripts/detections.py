"""Stage detections: the rays that reach the detector, for each diameter of the sweep."""

from job import count_points, job

from octsim.datasets import read, write
from octsim.sweep import detections

with job(snakemake) as config:
    law_file = snakemake.input.get("focus_law", config)
    law = read(law_file, "focus_law", config) if law_file else None
    detected = detections(config, law, snakemake.threads)
    write(detected, snakemake.output[0])
    count_points(snakemake, detected)
