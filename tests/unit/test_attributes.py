"""Objects are complete after their construction: no method adds an attribute."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from pathlib import Path

import swgpar

CONSTRUCTORS = ("__init__", "__post_init__")


def assigned(node: ast.AST) -> set[str]:
    """Attributes of self that are assigned in a function."""
    return {
        item.attr
        for item in ast.walk(node)
        if isinstance(item, ast.Attribute)
        and isinstance(item.ctx, ast.Store)
        and isinstance(item.value, ast.Name)
        and item.value.id == "self"
    }


def is_filled(cls: ast.ClassDef) -> bool:
    """Whether annotations alone make attributes: of a dataclass, a NamedTuple, a Protocol or a
    section of a design."""
    names = {ast.unparse(item).partition("(")[0] for item in (*cls.decorator_list, *cls.bases)}
    return bool(names & {"dataclass", "NamedTuple", "Protocol", "Section"})


def made(cls: ast.ClassDef, classes: Mapping[str, ast.ClassDef]) -> set[str]:
    """Attributes that the fields and constructors of a class and of its bases among `classes`
    make."""
    fields = [item for item in cls.body if isinstance(item, ast.AnnAssign)]
    names = {item.target.id for item in fields if item.value is not None or is_filled(cls)}
    assignments = [item for item in cls.body if isinstance(item, ast.Assign)]
    names |= {
        name.id for item in assignments for name in ast.walk(item) if isinstance(name, ast.Name)
    }
    bases = [ast.unparse(base) for base in cls.bases]
    return names.union(
        *(assigned(item) for item in functions_of(cls) if item.name in CONSTRUCTORS),
        *(made(classes[base], classes) for base in bases if base in classes),
    )


def functions_of(cls: ast.ClassDef) -> list[ast.FunctionDef]:
    return [item for item in cls.body if isinstance(item, ast.FunctionDef)]


def added(cls: ast.ClassDef, classes: Mapping[str, ast.ClassDef]) -> Iterator[str]:
    """Attributes that methods of a class add to those that `made` finds."""
    known = made(cls, classes)
    for function in functions_of(cls):
        yield from (
            f"{cls.name}.{function.name} adds {name}" for name in sorted(assigned(function) - known)
        )


def test_no_attribute_appears_outside_a_constructor() -> None:
    trees = [
        ast.parse(path.read_text(encoding="utf-8"))
        for path in Path(swgpar.__file__).parent.rglob("*.py")
    ]
    classes = [node for tree in trees for node in ast.walk(tree) if isinstance(node, ast.ClassDef)]
    by_name = {cls.name: cls for cls in classes}
    assert not [found for cls in classes for found in added(cls, by_name)]


def test_a_bare_annotation_makes_no_attribute() -> None:
    method = "    def set(self) -> None:\n        self.x = 1"
    plain, data = (
        ast.parse(f"{head}:\n    x: int\n{method}").body[0]
        for head in ("class A", "@dataclass\nclass B")
    )
    assert list(added(plain, {})) == ["A.set adds x"] and not list(added(data, {}))


def test_the_constructor_of_a_base_makes_attributes() -> None:
    base, derived = ast.parse(
        "class A:\n    def __init__(self) -> None:\n        self.x = 0\n"
        "class B(A):\n    def set(self) -> None:\n        self.x = self.y = 1"
    ).body
    assert list(added(derived, {"A": base})) == ["B.set adds y"]
