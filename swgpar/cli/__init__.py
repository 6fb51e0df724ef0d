"""The command `swgpar`."""

from __future__ import annotations

import difflib
import gc
import io
import os
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress

from swgpar.cli.parser import parser
from swgpar.errors import InputError, OutOfMemoryError, OutputError, SwgparError, shortened

__all__ = ["main", "parser"]

SOLVING = ("run", "rate", "study", "optimise")
"""Commands that compute on all ranks, with options of PETSc."""

WITHOUT_PETSC = ("new", "check", "app")
"""Commands that need no PETSc: it does not start with them."""

GARBAGE = 20_000
"""New objects after which Python looks for cycles of garbage. At its usual 700 the objects of all
modules are gone through again and again while further modules are imported and figures drawn: 0.4 s
of a plane run, which makes hardly any cycles."""


def _check_rest(rest: Sequence[str], options: Sequence[str], petsc: bool) -> None:
    """Refuse what is neither one of the options nor, where these are allowed, one of PETSc (-name,
    -name value)."""
    after_option = False
    for word in rest:
        option = petsc and len(word) > 1 and word[0] == "-" and (word[1].isalpha())
        if not option and not after_option:
            hint = "; options of PETSc begin with one dash" if petsc else ""
            for near in difflib.get_close_matches(word, options, n=1):
                hint = f": did you mean {near}?"
            raise InputError(f"unknown argument {shortened(word)}{hint}")
        after_option = option


def _print_error(error: object) -> None:
    with suppress(OSError):
        print(f"swgpar: error: {error}", file=sys.stderr, flush=True)


def _drop_output() -> None:
    """Send what standard output still holds to nowhere: Python would try to write it at its end."""
    with suppress(OSError, ValueError, AttributeError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; returns the exit code: 0, that of the error, 130 or 143 after a signal."""
    from swgpar import watch

    # a process that mpirun did not start needs no daemon of Open MPI, which takes long to start
    os.environ.setdefault("OMPI_MCA_ess_singleton_isolated", "1")
    if not any(name in os.environ for name in watch.RANK):
        # it sends no messages: trying the fast networks takes Open MPI 0.2 s
        os.environ.setdefault("OMPI_MCA_pml", "ob1")
    # all of them map files of one folder: a file that another run has mapped is left alone
    os.environ.setdefault("OMPI_MCA_sharedfp", "^sm")
    # looking for plug-ins of Pydantic takes 20 ms; designs need none
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    gc.set_threshold(GARBAGE, *gc.get_threshold()[1:])
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # letters that an encoding lacks are escaped
            stream.reconfigure(errors="backslashreplace")
    with watch.armed():
        return _main(arguments)


def _main(arguments: Sequence[str] | None) -> int:
    command = None
    try:
        known, rest = parser().parse_known_args(arguments)
        command = known.command
        _check_rest(rest, known.parser.options(), petsc=command in SOLVING)
        known.overrides = [item for group in getattr(known, "set", []) for item in group]
        from swgpar import petsc, watch

        if command not in WITHOUT_PETSC:
            petsc.start(rest)
            watch.rearm()
        from swgpar.cli.commands import COMMANDS

        COMMANDS[command](known)
        sys.stdout.flush()  # here, and not at exit, a reader that has gone is told of
    except SwgparError as error:
        from mpi4py import MPI

        alone = getattr(error, "alone", False) and MPI.COMM_WORLD.size > 1
        if MPI.COMM_WORLD.rank == 0 or alone:
            _print_error(error)
        if alone:
            _abort(error.exit_code)
        return error.exit_code
    except BrokenPipeError:  # the reader of our output has gone
        _drop_output()
        sys.stderr.close()
        return 1
    except OSError as error:
        _drop_output()
        what = f"read or write {error.filename}" if error.filename else "write standard output"
        _print_error(OutputError(f"cannot {what}: {error.strerror or error}"))
        from mpi4py import MPI

        if command in SOLVING and MPI.COMM_WORLD.size > 1:
            _abort(OutputError.exit_code)
        return OutputError.exit_code
    except MemoryError:
        _print_error("not enough memory: take a coarser mesh, or more memory")
        if command in SOLVING:
            _abort(OutOfMemoryError.exit_code)
        return OutOfMemoryError.exit_code
    except Exception:
        if command not in SOLVING:
            raise
        traceback.print_exc()
        _abort(1)
    return 0


def _abort(code: int) -> None:
    """End the other ranks, which wait for this one."""
    from mpi4py import MPI

    MPI.COMM_WORLD.Abort(code)
