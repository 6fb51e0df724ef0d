"""Faults: bad inputs, refusals on several ranks, kills at random moments, memory of a long study.

- inputs: bad inputs of all kinds of files. Each is refused in one printable sentence, or accepted
with finite numbers.
- newer: the same of the newer sections of design files alone; trains that are accepted are run.
- bounds: the bounds that refusals of numbers print, and the first value that is refused.
- ranks: the sentence and the exit code of a sample on one rank and on two.
- kills: commands that are killed at a random moment and continued, against those that were not.
- memory: resident memory and open files of a study of many small drives.

The tables go into the page, and with --data all faults into a JSON file.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from fault_bounds import all_bounds, sentences
from fault_bounds import faults as wrong_bounds
from fault_bounds import table as table_of_bounds
from fault_inputs import run_inputs
from fault_inputs import table as table_of_inputs
from fault_kills import WAYS, Kill, commands, complete, kill
from fault_kills import table as table_of_kills
from fault_memory import draw, growth, long_study
from fault_memory import table as table_of_memory
from fault_ranks import endings, fault, sample
from page import DATA, markdown, put

PARTS = ("inputs", "newer", "bounds", "ranks", "kills", "memory")

GROWTH = 1.0
"""Memory (MB) per 1000 cases and rank that counts as none: that of the lists of the cases
themselves."""


def measure_inputs(arguments: argparse.Namespace, out: Path) -> tuple[list[list[str]], list[Any]]:
    """Table, and all faults."""
    outcomes = run_inputs(arguments.inputs, arguments.seed, out, arguments.at_once)
    return table_of_inputs(outcomes), [outcome for outcome in outcomes if outcome["fault"]]


def measure_newer(arguments: argparse.Namespace, out: Path) -> tuple[list[list[str]], list[Any]]:
    """Table, and all faults."""
    outcomes = run_inputs(arguments.inputs, arguments.seed, out, arguments.at_once, newer=True)
    return table_of_inputs(outcomes), [outcome for outcome in outcomes if outcome["fault"]]


def measure_bounds(arguments: argparse.Namespace, out: Path) -> tuple[list[list[str]], list[Any]]:
    """Table, and all bounds that are not the printed ones."""
    found = all_bounds(arguments.only)
    (out / "bounds.json").write_text(json.dumps(sentences(found), indent=2), encoding="utf-8")
    return table_of_bounds(found), wrong_bounds(found)


def measure_ranks(arguments: argparse.Namespace, out: Path) -> tuple[list[list[str]], list[Any]]:
    """Table, and all faults."""
    listed = sample(arguments.sample, arguments.seed, out)
    alone, together = (endings(listed, ranks, out) for ranks in (1, 2))
    found = {
        " ".join(c): text
        for c, a, b in zip(listed, alone, together, strict=True)
        if (text := fault(a, b))
    }
    rows = [["command", "inputs", "same sentence and code", "other"]]
    for name in (*dict.fromkeys(command[0] for command in listed), "all"):
        count = sum(name in (command[0], "all") for command in listed)
        wrong = sum(name == "all" or command.startswith(f"{name} ") for command in found)
        rows.append([name, str(count), str(count - wrong), str(wrong)])
    return rows, [found] if found else []


def measure_kills(arguments: argparse.Namespace, out: Path) -> tuple[list[list[str]], list[Any]]:
    """Table, and all faults."""
    rng, kills = np.random.default_rng(arguments.seed), []
    listed = {
        name: command
        for name, command in commands(out, arguments.ranks).items()
        if not arguments.only or any(word in name for word in arguments.only)
    }
    for number, (name, command) in enumerate(listed.items()):
        reference = out / f"reference_{number}"
        begin = time.monotonic()
        done = complete(command, reference)
        if done.returncode:
            raise SystemExit(f"{name}: {done.stderr or done.stdout}")
        whole = time.monotonic() - begin
        print(f"{name}: {whole:.1f} s without a kill", flush=True)
        for k in range(number, arguments.kills, len(listed)):
            folder, way = out / f"killed_{k}", WAYS[int(rng.integers(len(WAYS)))]
            found = kill(name, command, reference, folder, way, float(rng.uniform(0.1, whole)))
            kills.append(found)
            if found.fault:
                print(found, flush=True)
            shutil.rmtree(folder, ignore_errors=True)
    return table_of_kills(kills), [vars(k) for k in kills if isinstance(k, Kill) and k.fault]


def measure_memory(arguments: argparse.Namespace, out: Path) -> tuple[list[list[str]], list[Any]]:
    """Table, and the growth where it is a fault; writes the figure."""
    samples = long_study(arguments.cases, arguments.ranks, out)
    draw(samples, DATA / "study_memory.png")
    grows = growth(samples)
    print(f"{grows:.2f} MB per 1000 cases and rank in the second half", flush=True)
    return table_of_memory(samples), [{"growth_MB_per_1000_cases": grows}] if grows > GROWTH else []


def main() -> int:
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--out", default="results/bench/faults")
    options.add_argument("--page", default="docs/verification/faults.md")
    options.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS))
    options.add_argument(
        "--only",
        nargs="+",
        default=None,
        help="words of the names of the commands to kill, or of designs whose bounds are sought",
    )
    options.add_argument("--inputs", type=int, default=5000, help="number of bad inputs")
    options.add_argument(
        "--sample", type=int, default=200, help="number of inputs on one and two ranks"
    )
    options.add_argument("--kills", type=int, default=200, help="number of kills")
    options.add_argument(
        "--cases", type=int, default=2000, help="number of cases of the long study"
    )
    options.add_argument(
        "--ranks",
        type=int,
        default=2,
        help="number of ranks of commands that are killed, and of it",
    )
    options.add_argument("--at-once", type=int, default=2, help="workers on bad inputs at once")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--data", type=Path, default=None, help="file for all faults")
    arguments = options.parse_args()
    work = {
        "inputs": measure_inputs,
        "newer": measure_newer,
        "bounds": measure_bounds,
        "ranks": measure_ranks,
        "kills": measure_kills,
        "memory": measure_memory,
    }
    faults: list[Any] = []
    for part in arguments.parts:
        out = Path(arguments.out).resolve() / part
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir(parents=True)
        rows, found = work[part](arguments, out)
        faults += found
        print(markdown(rows), flush=True)
        put(Path(arguments.page), part, markdown(rows))
    if arguments.data is not None:
        arguments.data.write_text(json.dumps(faults, indent=2), encoding="utf-8")
    print(f"{len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
