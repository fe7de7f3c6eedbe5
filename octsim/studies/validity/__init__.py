"""How far light by rays is from that by Maxwell's equations, over what an instrument may be."""
