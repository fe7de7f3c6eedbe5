"""Readers of each kind of file, and what they share."""
