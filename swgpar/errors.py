"""The exceptions a user sees: one sentence each, with the exit code of the command line."""

from __future__ import annotations


class SwgparError(Exception):
    """Any failure that swgpar reports as one sentence instead of a traceback.

    Attributes
    ----------
    exit_code : int
        Exit status of the ``swgpar`` command when this error ends it.
    """

    exit_code = 1


class InputError(SwgparError):
    """A design file, recipe, override or command line that cannot be used as given."""

    exit_code = 2


class ConvergenceError(SwgparError):
    """An increment that did not converge, after all permitted cut-backs."""

    exit_code = 3


class StudyError(SwgparError):
    """A study that went through all its cases and could not finish some of them."""

    exit_code = 5


class OutputError(SwgparError):
    """A result, figure or checkpoint that could not be written or read back."""

    exit_code = 4
