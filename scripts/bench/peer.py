"""The same mesh solved by this program and by CalculiX: displacement, stress, seconds and memory
side by side.

Both programs solve a whole plain ring on the same number of cores, one after the other. Compared
are the displacement of the outer surface a right angle from the loads, the largest difference of
displacements at any node, and the largest first principal stress at the nodes. Both programs
extrapolate stresses from the Gauss points and average them at the nodes. Seconds are those of the
whole command: reading or meshing, solving, stresses, writing.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from page import markdown, put
from peer_ccx import read_answer, write_job
from peer_problems import LEVELS, PROBLEMS, sector, side

from swgpar.meshing import SectorMesh
from swgpar.meshing.export import sector_numbers, whole_body

Row = dict[str, Any]

COLUMNS = ("displacement_mm", "s1_MPa", "iterations", "seconds", "cpu_seconds", "memory_MB")
"""Of both programs."""


@dataclass(frozen=True)
class Cost:
    """seconds : wall;  cpu : s, of all threads and ranks;  memory : MB, peak, of all ranks
    together"""

    seconds: float
    cpu: float
    memory: float


def timed(command: list[str], folder: Path, log: Path, environment: dict[str, str]) -> Cost:
    """Run a command to its end; the memory is that of its largest process."""
    begin = time.perf_counter()
    with log.open("w") as file:
        process = subprocess.Popen(
            command, cwd=folder, stdout=file, stderr=file, env=os.environ | environment
        )
        _, status, used = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - begin
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(f"{command[0]} failed: see {log}")
    return Cost(seconds, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0)


def run_calculix(name: str, mesh: SectorMesh, folder: Path, cores: int) -> tuple[Row, np.ndarray]:
    """Columns of the table, and displacements (n, 3) mm."""
    write_job(PROBLEMS[name], mesh, folder)
    environment = {"OMP_NUM_THREADS": str(cores), "OPENBLAS_NUM_THREADS": "1"}
    cost = timed(["ccx", "job"], folder, folder / "ccx.log", environment)
    coords, _ = whole_body(mesh)
    answer = read_answer(folder, len(coords))
    return columns("ccx", cost, answer.displacement, answer.s1, coords, answer.iterations) | {
        "ccx_increments": answer.increments,
        "ccx_equations": answer.equations,
    }, answer.displacement


def run_swgpar(
    name: str, counts: tuple[int, int, int], mesh: SectorMesh, folder: Path, cores: int, part: str
) -> tuple[Row, np.ndarray]:
    """Columns of the table, and displacements (n, 3) mm. part : "whole" ring, or "half" by its
    symmetry"""
    folder = folder / part
    folder.mkdir()
    program = Path(__file__).with_name("peer_swgpar.py")
    command = [
        "mpirun",
        "-n",
        str(cores),
        sys.executable,
        str(program),
        name,
        *map(str, counts),
        part,
        str(folder),
    ]
    cost = timed(
        command,
        Path.cwd(),
        folder / "swgpar.log",
        {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
    )
    coords, _ = whole_body(mesh)
    numbers = sector_numbers(mesh)
    displacement, s1 = np.full(coords.shape, np.nan), np.full(len(coords), np.nan)
    for path in folder.glob("rank*.npz"):
        with np.load(path) as fields:
            images = [(0, (1.0, 1.0, 1.0))] + [(mesh.n_sectors // 2, (-1.0, -1.0, 1.0))] * (
                part == "half"
            )
            for shift, signs in images:
                own = numbers[(fields["sectors"] + shift) % mesh.n_sectors]
                displacement[own], s1[own] = signs * fields["displacement"], fields["s1"]
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    cost = Cost(cost.seconds, cost.cpu, sum(summary["memory_MB"]))
    return columns("swgpar", cost, displacement, s1, coords, summary["iterations"]), displacement


def columns(
    program: str, cost: Cost, u: np.ndarray, s1: np.ndarray, coords: np.ndarray, iterations: int
) -> Row:
    """Columns of the table for each program."""
    values = (
        u[side(coords), 0],
        s1.max(),
        iterations,
        round(cost.seconds, 2),
        round(cost.cpu, 2),
        round(cost.memory),
    )
    return {f"{program}_{column}": value for column, value in zip(COLUMNS, values)}


def compare(name: str, counts: tuple[int, int, int], out: Path, cores: int) -> Row:
    """A row of the table: both programs on one problem and mesh."""
    folder = out / f"{name.split(':')[0].replace(' ', '_')}_{'x'.join(map(str, counts))}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    mesh = sector(counts)
    coords, elements = whole_body(mesh)
    ours, u = run_swgpar(name, counts, mesh, folder, cores, "whole")
    half, w = run_swgpar(name, counts, mesh, folder, cores, "half")
    theirs, v = run_calculix(name, mesh, folder, cores)
    row: Row = {
        "problem": name,
        "elements": len(elements),
        "dofs": coords.size,
        "cores": cores,
        **ours,
        **theirs,
    }
    a, b = (row[f"{program}_displacement_mm"] for program in ("swgpar", "ccx"))
    row["displacement_difference"] = a / b - 1.0
    row["field_difference"] = float(
        np.linalg.norm(u - v, axis=1).max() / np.linalg.norm(v, axis=1).max()
    )
    row["s1_difference"] = row["swgpar_s1_MPa"] / row["ccx_s1_MPa"] - 1.0
    row["times_faster"] = row["ccx_seconds"] / row["swgpar_seconds"]
    row["half_seconds"] = half["swgpar_seconds"]
    row["half_difference"] = float(
        np.linalg.norm(u - w, axis=1).max() / np.linalg.norm(v, axis=1).max()
    )
    row["times_faster_half"] = row["ccx_seconds"] / row["half_seconds"]
    row["times_less_cpu"] = row["ccx_cpu_seconds"] / row["swgpar_cpu_seconds"]
    return row


def write(rows: list[Row], tables: Path, page: Path) -> None:
    tables.mkdir(parents=True, exist_ok=True)
    (tables / "peer.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    with (tables / "peer.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            {k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows
        )
    put(page, "table", markdown([HEAD, *map(line_of, rows)]))


HEAD = (
    "problem",
    "dofs",
    "cores",
    "displacement mm: swgpar",
    "CalculiX",
    "largest difference anywhere",
    "s1 MPa: swgpar",
    "CalculiX",
    "Newton iterations",
    "seconds: swgpar",
    "by symmetry",
    "CalculiX",
    "CPU seconds",
    "MB: swgpar",
    "CalculiX",
    "times faster",
    "by symmetry",
    "by CPU",
)


def line_of(row: Row) -> list[str]:
    """The cells of a row."""

    def both(column: str, form: str = "") -> list[str]:
        return [f"{row[f'{program}_{column}']:{form}}" for program in ("swgpar", "ccx")]

    cells = [row["problem"], f"{row['dofs']:,}", str(row["cores"]), *both("displacement_mm", ".5g")]
    cells += [
        f"{row['field_difference']:.3%}",
        *both("s1_MPa", ".5g"),
        " / ".join(both("iterations")),
    ]
    ours, theirs = both("seconds", ".3g")
    half = row.get("half_seconds"), row.get("times_faster_half")
    seconds, faster = (
        "" if value is None else f"{value:{form}}" for value, form in zip(half, (".3g", ".2g"))
    )
    cells += [ours, seconds, theirs, " / ".join(both("cpu_seconds", ".3g")), *both("memory_MB")]
    return [*cells, f"{row['times_faster']:.2g}", faster, f"{row['times_less_cpu']:.2g}"]


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--out", default="results/bench/peer", help="jobs and logs")
    options.add_argument("--tables", default="docs/verification/data")
    options.add_argument("--page", default="docs/verification/peer.md")
    options.add_argument(
        "--cores", type=int, default=2, help="threads of CalculiX, ranks of this program"
    )
    options.add_argument(
        "--only", nargs="+", default=list(PROBLEMS), help="first words of the problems to run"
    )
    options.add_argument(
        "--levels",
        nargs="+",
        type=int,
        default=list(range(len(LEVELS))),
        help="meshes, from 0; other rows are kept",
    )
    arguments = options.parse_args()
    if shutil.which("ccx") is None:
        options.error("CalculiX (ccx) is not installed: on Debian apt-get install calculix-ccx")
    tables = Path(arguments.tables)
    kept = tables / "peer.json"
    rows: list[Row] = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else []
    order = list(PROBLEMS)
    print(" | ".join(HEAD))
    for name in order:
        if not any(name.startswith(word) for word in arguments.only):
            continue
        for level in arguments.levels:
            row = compare(name, LEVELS[level], Path(arguments.out).resolve(), arguments.cores)
            print(" | ".join(line_of(row)), flush=True)
            rows = [
                r for r in rows if any(r[k] != row[k] for k in ("problem", "dofs", "cores"))
            ] + [row]
            rows.sort(key=lambda r: (r["cores"], order.index(r["problem"]), r["dofs"]))
            write(rows, tables, Path(arguments.page))
    print(f"written {tables}/peer.csv, peer.json")


if __name__ == "__main__":
    main()
