"""Stages gaussian_fits and focus_law: the focus of greatest intensity over the diameter."""

from job import job

from octsim.datasets import read, write
from octsim.law import focus_law, gaussian_fits

with job(snakemake) as config:
    fits = gaussian_fits(config, read(snakemake.input.focus_sweep, "focus_sweep", config))
    write(fits, snakemake.output.gaussian_fits)
    write(focus_law(config, fits), snakemake.output.focus_law)
