"""A lab's own spectra: the files of spectrometers, and what is made of their counts."""
