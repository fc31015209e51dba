"""Errors that a user can cause and mend. Rooms add their own, such as CaseError and StorageError."""


class WarpgranError(Exception):
    """Base of every error that a user can cause. The text says what is wrong and what is allowed, a line a problem."""


class CaveatWarning(UserWarning):
    """A case with a value that is unlikely, or a result that holds with a reserve; the text says which."""


class OptionError(WarpgranError, ValueError):
    """An option or argument is unknown or out of range."""


class ResultError(WarpgranError, ValueError):
    """A result does not hold what was asked for."""
