"""Stages fourier and phase_slope: from spectra to the change of their phase with the diameter."""

import logging

from job import job

from octsim.datasets import read, write
from octsim.phase import fourier, phase_slope, summary

with job(snakemake) as config:
    transformed = fourier(config, read(snakemake.input.spectra, "spectra", config))
    write(transformed, snakemake.output.fourier)
    slopes = phase_slope(config, transformed)
    write(slopes, snakemake.output.phase_slope)
    logging.info("%s", summary(slopes))
