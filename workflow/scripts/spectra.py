"""Stages spectra and paths: the spectrum of each diameter, and what each light path has in it."""

import logging

from job import job

from octsim.datasets.files import opened
from octsim.datasets.writer import write_stream
from octsim.stages.paths import light_paths
from octsim.stages.progress import watched
from octsim.stages.spectra import doubts, spectra

with job(snakemake) as config:
    with opened(snakemake.input.detections, "detections", config) as detected:
        summed = spectra.stream(config, detected, snakemake.threads)
        write_stream(watched(summed), snakemake.output.spectra)
        write_stream(watched(light_paths.stream(config, detected)), snakemake.output.paths)
    with opened(snakemake.output.spectra, "spectra", config) as measured:
        for said in doubts(measured):
            logging.warning("octsim: warning: %s", said)
