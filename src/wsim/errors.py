"""Errors that are a user's to mend."""


class UserError(Exception):
    """A mistake in what the user gave: one clear line with what to do next. The command line exits with 2."""
