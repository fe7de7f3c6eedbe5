"""What the detector's falloff and radius do: jumps by edge rays, scatter, signal, and Maxwell's."""
