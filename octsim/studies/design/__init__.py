"""Which fill, focus, aperture, band and estimator know an expansion best (`snakemake design`)."""
