"""Ground: errors, whole files, compiled code, provenance, threads."""
