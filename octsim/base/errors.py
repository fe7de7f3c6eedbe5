"""What octsim says when something is not as it must be: one clear line, for a person."""


class OctsimError(Exception):
    """Something a user can put right; its text says what, where and how."""


class ConfigError(OctsimError):
    """The config cannot be used; a line for each problem."""


class DatasetError(OctsimError):
    """A stored dataset is missing, damaged or not what it should be."""


def not_installed(library: str, extra: str) -> OctsimError:
    """Return the error of a library that is missing, as it is one of an extra of the package."""
    return OctsimError(f"{library} is not installed; run: pip install 'octsim[{extra}]'")


class OctsimWarning(UserWarning):
    """Something that a user should know but that stops nothing."""


class FileError(OctsimError):
    """A file can't be written."""


class CacheError(OctsimError):
    """A folder is no point cache, or not one that this octsim reads, or can't be cleared."""


class ArchiveError(OctsimError):
    """A run can't be packed, or an archive is not what was packed; a line for each problem."""
