"""Runs found, compared, packed, verified."""
