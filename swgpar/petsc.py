"""The one place where PETSc is initialised: `from swgpar.petsc import PETSc`.

PETSc by itself reads the files .petscrc and petscrc of the working directory, and .petscrc of the home directory. What
they name is executed. None of them is read here: only options of the command line, the files that these name, and
the options of the environment variable PETSC_OPTIONS as far as they name no file.
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

from swgpar.errors import InputError

if TYPE_CHECKING:
    from petsc4py import PETSc as PETSc

NO_FILES = ("-skip_petscrc", "1")
"""Arguments that keep PETSc from reading files that nobody named; the last one of a name counts."""

FILES = ("-options_file", "-options_file_yaml")
"""Options with the name of a file of options."""

LIBRARIES = ("-dll_prepend", "-dll_append")
"""Options with the name of a library that PETSc executes."""

VARIABLES = ("PETSC_OPTIONS", "PETSC_OPTIONS_YAML")
"""Environment variables that PETSc reads."""


def start(arguments: Sequence[str] = ()) -> None:
    """Initialise PETSc on all ranks with options of the command line; collective. Without effect when it has been.

    Raises InputError, on all ranks, when an option names a file that cannot be read or PETSC_OPTIONS names one at all.
    """
    import petsc4py

    words = MPI.COMM_WORLD.bcast(_words(arguments) if MPI.COMM_WORLD.rank == 0 else None)
    if isinstance(words, InputError):
        raise words
    hidden = {name: os.environ.pop(name) for name in VARIABLES if name in os.environ}
    try:
        petsc4py.init(["swgpar", *_without_files(words), *NO_FILES])
    finally:
        os.environ.update(hidden)
    from petsc4py import PETSc

    if any(_is_one_of(word, FILES) for word in words):
        try:
            PETSc.Options().insertString(" ".join(f"'{word}'" if '"' in word else f'"{word}"' for word in words))
        except PETSc.Error as error:
            raise InputError(f"options of PETSc: {reason(error)}") from None


def reason(error: Exception) -> str:
    """Last line of an error of PETSc, without the rank."""
    return str(error).splitlines()[-1].partition("] ")[2] or str(error)


def _words(arguments: Sequence[str]) -> list[str] | InputError:
    """Options of PETSC_OPTIONS, then those of the command line; or why they are refused."""
    try:
        given = shlex.split(os.environ.get(VARIABLES[0], ""))
    except ValueError as error:
        return InputError(f"{VARIABLES[0]} cannot be read: {error}")
    for word in given:
        if _is_one_of(word, (*FILES, *LIBRARIES)):
            return InputError(f"{VARIABLES[0]} holds {word}: files are named on the command line only")
    if VARIABLES[1] in os.environ:
        return InputError(f"{VARIABLES[1]} is not read: give its options on the command line, and unset it")
    for word, name in zip(arguments, [*arguments[1:], ""]):
        if _is_one_of(word, FILES) and not os.access(name, os.R_OK):
            return InputError(f"{word} {name}: there is no such file that can be read")
    return [*given, *arguments]


def _without_files(words: Sequence[str]) -> list[str]:
    """Options without those that name files of options: PETSc reports their errors well only once it has started."""
    after_file = [False, *(_is_one_of(word, FILES) for word in words)]
    return [word for word, skipped in zip(words, after_file) if not skipped and not _is_one_of(word, FILES)]


def _is_one_of(word: str, names: Sequence[str]) -> bool:
    return word.lower() in names  # as PETSc compares them


def __getattr__(name: str) -> Any:
    """PETSc is initialised with the first import of its name."""
    if name != "PETSc":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    start()
    from petsc4py import PETSc

    globals()["PETSc"] = PETSc
    return PETSc
