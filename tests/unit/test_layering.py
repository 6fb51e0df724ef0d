"""The rooms of the package: what a module may import, no circle of files, no annotation missing
that would hide one."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import swgpar
from support.paths import ROOT as CHECKOUT
from support.scripts import load_script
from swgpar.rooms import PURPOSE, ROOMS
from swgpar.systems import SYSTEMS

graph = load_script(CHECKOUT / "scripts" / "import_graph.py")

ROOT = Path(swgpar.__file__).parent
MODULES = sorted(path.relative_to(ROOT) for path in ROOT.rglob("*.py"))
LOOSE = 8
"""Largest number of modules at the top of the package, `__init__` left aside."""


def room_of(module: Path) -> str:
    return module.parts[0].removesuffix(".py")


def public_functions(body: list[ast.stmt]) -> Iterator[ast.FunctionDef]:
    """Functions and methods that other modules may call."""
    for node in body:
        if isinstance(node, ast.ClassDef):
            yield from public_functions(node.body)
        elif isinstance(node, ast.FunctionDef) and (
            not node.name.startswith("_") or node.name.endswith("__")
        ):
            yield node


def unannotated(function: ast.FunctionDef) -> list[str]:
    arguments = function.args
    every = [
        *arguments.posonlyargs,
        *arguments.args,
        *arguments.kwonlyargs,
        arguments.vararg,
        arguments.kwarg,
    ]
    missing = [a.arg for a in every if a and a.annotation is None and a.arg not in ("self", "cls")]
    missing += [
        a.arg
        for a in every
        if a and a.arg == "design" and a.annotation and ast.unparse(a.annotation) == "Any"
    ]
    return missing + ([] if function.returns is not None else ["return"])


def test_every_module_is_in_a_room() -> None:
    assert {room_of(module) for module in MODULES} - {"__init__"} == set(ROOMS)
    assert len(set(ROOMS)) == len(ROOMS)


def test_few_modules_are_loose() -> None:
    assert (
        len([module for module in MODULES if len(module.parts) == 1 and module.stem != "__init__"])
        <= LOOSE
    )


@pytest.mark.parametrize("room", ROOMS)
def test_imports_come_from_the_same_room_or_from_those_before_it(room: str) -> None:
    allowed = ROOMS[: ROOMS.index(room) + 1]
    wrong = [
        f"{module} imports {name}"
        for module in MODULES
        if room_of(module) == room
        for name in graph.imported_names(ROOT / module, ROOT)
        if name == "swgpar" or name.split(".")[1] not in allowed
    ]
    assert not wrong


def test_no_files_import_each_other_in_a_circle() -> None:
    assert graph.circles(graph.file_graph(ROOT)) == []


def test_gear_trains_are_reached_through_the_registry() -> None:
    outside = {
        str(module)
        for module in MODULES
        if room_of(module) != "gear_trains"
        for name in graph.imported_names(ROOT / module, ROOT)
        if name.startswith("swgpar.gear_trains")
    }
    adapter, _, _ = SYSTEMS["gear_train"].removeprefix("swgpar.").rpartition(".")
    assert outside == {f"{adapter.replace('.', '/')}.py"}


def test_public_functions_are_annotated() -> None:
    """Without a type a parameter can be an object of a later room; a design is not `Any` either."""
    wrong = [
        f"{module}:{function.lineno} {function.name}: {', '.join(unannotated(function))}"
        for module in MODULES
        for function in public_functions(
            ast.parse((ROOT / module).read_text(encoding="utf-8")).body
        )
        if unannotated(function)
    ]
    assert not wrong


def test_the_rooms_are_described_as_they_are() -> None:
    lines = (CHECKOUT / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()
    first = lines.index("| room | purpose |") + 2
    assert lines[first : first + len(PURPOSE)] == [
        f"| `{room}` | {purpose} |" for room, purpose in PURPOSE.items()
    ]
    assert not lines[first + len(PURPOSE)].startswith("|")


def test_no_two_classes_or_aliases_of_types_have_one_name() -> None:
    places: dict[str, list[str]] = {}
    for module in MODULES:
        for node in ast.parse((ROOT / module).read_text(encoding="utf-8")).body:
            targets = node.targets if isinstance(node, ast.Assign) else [node]
            names = [getattr(one, "id", getattr(one, "name", "")) for one in targets]
            for name in names:
                # constants are upper-case, and so are type variables, of one letter
                if name[:1].isupper() and not name.isupper():
                    places.setdefault(name, []).append(str(module))
    assert not {name: found for name, found in places.items() if len(found) > 1}
