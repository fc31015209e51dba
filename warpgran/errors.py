"""Errors that a user can cause and mend. Rooms add their own: CaseError, StorageError, DeviceError, ClusterError."""


class WarpgranError(Exception):
    """The base of them all. The text says what is wrong and what is allowed, a line each."""


class OptionError(WarpgranError, ValueError):
    """An option or argument that is not known, or out of range."""


class ResultError(WarpgranError, ValueError):
    """A result does not hold what is asked of it."""
