"""Datasets beside a run: what accuracy costs, what the slope is made of, the calibration."""
