"""How well rays that are defocused on purpose have the diffraction limit, beside the real thing."""
