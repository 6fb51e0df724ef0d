"""Bounds that refusals print, against the first value that is refused."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from support.paths import DRIVERS, REFERENCE
from support.right_files import newer_sections
from support.true_bounds import VERDICTS, Bound, bounds, count
from swgpar.input.toml_file import read_toml

DRIVES = {
    "cup": REFERENCE,
    "plane": DRIVERS / "plane_half_turn.toml",
    "three lobes": DRIVERS / "three_lobes.toml",
    "pancake": DRIVERS / "pancake.toml",
}
"""Drives all of whose numbers are changed, beside the newer sections."""

WRONG = ("other number", "no number")


def all_bounds(only: list[str] | None) -> dict[str, list[Bound]]:
    """Bounds by the name of the design. only : words of these names"""
    tables = {name: (read_toml(path), ()) for name, path in DRIVES.items()}
    for name, section in newer_sections().items():
        if section.kind != "optimisation":
            tables[name] = section.table, section.keys
    found = {}
    for name, (table, keys) in tables.items():
        if not only or any(word in name for word in only):
            found[name] = list(bounds(table, keys))
            print(f"{name}: {len(found[name])} bounds", flush=True)
    return found


def table(found: dict[str, list[Bound]]) -> list[list[str]]:
    """Counts of the verdicts by design."""
    rows = [["design", "bounds", *VERDICTS]]
    whole = [bound for one in found.values() for bound in one]
    for name, one in (*found.items(), ("all", whole)):
        rows.append([name, str(len(one)), *(str(n) for n in count(one).values())])
    return rows


def sentences(found: dict[str, list[Bound]]) -> list[dict[str, Any]]:
    """All bounds with their sentences."""
    return [{"design": name, **asdict(bound)} for name, one in found.items() for bound in one]


def faults(found: dict[str, list[Bound]]) -> list[dict[str, Any]]:
    """Bounds that are not the printed ones."""
    return [bound for bound in sentences(found) if bound["verdict"] in WRONG]
