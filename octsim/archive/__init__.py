"""Runs found, compared, packed, verified, reproduced."""
