"""Spectra to phases: transform, estimators, noise, measured data."""
