"""Ray tracing of optical coherence tomography of a neuron, from rays to the phase slope.

The names of `__init__.pyi` are what a notebook needs; each is loaded when it is first used.
"""

from importlib.metadata import version

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__version__ = version("octsim")
