"""Light of one point: the thesis's counted rays, or light paths to an accuracy."""
