"""The same refusal on any number of ranks: sentence and exit code of commands with bad inputs.

As a program, under mpirun: it calls the command line with one list of arguments after the other, in
one process per rank, and writes the exit code of every rank and what all of them have written to
stderr.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import subprocess
import sys
from pathlib import Path

from mpi4py import MPI

from support.bad_inputs import BadInput, attempt, draw_inputs
from support.bad_sections import bad_sections
from support.commands import environment, on_ranks
from support.paths import DESIGN, RECIPE, REFERENCE
from support.small_drive import PLANE
from swgpar.results import history

Ending = tuple[list[int], str]
"""Exit codes of all ranks, and what they have written to stderr."""


def arguments_of(bad: BadInput, folder: Path, number: int) -> list[str]:
    """The command that reads the input in this folder; designs are checked and run in turns."""
    file, out = str(folder / next(iter(bad.files))), str(folder / "out")
    if bad.kind == "study":
        return ["study", file, "--out", out]
    if bad.kind == "optimisation":
        return ["optimise", file, "--out", out]
    if bad.kind == "curve file":
        wave = f'wave_generator={{type="points",file="{file}",face_width=4.0}}'
        return ["check", str(DESIGN), "--set", *PLANE, wave]
    if bad.kind == "result":
        return ["report", str(folder / "copy")]
    if bad.kind == "mesh recipe":
        return ["check", str(REFERENCE), "--mesh", file]
    if bad.kind == "pitch file":
        section, column = "deviations.ring_gear", bad.files["column"].decode() or '""'
        pitch = [f"{section}.pitch_file={file}", f"{section}.pitch_column={column}"]
        return ["check", str(DESIGN), "--set", *PLANE, *pitch]
    if bad.kind == "checkpoint":
        run = [
            "run",
            str(DESIGN),
            "--mesh",
            str(RECIPE),
            "--plain",
            "--restart",
            "--out",
            str(folder),
        ]
        return [*run, "--set", *PLANE]
    return ["run", file, "--out", out] if number % 2 else ["check", file]


def sample(count: int, number: int, folder: Path) -> list[list[str]]:
    """Commands with so many inputs that are refused, half of them in newer sections; their files
    are written into folders of this one."""
    commands: list[list[str]] = []
    folder.mkdir(parents=True, exist_ok=True)

    def visit(bad: BadInput) -> None:
        here = folder / f"{len(commands):04d}"
        here.mkdir(exist_ok=True)
        if len(commands) < wanted and attempt(bad, here).status == "refused":
            (here / history.NAME).touch()
            commands.append(arguments_of(bad, here, len(commands)))

    for wanted in (count // 2, count):
        while len(commands) < wanted:
            if wanted < count:
                draw_inputs(count, number, folder, visit)
            else:
                for bad in bad_sections(count, number):
                    visit(bad)
            number += 1
    return commands


def endings(commands: list[list[str]], ranks: int, folder: Path) -> list[Ending]:
    """How the commands end on so many ranks."""
    given, found = folder / "commands.json", folder / f"endings_{ranks}.json"
    given.write_text(json.dumps(commands), encoding="utf-8")
    worker = [sys.executable, __file__, str(given), str(found)]
    done = subprocess.run(
        [*on_ranks(ranks), *worker], capture_output=True, text=True, env=environment()
    )
    if done.returncode:
        raise SystemExit(
            f"the commands on {ranks} ranks ended with {done.returncode}: {done.stderr[-2000:]}"
        )
    return [(codes, text) for codes, text in json.loads(found.read_text(encoding="utf-8"))]


def fault(alone: Ending, together: Ending) -> str:
    """What is wrong with how a command ended on one rank and on several; empty where nothing is."""
    (codes, text), (others, other) = alone, together
    if len({*codes, *others}) > 1 or codes[0] == 0:
        return f"exit codes {codes} and {others}"
    if text != other:
        return f"{text!r} and {other!r}"
    lines = text.splitlines()
    refused = len(lines) == 1 and lines[0].startswith("swgpar: error: ") and lines[0].isprintable()
    return "" if refused else f"no sentence: {text!r}"


def work(given: Path, found: Path) -> None:
    """Call all commands on all ranks."""
    from swgpar.cli import main

    comm, results = MPI.COMM_WORLD, []
    with open(os.devnull, "w", encoding="utf-8") as nothing:
        for arguments in json.loads(given.read_text(encoding="utf-8")):
            with (
                contextlib.redirect_stderr(io.StringIO()) as stderr,
                contextlib.redirect_stdout(nothing),
            ):
                code = main(arguments)
            ends = comm.gather((code, stderr.getvalue()))
            if comm.rank == 0:
                results.append(([code for code, _ in ends], "".join(text for _, text in ends)))
    if comm.rank == 0:
        found.write_text(json.dumps(results), encoding="utf-8")


if __name__ == "__main__":
    work(*map(Path, sys.argv[1:]))
