"""What all tests share."""

from hypothesis import settings

# The same draws every time: a failure on a contributor's machine is a failure on every machine.
settings.register_profile("octsim", derandomize=True, deadline=None)
settings.load_profile("octsim")
