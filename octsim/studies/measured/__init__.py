"""A lab's own spectra, in octsim's form."""
