"""What the files of studies and of optimisations have in common: they describe many runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Literal, TypeVar

from swgpar.errors import InputError
from swgpar.input.quantities import Section, quantity, show, show_key
from swgpar.meshing.recipe import is_recipe_name
from swgpar.systems import System


class RunsSection(Section):
    """Keys that the only section of such a file has."""

    title: str = quantity("", text="title of the report")
    remarks: str = quantity("", text="text for the report; a blank line ends a paragraph")
    design: str = quantity(text="the design file, relative to this file")
    set: list[str] = quantity([], text='"section.key=value" for all designs')
    parallel: Literal["cases", "ranks"] = quantity(
        "cases", text="every rank works on designs of its own, or all on one after the other"
    )


S = TypeVar("S", bound=RunsSection)


@dataclass(frozen=True)
class RunFile(Generic[S]):
    """The checked content of such a file.

    name : the file in messages;  folder : other paths are relative to it
    text : the content, for the report;  section : its only section
    """

    name: str
    folder: Path
    text: str
    section: S

    @property
    def title(self) -> str:
        """Title of the report; without one the name of the file."""
        return self.section.title or Path(self.name).stem

    def mesh(self, recipe: str) -> Path:
        """Path of a mesh recipe: its name in the package, or relative to this file."""
        return Path(recipe) if is_recipe_name(recipe) else self.folder / recipe


@contextmanager
def refusals_of(name: str) -> Iterator[None]:
    """Sentences that refuse what is in a file begin with its name."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{name}: {error}") from None


def require_only(section: str, table: Mapping[str, Any], kind: str) -> None:
    """Refuse a file that has more than one section. kind : of the file, with its article"""
    for key, value in table.items():
        if key != section or not isinstance(value, dict):
            raise InputError(
                f"{show_key(key)} = {show(value)} is not a section of {kind}: allowed [{section}]"
            )


def refuse_mesh(key: str, given: Any, system: System[Any, Any]) -> None:
    """Refuse a mesh recipe of systems that have no mesh."""
    if given:
        raise InputError(f"{key} has no meaning for {system.noun}: leave it out")


def flat(table: dict[str, Any], above: str = "") -> dict[str, Any]:
    """Tables in tables as one with dotted keys: in TOML, load.torque = 1 and "load.torque" = 1 then
    mean the same."""
    out: dict[str, Any] = {}
    for key, value in table.items():
        name = f"{above}{key}"
        out |= flat(value, f"{name}.") if isinstance(value, dict) else {name: value}
    return out
