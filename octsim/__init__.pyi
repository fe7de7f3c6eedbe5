from .calibrate import calibration as calibration
from .config import Config as Config
from .datasets import read as read
from .errors import CacheError as CacheError
from .errors import ConfigError as ConfigError
from .errors import DatasetError as DatasetError
from .errors import FileError as FileError
from .errors import OctsimError as OctsimError
from .errors import OctsimWarning as OctsimWarning
from .estimation import phase_of as phase_of
from .firing import action_potential as action_potential
from .focus import focus_scan as focus_scan
from .focus import focus_sweep as focus_sweep
from .grid import combinations as combinations
from .law import focus_law as focus_law
from .law import gaussian_fits as gaussian_fits
from .loading import load_config as load_config
from .measured import read_spectra as read_spectra
from .nanometres import expansion as expansion
from .nanometres import series_expansion as series_expansion
from .phase import fourier as fourier
from .phase import phase_slope as phase_slope
from .series import read_series as read_series
from .shares import light_paths as light_paths
from .sweep import detections as detections
from .sweep import spectra as spectra

__version__: str
