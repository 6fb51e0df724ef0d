"""Public designs through `swgpar check`, `run` and `export`: the table of
docs/verification/public_drives.md.

Plane designs are run over a period on `plane_coarse`, others up to their loaded state on the mesh
of the tests, which is coarser than `coarse`, both without windows and figures: the table says what
becomes of a design, not how large its stresses are. What is refused, warned of or stopped is told
by the program's own sentence.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
from pathlib import Path
from typing import Any

from page import markdown, write_results

import swgpar
from swgpar.checks.remarks import remarks
from swgpar.errors import InputError

DESIGNS = Path("tests/data/public")
FOLDER = Path("results/bench/public_drives")
COLUMNS = ("design", "refused", "ended", "strain", "exported", "remarks")
SECONDS = 150
"""Of a processor, after which a run is stopped."""

MESHES = {"plane": "plane_coarse", "cup": "tests/data/tiny.toml", "pancake": "tests/data/tiny.toml"}


def called(*command: str) -> tuple[int, str]:
    """Exit code, and the last line that the program wrote."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))

    def used() -> float:
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        return children.ru_utime + children.ru_stime

    start, line = used(), [sys.executable, "-P", "-m", "swgpar.cli", *command]
    done = subprocess.run(line, capture_output=True, text=True, preexec_fn=limit, check=False)
    if used() - start >= SECONDS:
        return -1, f"not finished in {SECONDS} s of a processor"
    words = (done.stderr if done.returncode else done.stdout).strip().splitlines()
    return done.returncode, words[-1] if words else ""


def measure(path: Path) -> dict[str, Any]:
    """What becomes of one design."""
    row: dict[str, Any] = {"design": path.stem}
    try:
        design = swgpar.load_design(path)
    except InputError as error:
        return {**row, "refused": str(error)}
    row["remarks"] = " | ".join(remarks(design))
    mesh = MESHES[design.drive.model]
    out = FOLDER / path.stem
    left_out = "output.figures=false", "output.root_stress=false"
    options = ("--mesh", mesh, "--overwrite", "--set", *left_out)
    options += ("steps.rotation=0",) if design.has_cup else ()
    code, last = called("run", str(path), "--out", str(out), *options)
    row["ended"] = last if code else ""
    if code == 0:
        strain = swgpar.open_result(out).summary.strains.fs
        row["strain"] = None if strain is None else round(strain, 3)
    return {**row, "exported": exported(path, mesh, pancake=design.drive.model == "pancake")}


def exported(path: Path, mesh: str, *, pancake: bool) -> str:
    """Formats that were written, and why others were not."""
    jobs = (("step", "dxf"),) if pancake else (("step", "dxf"), ("inp",))
    out, words = FOLDER / f"{path.stem} export", []
    for formats in jobs:
        command = ("export", str(path), "--out", str(out), "--overwrite", "--format", *formats)
        code, last = called(*command, *(("--mesh", mesh) if "inp" in formats else ()))
        words.append(last.removeprefix("swgpar: error: ") if code else ", ".join(formats))
    return "; ".join(words)


def table(rows: list[dict[str, Any]]) -> str:
    """The page's table."""
    found = [["design", "run", "largest strain, %", "export", "what is said"]]
    for row in rows:
        said = row.get("refused") or "; ".join(filter(None, (row["ended"], row["remarks"])))
        found.append(
            [
                f"`{row['design']}`",
                "refused" if row.get("refused") else "stopped" if row["ended"] else "ends",
                f"{row['strain']:.2g}" if row.get("strain") is not None else "",
                row.get("exported", ""),
                said.replace(" | ", "; "),
            ]
        )
    return markdown(found)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--only", nargs="+", default=[], metavar="DESIGN", help="names of files")
    arguments = options.parse_args()
    paths = sorted(DESIGNS.glob("*.toml"))
    FOLDER.mkdir(parents=True, exist_ok=True)
    rows = []
    for path in paths:
        kept = FOLDER / f"{path.stem}.json"
        if path.stem in arguments.only or not kept.exists():
            kept.write_text(json.dumps(measure(path)), encoding="utf-8")
        rows.append(json.loads(kept.read_text(encoding="utf-8")))
        print(json.dumps(rows[-1]), flush=True)
    write_results("public_drives", COLUMNS, rows, table(rows))


if __name__ == "__main__":
    main()
