"""The report: a run as one page that a person can look at."""
