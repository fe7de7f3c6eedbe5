"""Rays through a scene: faces, blocks of rays, the tree, light paths."""
