"""Ray tracing of optical coherence tomography of a neuron, from rays to the phase slope.

The names below are what a notebook needs; each is loaded when it is first used.
"""

from importlib import import_module

_HOME = {
    "Config": "config",
    "ConfigError": "errors",
    "DatasetError": "errors",
    "OctsimError": "errors",
    "OctsimWarning": "errors",
    "detections": "sweep",
    "focus_law": "focus",
    "focus_scan": "focus",
    "focus_sweep": "focus",
    "fourier": "phase",
    "gaussian_fits": "focus",
    "load_config": "loading",
    "phase_slope": "phase",
    "spectra": "sweep",
}

__all__ = sorted(_HOME)  # noqa: PLE0605


def __getattr__(name: str) -> object:
    if name in _HOME:
        return getattr(import_module(f"octsim.{_HOME[name]}"), name)
    raise AttributeError(f"module 'octsim' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
