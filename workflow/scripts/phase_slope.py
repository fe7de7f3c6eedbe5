"""Stages fourier and phase_slope: from spectra to the change of their phase with the diameter."""

from job import job

from octsim.datasets import read, write
from octsim.phase import fourier, phase_slope

with job(snakemake) as config:
    transformed = fourier(config, read(snakemake.input.spectra, "spectra"))
    write(transformed, snakemake.output.fourier)
    write(phase_slope(config, transformed), snakemake.output.phase_slope)
