"""Stages spectra and paths: the spectrum of each diameter, and what each light path has in it."""

import logging

from job import job

from octsim.datasets import read, write
from octsim.shares import light_paths
from octsim.sweep import spectra, unreached

with job(snakemake) as config:
    detected = read(snakemake.input.detections, "detections", config)
    measured = spectra(config, detected, snakemake.threads)
    if said := unreached(measured):
        logging.warning("octsim: warning: %s", said)
    write(measured, snakemake.output.spectra)
    write(light_paths(config, detected), snakemake.output.paths)
