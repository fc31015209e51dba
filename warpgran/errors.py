"""Errors that a user can cause and mend. Rooms add their own, such as CaseError and StorageError."""


class WarpgranError(Exception):
    """Base of every error that a user can cause. The text says what is wrong and what is allowed, a line a problem."""


class OptionError(WarpgranError, ValueError):
    """An option or argument is unknown or out of range."""


class ResultError(WarpgranError, ValueError):
    """A result does not hold what was asked for."""
