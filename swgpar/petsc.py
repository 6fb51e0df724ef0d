"""The one place where PETSc is initialised: `from swgpar.petsc import PETSc`.

PETSc by itself reads the files .petscrc and petscrc of the working directory, and .petscrc of the
home directory. What they name is executed. None of them is read here: only options of the command
line, the files that these name, and the options of the environment variable PETSC_OPTIONS as far as
they name no file.
"""

from __future__ import annotations

import ctypes
import gc
import os
import re
import shlex
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI

from swgpar.errors import InputError, SwgparError, shortened
from swgpar.log import logger

if TYPE_CHECKING:
    from petsc4py import PETSc as PETSc

NO_FILES = "-skip_petscrc"
"""Argument that keeps PETSc from reading files that nobody named; the last one of a name counts."""

FILES = ("-options_file", "-options_file_yaml")
"""Options with the name of a file of options."""

LIBRARIES = ("-dll_prepend", "-dll_append")
"""Options with the name of a library that PETSc executes."""

VARIABLES = ("PETSC_OPTIONS", "PETSC_OPTIONS_YAML")
"""Environment variables that PETSc reads."""

ABOUT_OPTIONS = (56, 62, 63, 65, 83, 86, 92)
"""Error codes of PETSc (petscsystypes.h) that follow from options: not supported, wrong argument,
out of range, a file that cannot be opened, a user's error, an unknown type, no such package for a
factor."""

DECIDED = {
    "snes_max_it": "solver.max_iterations in the design file",
    "snes_rtol": "solver.rtol in the design file",
    **dict.fromkeys(
        ("snes_atol", "snes_stol", "snes_convergence_test", "snes_max_funcs"),
        "solver.rtol and solver.max_iterations in the design file",
    ),
}
"""Options without an effect, as the nonlinear solver has a convergence test of this program: what
there is in their place."""

NO_MEMORY = 55
"""Error code of PETSc for an allocation that failed."""

AT_END = ("citations", "get_total_flops", "mpidump", "options_left", "skip_petscrc")
"""Options that PETSc asks for when it ends, or that are always given."""

_given: set[str] = set()
"""Names of the options at the start."""

_warned_of: set[str] = set()


def release_unused(comm: MPI.Comm) -> None:
    """Release the models of runs that have ended: Python finds their references to one another only
    when it looks, and PETSc keeps what Python lets go of; collective."""
    gc.collect()
    if "PETSc" in globals():  # else it was never started
        globals()["PETSc"].garbage_cleanup(comm)


def start(arguments: Sequence[str] = ()) -> None:
    """Initialise PETSc once on all ranks with options of the command line; collective.

    Raises InputError, on all ranks, when an option names a file that cannot be read or
    PETSC_OPTIONS names one at all, and SwgparError without petsc4py.
    """
    try:
        import petsc4py
    except ModuleNotFoundError:
        raise SwgparError(
            "petsc4py is not installed: install the one of your system, or swgpar[wheels] with "
            "Python 3.12 or later"
        ) from None

    words = MPI.COMM_WORLD.bcast(_words(arguments) if MPI.COMM_WORLD.rank == 0 else None)
    if isinstance(words, InputError):
        raise words
    try:
        with hidden_variables(), _without_messages() as messages:
            petsc4py.init(["swgpar", *_without_files(words), NO_FILES])
            from petsc4py import PETSc
    except RuntimeError:  # PETSc.Error is one
        raise InputError(f"options of PETSc: {messages[0]}") from None
    except (ImportError, AttributeError) as error:
        raise SwgparError(
            f"petsc4py cannot be loaded with NumPy {np.__version__}: {str(error).splitlines()[0]}; "
            "one that was built for NumPy 1, as Debian's, needs numpy<2"
        ) from None

    with accepted_options(MPI.COMM_WORLD):
        if any(_is_one_of(word, FILES) for word in words):
            PETSc.Options().insertString(
                " ".join(f"'{word}'" if '"' in word else f'"{word}"' for word in words)
            )
    given = PETSc.Options().getAll()
    for name, instead in DECIDED.items():
        if name in given:
            raise InputError(
                f"options of PETSc: -{name} is not available, as the program decides when Newton's "
                f"method ends: allowed {instead}"
            )
    _given.update(given)
    # ranks that import it later, and not all together, do not start it again
    globals()["PETSc"] = PETSc


@contextmanager
def hidden_variables() -> Iterator[None]:
    """Hide the environment variables that PETSc reads inside the block."""
    hidden = {name: os.environ.pop(name) for name in VARIABLES if name in os.environ}
    try:
        yield
    finally:
        os.environ.update(hidden)


@contextmanager
def accepted_options(comm: MPI.Comm, *, all_errors: bool = False) -> Iterator[None]:
    """Run a block in which PETSc reads options; those refused are an InputError on all ranks.

    An error of PETSc that is not about options is raised as it is, unless `all_errors` says that
    options have led to it; what has no memory always is.
    """
    from petsc4py import PETSc

    failure: str | None = None
    try:
        yield
    except PETSc.Error as error:
        if is_out_of_memory(error) or not (all_errors or error.ierr in ABOUT_OPTIONS):
            raise
        text = re.split(r"^\[\d+\] ", str(error), flags=re.MULTILINE)[-1]
        values = PETSc.Options().getAll()
        named = [
            f"-{name} {values[name]}: "
            for name in sorted(_given & set(values))
            if (values[name] or "").lower() in text.lower().split()
        ]
        failure = "".join(named[:1]) + text
    reason = next((text for text in comm.allgather(failure) if text is not None), None)
    if reason is not None:
        raise InputError(f"options of PETSc: {reason}")


@contextmanager
def errors_of_callbacks() -> Iterator[None]:
    """Raise errors of Python callbacks as what they are: newer releases of PETSc wrap them."""
    from petsc4py import PETSc

    try:
        yield
    except PETSc.Error as error:
        cause: BaseException | None = error
        while cause and not isinstance(cause, SwgparError) and not is_out_of_memory(cause):
            cause = cause.__cause__ or cause.__context__
        if cause is None or cause is error:
            raise
        raise cause from None


def is_out_of_memory(error: BaseException) -> bool:
    """Whether an allocation of this process, or of PETSc in it, has failed."""
    return isinstance(error, MemoryError) or getattr(error, "ierr", 0) == NO_MEMORY


def unused_options() -> list[str]:
    """Options, as "-name", that were given and that PETSc has not asked for so far."""
    if not _given:
        return []
    from petsc4py import PETSc

    library = ctypes.CDLL(PETSc.__file__)  # petsc4py does not offer it
    count = np.zeros(1, dtype=PETSc.IntType)
    names, values = ctypes.POINTER(ctypes.c_char_p)(), ctypes.POINTER(ctypes.c_char_p)()
    arguments = ctypes.c_void_p(count.ctypes.data), ctypes.byref(names), ctypes.byref(values)
    if library.PetscOptionsLeftGet(None, *arguments) != 0:
        return []
    found = [names[k].decode(errors="replace") for k in range(count[0])]
    library.PetscOptionsLeftRestore(None, *arguments)
    return [f"-{name}" for name in found if name in _given and name not in AT_END]


def warn_of_unused_options() -> None:
    """Log a warning with the options that nothing has used, once."""
    found = [name for name in unused_options() if name not in _warned_of]
    _warned_of.update(found)
    if found:
        logger.warning(
            "options of PETSc that nothing has used: %s", ", ".join(map(shortened, found))
        )


@contextmanager
def _without_messages() -> Iterator[list[str]]:
    """Keep stderr from the terminal; the list then holds the text of PETSc's error.

    While it starts, PETSc writes its errors itself. Everything else is written again at the end.
    """
    messages: list[str] = []
    sys.stderr.flush()
    terminal = os.dup(2)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 2)
        loads = True
        try:
            yield messages
        except (ImportError, AttributeError):
            loads = False  # NumPy writes a page about it
            raise
        finally:
            os.dup2(terminal, 2)
            os.close(terminal)
            file.seek(0)
            errors = []
            for line in file.read().decode(errors="replace").splitlines():
                _, mark, text = line.partition("PETSC ERROR: ")
                if not mark and loads:
                    print(line, file=sys.stderr)
                elif text and text[0] not in "-#":
                    errors.append(text)
            messages += [*errors[:2][::-1], "they are refused"]


def _words(arguments: Sequence[str]) -> list[str] | InputError:
    """Options of PETSC_OPTIONS, then those of the command line; or why they are refused."""
    try:
        given = shlex.split(os.environ.get(VARIABLES[0], ""))
    except ValueError as error:
        return InputError(f"{VARIABLES[0]} cannot be read: {error}")
    for word in given:
        if _is_one_of(word, (*FILES, *LIBRARIES)):
            return InputError(
                f"{VARIABLES[0]} holds {word}: files are named on the command line only"
            )
    if VARIABLES[1] in os.environ:
        return InputError(
            f"{VARIABLES[1]} is not read: give its options on the command line, and unset it"
        )
    for word, name in zip(arguments, [*arguments[1:], ""]):
        if _is_one_of(word, FILES) and not os.access(name, os.R_OK):
            return InputError(f"{word} {name}: there is no such file that can be read")
    return [*given, *arguments]


def _without_files(words: Sequence[str]) -> list[str]:
    """Options without files of options: PETSc reports their errors well once it has started."""
    names_file = [_is_one_of(word, FILES) for word in words]
    left_out = [one or before for one, before in zip(names_file, [False, *names_file])]
    return [word for word, out in zip(words, left_out) if not out]


def _is_one_of(word: str, names: Sequence[str]) -> bool:
    return word.lower() in names  # as PETSc compares them


def __getattr__(name: str) -> Any:
    """PETSc is initialised with the first import of its name."""
    if name != "PETSc":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    start()
    return globals()["PETSc"]
