"""Estimators of the phase compared."""
