"""What an environment refuses, by name."""


class BadActionError(ValueError):
    """An action of wrong shape, or with a value that is no number or out of range; nothing was advanced."""


class BadOptionError(ValueError):
    """An unknown option of ``reset``, or a value that is not allowed; the episode before it has ended all the same."""


class BadStateError(ValueError):
    """A saved state that belongs to another environment."""
