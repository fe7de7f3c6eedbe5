"""What octsim says when something is not as it must be: one clear line, for a person."""


class OctsimError(Exception):
    """Something a user can put right; its text says what, where and how."""


class ConfigError(OctsimError):
    """The config cannot be used; a line for each problem."""


class DatasetError(OctsimError):
    """A stored dataset is missing, damaged or not what it should be."""


class OctsimWarning(UserWarning):
    """Something that a user should know but that stops nothing."""


class FileError(OctsimError):
    """A file can't be written."""


class CacheError(OctsimError):
    """A folder is no point cache, or not one that this octsim reads, or can't be cleared."""


class ArchiveError(OctsimError):
    """A run can't be packed, or an archive is not what was packed; a line for each problem."""
