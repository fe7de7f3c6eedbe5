"""Maxwell's equations for a cylinder over a plane, in partial waves."""
