"""The ways of the design, of the recipe and of numbers through the package, from the file to the
report.

    PYTHONPATH=TREE python scripts/number_path.py design
    PYTHONPATH=TREE python scripts/number_path.py torque stress --json

TREE is the checkout that is measured: the present one or another. The script runs `swgpar run` and
`swgpar report` on one rank and watches every function of the package.

A function is on the way if it holds what is followed: as an argument, a local variable or its
result.

- design, recipe: an object of `DriveDesign` or `MeshRecipe`. Its own methods do not count: it is
asked, not handed on.
- torque: the value of `load.torque` in N·m, N·mm, or N·mm of half of the drive.
- stress: the largest `fs_s1` of the history. A first run, in which all others are followed, gives
its value.

A number is also held by a text, a list, a small array or a frozen dataclass that has it. Every
function counts once, at its first entry that holds it. Nested functions without a name belong to
the function around them.

A *stay* is a series of entries into functions of one module. A *climb* is a stay in a module on a
higher level of the import graph than the stay before: a module stands one level above the highest
module that it imports. Modules that import each other share a level.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import io
import itertools
import json
import math
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import numpy as np
from import_graph import Graph, circles, file_graph, levels

PACKAGE = "swgpar"
CLASSES = {"design": "DriveDesign", "recipe": "MeshRecipe"}
TORQUE = "1.2345"
"""Value of `load.torque`, N·m, that no other quantity of a run has."""

TORQUE_UNITS = (1.0, 1000.0, 500.0)
"""N·m; N·mm; N·mm of half of the drive."""

STRESS = "fs_s1"
"""Column of the history."""

MOST = 200
"""Largest number of values of an array or a list that is searched."""

DEPTH = 2
"""Levels of lists, dictionaries and dataclasses that are searched."""

LOOKS = 200
"""Calls of a function that are searched: a search costs more than most functions."""

Holds = Callable[[Any], bool]
"""Whether a value is, or has, what is followed."""

Profiler = Callable[[FrameType, str, Any], None]
"""What Python calls at the beginning and at the end of every function (`sys.setprofile`)."""


def of_class(name: str) -> Holds:
    """Recognises the objects of a class."""
    return lambda value: type(value).__name__ == name


class Number:
    """Recognises a number. values : in all its units;  texts : ways in which it is written"""

    def __init__(self, values: Sequence[float], texts: Sequence[str]) -> None:
        self.values, self.texts = values, texts

    def __call__(self, value: Any, depth: int = DEPTH) -> bool:
        if isinstance(value, bool):
            return False
        if isinstance(value, (int, float, np.floating)):
            return any(math.isclose(abs(value), own, rel_tol=1e-12) for own in self.values)
        if isinstance(value, np.ndarray):
            return (
                value.dtype.kind == "f"
                and value.size < MOST
                and any(map(self, value.ravel().tolist()))
            )
        if isinstance(value, (str, bytes)):
            text = value if isinstance(value, str) else value.decode("utf-8", "replace")
            return any(own in text for own in self.texts)
        return depth > 0 and any(self(item, depth - 1) for item in members(value))


def members(value: Any) -> Iterator[Any]:
    """What a short container or a frozen dataclass has."""
    if isinstance(value, dict):
        yield from value.values()
    elif isinstance(value, (list, tuple)) and len(value) < MOST:
        yield from value
    elif is_frozen(value):
        yield from vars(value).values()


def is_frozen(value: Any) -> bool:
    """Whether a value is an object of a frozen dataclass."""
    parameters = getattr(type(value), "__dataclass_params__", None)
    return parameters is not None and parameters.frozen and hasattr(value, "__dict__")


class Watch:
    """Remembers the first entry of every function of a package that holds something.

    asked : whether methods whose `self` is what is followed do not count
    """

    def __init__(self, package: str, holds: Holds, asked: bool = False) -> None:
        self.package, self.holds, self.asked = package, holds, asked
        self.entries, self.open = 0, [0]
        self.first: dict[CodeType, tuple[int, str]] = {}
        self.looks: Counter[CodeType] = Counter()

    def __call__(self, frame: FrameType, event: str, result: Any) -> None:
        """Called at the beginning and at the end of every function (`sys.setprofile`)."""
        if event == "call":
            self.entries += 1
            self.open.append(self.entries)
        elif event == "return":
            self._leave(frame, self.open.pop() if len(self.open) > 1 else 0, result)

    def _leave(self, frame: FrameType, entry: int, result: Any) -> None:
        code, module = frame.f_code, frame.f_globals.get("__name__", "")
        if not module.startswith(f"{self.package}.") or "<" in (
            code.co_name[0],
            code.co_filename[0],
        ):
            return
        if code in self.first and self.first[code][0] <= entry:
            return
        self.looks[code] += 1
        if self.looks[code] > LOOKS:
            return
        values = dict(frame.f_locals)
        if self.asked and self.holds(values.get("self")):
            return
        if self.holds(result) or any(map(self.holds, values.values())):
            self.first[code] = entry, module

    def way(self) -> list[tuple[str, CodeType]]:
        """Modules and functions in the order of their entries."""
        ordered = sorted(self.first.items(), key=lambda item: item[1][0])
        return [(module, code) for code, (_, module) in ordered]


def together(watches: Sequence[Watch]) -> Profiler:
    """All watches in one run."""

    def each(frame: FrameType, event: str, result: Any) -> None:
        if event in ("call", "return"):
            for watch in watches:
                watch(frame, event, result)

    return each


def module_levels(graph: Graph) -> dict[str, int]:
    """Level of every module; those that import each other have the same one."""
    group = {name: name for name in graph} | {
        name: members[0] for members in circles(graph) for name in members
    }
    merged: Graph = {head: set() for head in group.values()}
    for name, needs in graph.items():
        merged[group[name]] |= {group[other] for other in needs} - {group[name]}
    level = levels(merged)
    return {name: level[group[name]] for name in graph}


def lines_of(code: CodeType) -> int:
    """Lines of a function."""
    return max(line for *_, line in code.co_lines() if line is not None) - code.co_firstlineno + 1


@dataclass(frozen=True)
class Stay:
    """A series of entries into functions of one module.

    level : of the module;  climb : whether it is higher than that of the stay before;  lines : of
    the functions
    """

    module: str
    level: int
    climb: bool
    functions: list[str]
    lines: int


@dataclass(frozen=True)
class Way:
    """The way of a thing."""

    stays: list[Stay]

    def counts(self) -> dict[str, int]:
        """What is compared between checkouts."""
        return {
            "modules": len({stay.module for stay in self.stays}),
            "functions": sum(len(stay.functions) for stay in self.stays),
            "lines": sum(stay.lines for stay in self.stays),
            "climbs": sum(stay.climb for stay in self.stays),
        }


def find_way(watch: Watch, level: dict[str, int]) -> Way:
    """The way that a watch has seen, on the levels of its package."""
    stays: list[Stay] = []
    for module, entries in itertools.groupby(watch.way(), key=lambda entry: entry[0]):
        codes = [code for _, code in entries]
        climb = bool(stays) and level[module] > stays[-1].level
        names, lines = [code.co_qualname for code in codes], sum(map(lines_of, codes))
        stays.append(Stay(module, level[module], climb, names, lines))
    return Way(stays)


def run(arguments: list[str], watch: Profiler | None = None) -> None:
    """Execute a command of the package, watched or not; what it prints is dropped."""
    from swgpar import cli

    with contextlib.redirect_stdout(io.StringIO()):
        sys.setprofile(watch)
        try:
            code = cli.main(arguments)
        except SystemExit as end:
            code = end.code
        finally:
            sys.setprofile(None)
    if code:
        raise SystemExit(code)


def largest_stress(history: Path) -> float:
    """Largest value of the column of stresses."""
    with history.open(encoding="utf-8", newline="") as file:
        return max(float(row[STRESS]) for row in csv.DictReader(file))


def measure(
    things: Sequence[str], design: str, mesh: str, settings: Sequence[str]
) -> dict[str, Way]:
    """The ways of things in a run of a design and in the report of its results."""
    watches = {
        name: Watch(PACKAGE, of_class(CLASSES[name]), asked=True)
        for name in things
        if name in CLASSES
    }
    if "torque" in things:
        values = [float(TORQUE) * unit for unit in TORQUE_UNITS]
        watches["torque"] = Watch(PACKAGE, Number(values, [TORQUE]))
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "out")
        command = ["run", design, "--mesh", mesh, "--out", out, "--overwrite"]
        command += ["--set", f"load.torque={TORQUE}", *settings]
        report = ["report", out]
        first = together(list(watches.values())) if watches else None
        run(command, first)
        if first:
            run(report, first)
        if "stress" in things:
            value = largest_stress(Path(out) / "history.csv")
            watches["stress"] = Watch(PACKAGE, Number([value], [repr(value), f"{value:.4g}"]))
            run(command, watches["stress"])
            run(report, watches["stress"])
    package = Path(sys.modules[PACKAGE].__file__ or "").parent
    level = module_levels(file_graph(package))
    return {name: find_way(watches[name], level) for name in things}


def main() -> None:
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("things", nargs="+", choices=["design", "torque", "recipe", "stress"])
    options.add_argument("--design", default="drivers/plane_half_turn.toml")
    options.add_argument("--mesh", default="plane_coarse")
    options.add_argument("--set", nargs="*", default=[], help="keys of the design file")
    options.add_argument("--json", action="store_true", help="print JSON")
    chosen = options.parse_args()
    ways = measure(chosen.things, chosen.design, chosen.mesh, chosen.set)
    if chosen.json:
        content = {
            name: {"counts": way.counts(), "stays": [asdict(stay) for stay in way.stays]}
            for name, way in ways.items()
        }
        print(json.dumps(content, indent=1))
        return
    for name, way in ways.items():
        print(f"{name}:")
        for k, stay in enumerate(way.stays, start=1):
            mark = "climb" if stay.climb else ""
            functions = ", ".join(stay.functions)
            print(f"{k:3d}  level {stay.level:2d} {mark:6s}{stay.module}: {functions}")
        print(", ".join(f"{count} {count_of}" for count_of, count in way.counts().items()))


if __name__ == "__main__":
    main()
