"""The exceptions a user sees: one sentence each, with the exit code of the command line."""

from __future__ import annotations

LONGEST = 1000
"""Letters of a sentence; what is longer holds keys or values of that size and is cut."""

SHOWN = 60
"""Letters of a key or a value in a sentence."""


def printable(text: str) -> str:
    """The text with escapes for what a terminal would not show as a letter: control characters,
    bytes without meaning.

    Files and arguments of a user may hold them. Line breaks stay.
    """
    return "".join(
        c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode() for c in text
    )


def shortened(text: str, longest: int = SHOWN) -> str:
    """The text, or its beginning and three points, with at most so many letters."""
    return text if len(text) <= longest else text[: longest - 3] + "..."


class SwgparError(Exception):
    """Any failure that swgpar reports as one sentence instead of a traceback.

    The sentence is printable, on one line and not longer than `LONGEST`.

    Attributes
    ----------
    exit_code : int
        Exit status of the ``swgpar`` command when this error ends it.
    """

    exit_code = 1

    def __init__(self, sentence: str) -> None:
        super().__init__(shortened(printable(" ".join(sentence.split("\n"))), LONGEST))


class InputError(SwgparError):
    """A design file, recipe, override or command line that cannot be used as given."""

    exit_code = 2


class ConvergenceError(SwgparError):
    """An increment that did not converge, after all permitted cut-backs."""

    exit_code = 3


class TimeLimitError(SwgparError):
    """A run whose time limit has passed, or which was stopped, at its last Newton iteration."""

    exit_code = 3


class OutOfMemoryError(SwgparError):
    """An allocation that failed.

    Attributes
    ----------
    alone : bool
        Whether one rank may have met it alone, for which the others then wait.
    """

    exit_code = 6
    alone = False


class StudyError(SwgparError):
    """A study that went through all its cases and could not finish some of them."""

    exit_code = 5


class OutputError(SwgparError):
    """A result, figure or checkpoint that could not be written or read back."""

    exit_code = 4
