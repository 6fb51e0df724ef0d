"""The modules that one number of a design file passes on its way to the figures of a run.

    PYTHONPATH=TREE python scripts/number_path.py load.torque 1.2345 --design FILE --mesh RECIPE

Runs the design with that value on one rank and watches every function of the package at its end. A module is on the way
when one of its functions holds the number: as a number (in any unit of UNITS), in a text, in a list, a table or a small
array, or in a load state. Prints the modules in the order in which the number reaches them, with their functions, and
counts: modules, functions, lines of these functions.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
import tempfile
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import numpy as np

UNITS = (1.0, 1000.0, 500.0)
"""N·m; N·mm; N·mm of half of the drive."""

STATES = ("LoadState", "Scene")
"""Classes whose attributes are searched: load states are handed from function to function."""


class Watch:
    """Remembers the functions of a package in which a number was seen."""

    def __init__(self, package: str, value: float, text: str) -> None:
        self.package, self.text = package, text
        self.values = np.array([value * unit for unit in UNITS])
        self.seen: dict[CodeType, str] = {}

    def is_number(self, value: Any) -> bool:
        """Whether a number or a small array has the value."""
        array = np.abs(np.asarray(value, dtype=float))
        return bool(np.isclose(array.ravel()[:, None], self.values, rtol=1e-12, atol=0.0).any())

    def holds(self, value: Any, depth: int = 2) -> bool:
        """Whether a value is the number, or a text, a container or a load state that has it."""
        if isinstance(value, bool):
            return False
        if isinstance(value, (int, float, np.floating)):
            return self.is_number(value)
        if isinstance(value, np.ndarray):
            return value.dtype.kind == "f" and 0 < value.size < 200 and self.is_number(value)
        if isinstance(value, (str, bytes)):
            text = value if isinstance(value, str) else value.decode("utf-8", "replace")
            return self.text in text
        if depth == 0:
            return False
        if isinstance(value, dict):
            return any(self.holds(item, depth - 1) for item in value.values())
        if isinstance(value, (list, tuple)):
            return len(value) < 200 and any(self.holds(item, depth - 1) for item in value)
        if type(value).__name__ in STATES and dataclasses.is_dataclass(value):
            return any(self.holds(item, 0) for item in vars(value).values())
        return False

    def __call__(self, frame: FrameType, event: str, result: Any) -> None:
        """Called at the end of every function (`sys.setprofile`)."""
        module = frame.f_globals.get("__name__", "")
        if event != "return" or not module.startswith(f"{self.package}.") or frame.f_code in self.seen:
            return
        if self.holds(result) or any(self.holds(value) for value in frame.f_locals.values()):
            self.seen[frame.f_code] = module

    def functions(self) -> dict[str, dict[str, int]]:
        """Lines of every function in which the number was seen, by module; comprehensions are part of functions."""
        found: dict[str, dict[str, int]] = {}
        for code, module in self.seen.items():
            lines = [line for *_, line in code.co_lines() if line is not None]
            functions = found.setdefault(module, {})
            if not code.co_name.startswith("<"):
                functions[code.co_qualname] = max(lines) - code.co_firstlineno + 1
        return found


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("key")
    options.add_argument("value")
    options.add_argument("--design", required=True)
    options.add_argument("--mesh", required=True)
    options.add_argument("--set", nargs="*", default=[])
    chosen = options.parse_args()
    from swgpar import cli

    watch = Watch("swgpar", float(chosen.value), chosen.value)
    with tempfile.TemporaryDirectory() as folder:
        settings = [f"{chosen.key}={chosen.value}", *chosen.set]
        arguments = [
            "run",
            chosen.design,
            "--mesh",
            chosen.mesh,
            "--plain",
            "--out",
            str(Path(folder) / "out"),
            "--set",
            *settings,
        ]
        sys.setprofile(watch)
        try:
            code = cli.main(arguments)
        except SystemExit as end:
            code = end.code
        finally:
            sys.setprofile(None)
    if code:
        raise SystemExit(code)
    found = watch.functions()
    for number, (module, functions) in enumerate(found.items(), start=1):
        print(f"{number:3d}  {module}: {', '.join(functions)}")
    lines = [count for functions in found.values() for count in functions.values()]
    print(f"{len(found)} modules, {len(lines)} functions of {sum(lines)} lines")


if __name__ == "__main__":
    main()
