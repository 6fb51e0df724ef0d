"""The ways of the design, the recipe, the torque and a stress through the package, for the
developer guide.

    python docs/generators/ways.py FOLDER

writes the counts of all ways (`ways.md`) and the stays of the torque (`way_of_the_torque.md`) into
the folder.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from _folder import output_folder

ROOT = Path(__file__).resolve().parents[2]
THINGS = {
    "design": "the design, from its file on",
    "recipe": "the mesh recipe",
    "torque": "the value of `load.torque`",
    "stress": "the largest stress of the history",
}


MOST = {"design": {"modules": 25, "climbs": 8}}
"""Largest counts of a way: a module that needs one part of the design takes that part."""


def measured() -> dict[str, dict[str, Any]]:
    """What `scripts/number_path.py` finds in a short run."""
    command = [
        sys.executable,
        str(ROOT / "scripts" / "number_path.py"),
        *THINGS,
        "--json",
        "--set",
        "steps.rotation=5",
    ]
    return json.loads(
        subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT).stdout
    )


def require_short(ways: dict[str, dict[str, Any]]) -> None:
    """End with a sentence where a way is longer than `MOST` allows."""
    for thing, limits in MOST.items():
        for name, most in limits.items():
            found = ways[thing]["counts"][name]
            if found > most:
                raise SystemExit(f"the way of the {thing} has {found} {name}: allowed are {most}")


def counts_table(ways: dict[str, dict[str, Any]]) -> str:
    """Counts of all ways."""
    rows = [
        "| what | modules | functions | lines of these functions | climbs |",
        "|---|---|---|---|---|",
    ]
    rows += [
        f"| {THINGS[name]} | {' | '.join(map(str, way['counts'].values()))} |"
        for name, way in ways.items()
    ]
    return "\n".join(rows) + "\n"


def stays_table(way: dict[str, Any]) -> str:
    """Modules of a way in the order of the first stays, with their functions."""
    functions: dict[str, list[str]] = {}
    for stay in way["stays"]:
        functions.setdefault(stay["module"].removeprefix("swgpar."), []).extend(stay["functions"])
    rows = ["| module | functions |", "|---|---|"]
    for module, names in functions.items():
        rows.append(
            f"| `{module}` | {', '.join(f'`{name}`' for name in names if '<locals>' not in name)} |"
        )
    return "\n".join(rows) + "\n"


def main(folder: Path) -> None:
    """Write both tables."""
    ways = measured()
    require_short(ways)
    (folder / "ways.md").write_text(counts_table(ways), encoding="utf-8")
    (folder / "way_of_the_torque.md").write_text(stays_table(ways["torque"]), encoding="utf-8")


if __name__ == "__main__":
    main(output_folder(__doc__))
