"""One module for each dataset of a run."""
