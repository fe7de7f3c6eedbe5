"""Rounding at the extremes, against 50 digits."""
