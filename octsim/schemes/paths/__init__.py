"""The scheme paths: each light path integrated over the aperture, to a stated accuracy."""
