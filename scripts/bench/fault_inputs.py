"""Bad inputs by the thousand: every one is refused in one sentence, or accepted with finite
numbers.

As a program, the worker that goes through a batch of them: a file of JSON lines has an input before
it is used, and then what became of it. One that ends the process, or takes more than a minute of
the processor, is so the last line.
"""

from __future__ import annotations

import argparse
import faulthandler
import json
import signal
import subprocess
import sys
import tempfile
import traceback
import warnings
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from pathlib import Path
from typing import Any

from support.bad_inputs import KINDS, SLOWEST, BadInput, attempt, draw_inputs
from support.bad_sections import bad_sections
from support.commands import environment

BATCH = 500
"""Inputs of one worker."""

WAITING = 1800.0
"""Seconds after which an input that uses no processor counts as hanging."""

OWN = 3
"""Exit code of a worker that fails by itself."""


def run_batch(number: int, count: int, out: Path, newer: bool) -> list[dict[str, Any]]:
    """Outcomes of the batch with this number; a worker that ends early is followed by another one
    behind the input. newer : inputs are those of the newer sections"""
    file = out / f"inputs_{number}.jsonl"
    file.unlink(missing_ok=True)
    outcomes: list[dict[str, Any]] = []
    while len(outcomes) < count:
        command = [sys.executable, __file__, str(file), str(number), str(count), str(len(outcomes))]
        command += ["--newer"] if newer else []
        with (out / f"inputs_{number}.log").open("a") as log:
            code = subprocess.run(command, stdout=log, stderr=log, env=environment()).returncode
        lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
        outcomes = [line for line in lines if "status" in line]
        if code == 0:
            break
        begun = lines[-1]
        if code == OWN or "status" in begun:
            raise SystemExit(f"the worker of batch {number} ended with {code}: see {out}")
        lost = {
            **begun,
            "status": "ended",
            "fault": f"ended the process with {code}",
            "sentence": "",
            "seconds": 0.0,
        }
        with file.open("a", encoding="utf-8") as more:
            more.write(json.dumps(lost) + "\n")
        outcomes.append(lost)
    return outcomes


def run_inputs(
    count: int, number: int, out: Path, at_once: int, *, newer: bool = False
) -> list[dict[str, Any]]:
    """Outcomes of so many inputs. number : seed of the first batch;  newer : of newer sections"""
    out.mkdir(parents=True, exist_ok=True)
    sizes = [min(BATCH, count - first) for first in range(0, count, BATCH)]
    with ThreadPoolExecutor(at_once) as pool:
        batches = pool.map(lambda k: run_batch(number + k, sizes[k], out, newer), range(len(sizes)))
    return [outcome for batch in batches for outcome in batch]


def table(outcomes: list[dict[str, Any]]) -> list[list[str]]:
    """Counts by kind of file."""
    rows = [["file", "inputs", "refused", "accepted", "faults", "slowest, processor seconds"]]
    names = sorted({outcome["kind"] for outcome in outcomes} - set(KINDS))
    drawn = [kind for kind in KINDS if any(outcome["kind"] == kind for outcome in outcomes)]
    for kind in (*drawn, *names, "all"):
        here = [outcome for outcome in outcomes if kind in (outcome["kind"], "all")]
        status = Counter(outcome["status"] for outcome in here)
        faults = sum(bool(outcome["fault"]) for outcome in here)
        slowest = max((outcome["seconds"] for outcome in here), default=0.0)
        counts = (len(here), status["refused"], status["accepted"], faults)
        rows.append([kind, *(f"{n:,}" for n in counts), f"{slowest:.1f}"])
    return rows


def work(file: Path, number: int, count: int, skipped: int, newer: bool) -> None:
    """Go through a batch behind its first inputs."""
    warnings.simplefilter("ignore")
    drawn = 0
    with tempfile.TemporaryDirectory() as name, file.open("a", encoding="utf-8") as lines:
        right, used = Path(name) / "right", Path(name) / "used"
        right.mkdir()
        used.mkdir()

        def visit(bad: BadInput) -> None:
            nonlocal drawn
            drawn += 1
            if drawn <= skipped or drawn > count:
                return
            kind = bad.section or bad.kind
            lines.write(json.dumps({"kind": kind, "what": bad.what}) + "\n")
            lines.flush()
            faulthandler.dump_traceback_later(WAITING, exit=True)
            signal.setitimer(
                signal.ITIMER_PROF, SLOWEST
            )  # its signal ends the process, in any library
            outcome = attempt(bad, used)
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            faulthandler.cancel_dump_traceback_later()
            found = asdict(outcome)
            lines.write(json.dumps(found if outcome.fault else {**found, "content": ""}) + "\n")
            lines.flush()

        if newer:
            for bad in bad_sections(count, number):
                visit(bad)
        else:
            draw_inputs(count, number, right, visit)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("file", type=Path)
    for name in ("number", "count", "skipped"):
        options.add_argument(name, type=int)
    options.add_argument("--newer", action="store_true")
    arguments = options.parse_args()
    try:
        work(
            arguments.file,
            arguments.number,
            arguments.count,
            arguments.skipped,
            arguments.newer,
        )
    except Exception:
        traceback.print_exc()
        sys.exit(OWN)


if __name__ == "__main__":
    main()
