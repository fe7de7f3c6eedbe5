"""Stages gaussian_fits and focus_law: the focus of greatest intensity over the diameter."""

from job import job

from octsim.datasets.files import opened, read
from octsim.datasets.writer import write_stream
from octsim.stages.focus_law import focus_law
from octsim.stages.gaussian_fits import gaussian_fits
from octsim.stages.progress import watched

with job(snakemake) as config:
    fits_file = snakemake.output.gaussian_fits
    with opened(snakemake.input.focus_sweep, "focus_sweep", config) as sweep:
        write_stream(watched(gaussian_fits.stream(config, sweep)), fits_file)
    fits = read(fits_file, "gaussian_fits", config)
    write_stream(focus_law.stream(config, fits), snakemake.output.focus_law)
