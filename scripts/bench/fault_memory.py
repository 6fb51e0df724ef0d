"""Memory and open files of the processes of a long study, over the cases that have begun."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from fault_kills import CUP, STUDY

from support.commands import environment, is_rank, of_session, on_ranks, swgpar
from support.paths import DATA, DESIGN, RECIPE
from support.small_drive import PLANE

EVERY = 1.0
"""Seconds between two looks at the processes."""

MB = 2.0**20

SHARES = (0.1, 0.25, 0.5, 0.75, 1.0)
"""Parts of the study in the table. At the first of them every module has been imported."""


@dataclass(frozen=True)
class Sample:
    """seconds : since the start;  cases : begun so far;  memory : MB, resident, and files : open
    ones, per rank"""

    seconds: float
    cases: int
    memory: tuple[float, ...]
    files: tuple[int, ...]


def long_study(cases: int, ranks: int, out: Path) -> list[Sample]:
    """Looks at a study of so many small plane drives; raises SystemExit if it fails."""
    study = out / "study.toml"
    overrides = ", ".join(f'"{override}"' for override in (*PLANE, *CUP, "output.figures=false"))
    torques = np.linspace(0.1, 0.4, cases).round(9).tolist()
    text = STUDY.format(design=DESIGN, mesh=RECIPE, overrides=overrides, torques=torques)
    study.write_text(text, encoding="utf-8")
    folder, begin, found = out / "results", time.monotonic(), []
    with (out / "log").open("w") as log:
        command = [*on_ranks(ranks), *swgpar("study", study, "--out", folder)]
        process = subprocess.Popen(
            command,
            cwd=DATA,
            env=environment(),
            start_new_session=True,
            stdout=log,
            stderr=subprocess.STDOUT,
        )
        while process.poll() is None:
            time.sleep(EVERY)
            members = [pid for pid in of_session(process.pid) if is_rank(pid)]
            try:
                memory = tuple(_resident(pid) for pid in members)
                files = tuple(len(os.listdir(f"/proc/{pid}/fd")) for pid in members)
            except OSError:  # a process has ended meanwhile
                continue
            if len(members) == ranks and (folder / "cases").exists():
                number = len(os.listdir(folder / "cases"))
                found.append(Sample(time.monotonic() - begin, number, memory, files))
    if process.returncode:
        raise SystemExit(f"the study ended with {process.returncode}: see {out / 'log'}")
    return found


def _resident(pid: int) -> float:
    """MB"""
    pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGESIZE") / MB


def growth(samples: Sequence[Sample]) -> float:
    """Memory (MB) that a rank gains per 1000 cases in the second half of the study: slope of a
    line, largest rank."""
    computing = [
        sample for sample in samples if sample.cases < samples[-1].cases
    ]  # the report comes afterwards
    late = computing[len(computing) // 2 :]
    cases = np.array([sample.cases for sample in late], float)
    return float(1000.0 * max(np.polyfit(cases, np.array([s.memory for s in late]), 1)[0]))


def table(samples: Sequence[Sample]) -> list[list[str]]:
    """Memory and open files at some parts of the study."""
    rows = [["cases", "seconds", "memory of a rank, MB", "open files of a rank"]]
    last = samples[-1].cases
    for share in SHARES:
        here = next(sample for sample in samples if sample.cases >= share * last)
        memory, files = f"{max(here.memory):.0f}", str(max(here.files))
        rows.append([f"{here.cases:,}", f"{here.seconds:.0f}", memory, files])
    return rows


def draw(samples: Sequence[Sample], path: Path) -> None:
    """Memory of every rank over the cases."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 3.6), layout="constrained")
    axes = figure.subplots()
    cases = [sample.cases for sample in samples]
    for rank in range(len(samples[0].memory)):
        axes.plot(
            cases, [sample.memory[rank] for sample in samples], lw=0.8, label=f"process {rank + 1}"
        )
    axes.set(xlabel="cases begun", ylabel="resident memory (MB)", ylim=(0.0, None))
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=110)
