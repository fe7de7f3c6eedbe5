"""Stage detections: the rays that reach the detector, for each diameter of the sweep."""

from job import job, points

from octsim.datasets import read
from octsim.netcdf import write_stream
from octsim.progress import watched
from octsim.sweep import detections

with job(snakemake) as config, points(snakemake, config) as whence:
    law_file = snakemake.input.get("focus_law", config)
    law = read(law_file, "focus_law", config) if law_file else None
    detected = detections.stream(config, law, snakemake.threads, whence)
    write_stream(watched(detected), snakemake.output[0])
