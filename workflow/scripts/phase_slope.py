"""Stages fourier and phase_slope: from spectra to the change of their phase with the diameter."""

import logging

from job import job

from octsim.datasets.files import opened
from octsim.datasets.writer import write_stream
from octsim.stages.fourier import fourier
from octsim.stages.phase_slope import phase_slope, summary
from octsim.stages.progress import watched

with job(snakemake) as config:
    with opened(snakemake.input.spectra, "spectra", config) as spectra:
        write_stream(watched(fourier.stream(config, spectra)), snakemake.output.fourier)
    with opened(snakemake.output.fourier, "fourier", config) as transformed:
        slopes = phase_slope.stream(config, transformed)
        write_stream(watched(slopes), snakemake.output.phase_slope)
    with opened(snakemake.output.phase_slope, "phase_slope", config) as found:
        logging.info("%s", summary(found))
