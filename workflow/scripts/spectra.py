"""Stage spectra: the spectrum of each diameter, from its detected rays."""

from job import job

from octsim.datasets import read, write
from octsim.sweep import spectra

with job(snakemake) as config:
    detected = read(snakemake.input.detections, "detections", config)
    write(spectra(config, detected, snakemake.threads), snakemake.output[0])
