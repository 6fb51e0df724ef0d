"""Commands that are killed at random moments, and then continued to the result of one that was
not."""

from __future__ import annotations

import csv
import os
import re
import signal
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from support.commands import environment, is_rank, of_session, on_ranks, swgpar
from support.paths import DATA, DESIGN, DRIVERS, RECIPE
from support.small_drive import PLANE
from support.small_trains import SMALL

LONGEST = 60.0
"""Seconds after a signal in which all processes have to end."""

SAME = 1e-7
"""Difference that is none: a restart predicts its first states from one alone, with other
iterations, which end anywhere below a residual of 1e-9 of the contact force."""

NUMBER = "evaluation"
"""Column of the table of a search."""

SKIPPED = ("wall_s", "newton_iterations", NUMBER)
"""Columns that are no result: times, and iterations, which a restart may save or add."""

CUP = ("steps.rotation=2.0", "steps.increment=2.0")
ROTATION = ("steps.rotation=8.0", "steps.increment=2.0")
FEW = ("output.figures=false",)

SECTIONS = {
    "stiffness": ("stiffness.torque=0.2", "stiffness.positions=1", "stiffness.mesh_error=false"),
    "program": (
        "load.program=[{name='up',torque=0.2,points=3},{name='turn',torque=0.2,wave_generator=4.0,"
        "points=3},{name='down',torque=0.0,points=2}]",
    ),
    "deviations": (
        "deviations.ring_gear.pitch_grade=6",
        "deviations.wave_generator.eccentricity=0.002",
        "deviations.mesh='same'",
    ),
    "bearing": (
        "wave_generator.bearing={balls=20,ball_diameter=2.0,race_thickness=0.5}",
        "steps.rotation=6.0",
        "steps.increment=2.0",
    ),
}
"""Small plane drives with a section each."""

SEARCH = """[optimise]
design = "{design}"
set = ["monte_carlo.samples=2001", "time.end=1e-4", "time.rows=2"]
evaluations = 12
first = [{first}]
[[optimise.variable]]
keys = ["mesh.stiffness"]
low = 1e9
high = 1e11
log = true
[[optimise.objective]]
quantity = "out_of_contact_3"
"""

STUDY = """[study]
design = "{design}"
meshes = ["{mesh}"]
set = [{overrides}]
[study.vary]
"load.torque" = {torques}
"""


@dataclass(frozen=True)
class Command:
    """arguments : without --out;  restart : the option that continues it;  ranks : number of
    processes"""

    arguments: tuple[str, ...]
    restart: str
    ranks: int

    def line(self, out: Path, *more: str) -> list[str]:
        """The whole command."""
        first, *rest = self.arguments
        return [*on_ranks(self.ranks), *swgpar(first, rest[0], "--out", out, *more, *rest[1:])]


def commands(folder: Path, ranks: int) -> dict[str, Command]:
    """What is killed, by name. folder : for the study file"""
    small = (str(DESIGN), "--mesh", str(RECIPE))
    overrides = ", ".join(f'"{override}"' for override in (*PLANE, *CUP))
    study = folder / "study.toml"
    study.write_text(
        STUDY.format(design=DESIGN, mesh=RECIPE, overrides=overrides, torques=[0.1, 0.2, 0.3, 0.4]),
        encoding="utf-8",
    )
    found = {
        "plane": Command(
            ("run", *small, "--plain", "--set", *PLANE, *ROTATION, *FEW), "--restart", ranks
        ),
        "small cup": Command(("run", *small, "--plain", "--set", *CUP, *FEW), "--restart", ranks),
        "study": Command(("study", str(study)), "--restart", ranks),
        "accuracy": Command(
            ("run", *small, "--accuracy", "0.2", "--set", *PLANE, *FEW), "--restart", ranks
        ),
    }
    still = ("steps.rotation=0.0", *FEW)
    for name, overrides in SECTIONS.items():
        run = ("run", *small, "--plain", "--set", *PLANE, *still, *overrides)
        found[name] = Command(run, "--restart", ranks)
    search = folder / "search.toml"
    # all designs are given, and all are tried, that of the design file first: a sampler begins
    # anew after a restart
    first = ", ".join(f'{{"mesh.stiffness" = {k}e9}}' for k in range(2, 14))
    text = SEARCH.format(design=DRIVERS / "gear_pair.toml", first=first)
    search.write_text(text, encoding="utf-8")
    found["optimisation"] = Command(("optimise", str(search)), "--restart", ranks)
    for name in SMALL:
        train = ("run", str(DRIVERS / f"{name}.toml"), "--set", *SMALL[name], *FEW)
        found[f"gear train, {name}"] = Command(train, "--overwrite", ranks)
    return found


WAYS = ("kill all", "kill one rank", "SIGINT to one rank", "SIGTERM to mpirun", "SIGHUP to mpirun")
"""How a command is killed; on one rank mpirun is the process itself."""


@dataclass(frozen=True)
class Kill:
    """One kill. seconds : after the start;  late : seconds until all processes had ended

    ended : whether the command had ended before;  difference : of the continued results, relative
    to each column's largest value;  fault : what is wrong, empty where nothing is
    """

    command: str
    way: str
    seconds: float
    late: float
    ended: bool
    difference: float
    fault: str


def complete(command: Command, out: Path, *more: str) -> subprocess.CompletedProcess[str]:
    """Run a command to its end."""
    return subprocess.run(
        command.line(out, *more), capture_output=True, text=True, cwd=DATA, env=environment()
    )


def kill(name: str, command: Command, reference: Path, out: Path, way: str, seconds: float) -> Kill:
    """Kill a command after these seconds, continue it, and compare its results with those of the
    reference."""
    process = subprocess.Popen(
        command.line(out),
        cwd=DATA,
        env=environment(),
        start_new_session=True,
        preexec_fn=_hear_all,  # noqa: PLW1509  # this process has one thread
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    time.sleep(seconds)
    ended = process.poll() is not None
    if not ended:
        _send(process.pid, way)
    begin, fault, stderr = time.monotonic(), "", ""
    try:
        _, stderr = process.communicate(timeout=LONGEST)
    except subprocess.TimeoutExpired:
        fault = f"still there {LONGEST:.0f} s after {way}"
        _send(process.pid, "kill all")
        process.wait()
    late = time.monotonic() - begin
    if "Traceback" in stderr:
        fault = f"traceback: {stderr[-300:]}"
    _end_rest(process.pid)
    if not fault and not ended:
        done = complete(command, out, command.restart)
        if done.returncode:
            fault = (
                f"{command.restart} ended with {done.returncode}: "
                f"{(done.stderr or done.stdout)[-300:]}"
            )
    found = np.nan if fault else difference(out, reference)
    if not fault and not found <= SAME:
        column = worst_column(out, reference)
        fault = f"results differ by {found:.1e} ({column})"
    return Kill(name, way, seconds, late, ended, found, fault)


def _hear_all() -> None:
    """Under nohup a command would ignore SIGHUP."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def _send(leader: int, way: str) -> None:
    """Signals to a command whose session has this leader."""
    members = [pid for pid in of_session(leader) if is_rank(pid)]
    if way == "kill all":
        targets, number = of_session(leader), signal.SIGKILL
    elif way == "kill one rank":
        targets, number = members[-1:], signal.SIGKILL
    elif way == "SIGINT to one rank":
        targets, number = members[-1:], signal.SIGINT
    else:
        targets, number = [leader], signal.SIGTERM if way.startswith("SIGTERM") else signal.SIGHUP
    for pid in targets:
        try:
            os.kill(pid, number)
        except ProcessLookupError:  # ended meanwhile
            pass


def _end_rest(leader: int) -> None:
    """End what a killed mpirun has left behind, so that it cannot write any more."""
    limit = time.monotonic() + LONGEST
    while (rest := of_session(leader)) and time.monotonic() < limit:
        for pid in rest:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        time.sleep(0.05)


def difference(out: Path, reference: Path) -> float:
    """Largest difference of all tables of two results folders, relative to each column's largest
    value."""
    return max((change for change, _ in _differences(out, reference)), default=np.nan)


def worst_column(out: Path, reference: Path) -> str:
    """File and column with the largest difference."""
    return max(_differences(out, reference))[1]


def _differences(out: Path, reference: Path) -> list[tuple[float, str]]:
    names = sorted(path.relative_to(reference) for path in reference.rglob("*.csv"))
    found = [(name, _of_table(out / name, reference / name)) for name in names]
    return [(change, f"{name}, {column}") for name, (change, column) in found]


def _of_table(path: Path, other: Path) -> tuple[float, str]:
    """Largest difference, and its column."""
    if not path.exists():
        return np.inf, "no file"
    rows, expected = _rows(path), _rows(other)
    if rows[0] != expected[0] or len(rows) != len(expected):
        return np.inf, "other columns or rows"
    if NUMBER in rows[0]:  # evaluations have their own order
        place = rows[0].index(NUMBER) + 1
        for table in (rows, expected):
            table[1:] = sorted(table[1:], key=lambda row: row[place:])
    changes = [(0.0, "")]
    scales = {}
    for k, column in enumerate(rows[0]):
        if column in SKIPPED or re.match(r"newton|wall", column):
            continue
        a, b = ([row[k] for row in table[1:]] for table in (rows, expected))
        try:
            left, right = np.array(a, float), np.array(b, float)
        except ValueError:
            changes.append((0.0 if a == b else np.inf, column))
            continue
        scales[column] = float(np.nanmax(np.abs(right), initial=0.0))
        # the balance is nothing but round-off, of the torques
        scale = scales["output_torque_Nmm"] if column == "torque_balance_Nmm" else scales[column]
        change = float(np.nanmax(np.abs(left - right), initial=0.0))
        same_gaps = np.array_equal(np.isnan(left), np.isnan(right))
        share = change / scale if scale else change
        changes.append((share if same_gaps else np.inf, column))
    return max(changes)


def _rows(path: Path) -> list[list[str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


def table(kills: Sequence[Kill]) -> list[list[str]]:
    """Counts by command."""
    rows = [["command", "kills", "after its end", "faults", "slowest end, s", "largest difference"]]
    for name in (*dict.fromkeys(kill.command for kill in kills), "all"):
        here = [kill for kill in kills if name in (kill.command, "all")]
        largest = max(
            (kill.difference for kill in here if np.isfinite(kill.difference)), default=np.nan
        )
        counts = len(here), sum(kill.ended for kill in here), sum(bool(kill.fault) for kill in here)
        rows.append(
            [name, *map(str, counts), f"{max(kill.late for kill in here):.1f}", f"{largest:.1e}"]
        )
    return rows
