"""The folder that the app works in: named variants of a design, with undo and redo."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from swgpar.api.ratings import load_rated_design
from swgpar.api.runs import load_design
from swgpar.app.choices import Choices
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError, OutputError
from swgpar.input.commented_file import commented_toml
from swgpar.input.quantities import show
from swgpar.input.toml_file import apply_overrides, read_toml, validate
from swgpar.results.atomic import to_json, write_file

NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]{0,59}")
"""Names of variants, which name files and folders."""

KEPT = "variants"
"""Folder of the workspace with the design files of all variants as they are."""

UNDONE, KEPT_CHANGES = 200, 20
"""Changes of a variant that can be undone, and those of them that the next server knows."""

HISTORY = "history.json"
"""End of the name of the file with these changes."""


def require_name(name: str) -> str:
    """The name of a variant. Raises InputError where it cannot name a file of the workspace."""
    if not NAME.fullmatch(name):
        raise InputError(
            f"name = {show(name)} is not allowed: letters, digits, _ and -, at most 60"
        )
    return name


def drive_of(table: dict[str, Any], values: Mapping[str, Any]) -> DriveDesign:
    """A checked drive from the content of its file and other values of its keys. Raises
    InputError, also for gear trains."""
    changed = apply_overrides(table, values)
    if "rating" in changed:
        return load_rated_design(changed)
    design = load_design(changed)
    if not isinstance(design, DriveDesign):
        raise InputError("the app shows drives: the file is that of a gear train")
    return design


def has_section(path: Path, section: str) -> bool:
    """Whether a file has a line that begins the section [SECTION]."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return False
    return any(line.strip().startswith(f"[{section}]") for line in lines)


def read_changes(path: Path) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Contents of design files that undo and redo lead to; none where there is no such file.

    Raises InputError where a user has changed it into something else. What a design says about
    the fit of its keys is left to undo, which takes a profile for each of them.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return [], []
    except (OSError, ValueError) as error:
        raise InputError(f"{path.name} cannot be read: {error}") from None
    try:
        changes = json.loads(text)
        before, after = changes["before"], changes["after"]
        tables = [*before, *after]
    except (ValueError, TypeError, KeyError):
        raise InputError(f'{path.name} has no lists "before" and "after"') from None
    for table in tables:
        if not isinstance(table, dict):
            raise InputError(f"{path.name}: {show(table)} is no design: allowed are its sections")
        validate(DriveDesign, table)
    return before, after


@dataclass
class Variant:
    """A design under a name, and its former and later states.

    before, after : contents of design files that undo and redo lead to, the nearest one last
    dragged : key that a slider changes while it moves; one step of undo is its whole way
    """

    name: str
    design: DriveDesign
    before: list[dict[str, Any]] = field(default_factory=list)
    after: list[dict[str, Any]] = field(default_factory=list)
    dragged: str = ""

    def change(self, values: Mapping[str, Any], *, dragged: str = "") -> None:
        """Set keys of the design; a value of None leaves the key, or a section, out. Raises
        InputError, and keeps the design, where the values do not fit.

        dragged : key that a slider goes on changing
        """
        table = self.table
        for key in [key for key, value in values.items() if value is None]:
            *sections, name = key.split(".")
            inner = table
            for part in sections:
                inner = inner.get(part, {})
            inner.pop(name, None)
        given = {key: value for key, value in values.items() if value is not None}
        changed = drive_of(table, given)
        if changed.model_dump() == self.design.model_dump():
            return
        if not dragged or dragged != self.dragged:
            self.before = [*self.before[1 - UNDONE :], self.table]
        self.after.clear()
        self.design, self.dragged = changed, dragged

    def undo(self) -> bool:
        """Go back by one change; whether there was one."""
        return self._step(self.before, self.after)

    def redo(self) -> bool:
        """Take back an undo; whether there was one."""
        return self._step(self.after, self.before)

    def _step(self, source: list[dict[str, Any]], other: list[dict[str, Any]]) -> bool:
        if not source:
            return False
        design = drive_of(source[-1], {})
        source.pop()
        other.append(self.table)
        self.design, self.dragged = design, ""
        return True

    @property
    def table(self) -> dict[str, Any]:
        """Content of its design file."""
        return self.design.model_dump(exclude_unset=True)

    @property
    def text(self) -> str:
        """Its design file, with the meaning of every key."""
        return commented_toml(self.design)


class Workspace:
    """Variants of one folder, one of which is shown. Every change is kept in the folder
    `KEPT`, so that a server that is killed loses none.

    folder : resolved;  variants : by name;  shown : name of the one that is shown
    beside : name of the one that is compared with it, empty without one
    refused : sentences that refuse files of drives, by their names
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self.variants: dict[str, Variant] = {}
        self.shown = self.beside = ""
        self.refused: dict[str, str] = {}

    @property
    def variant(self) -> Variant:
        """The one that is shown."""
        return self.variants[self.shown]

    @property
    def other(self) -> Variant | None:
        """The one beside it."""
        return self.variants.get(self.beside)

    def free_name(self, stem: str) -> str:
        """A name that no variant has, from letters of another name."""
        stem, number = re.sub(r"[^A-Za-z0-9_-]", "_", stem)[:50] or "design", 2
        if stem not in self.variants and NAME.fullmatch(stem):
            return stem
        while f"{stem}_{number}" in self.variants:
            number += 1
        return f"{stem}_{number}"

    def add(self, name: str, design: DriveDesign) -> Variant:
        """A new variant, which is shown. Raises InputError where the name is taken or not
        allowed."""
        if require_name(name) in self.variants:
            raise InputError(f"name = {show(name)} is taken by another variant")
        self.variants[name] = Variant(name, design)
        self.shown = name
        return self.variants[name]

    def open(self, path: Path) -> Variant:
        """The variant of a design file of the folder, under the file's name."""
        return self.add(path.stem, drive_of(read_toml(path), {}))

    def keep(self) -> None:
        """Write the variant that is shown into `KEPT`, with its last changes."""
        folder, variant = self.folder / KEPT, self.variant
        folder.mkdir(exist_ok=True)
        write_file(folder / f"{self.shown}.toml", variant.text.encode())
        changes = {name: getattr(variant, name)[-KEPT_CHANGES:] for name in ("before", "after")}
        write_file(folder / f"{self.shown}.{HISTORY}", to_json(changes))

    def bring_back(self) -> None:
        """Open what an earlier server has kept; files that are no design any more are refused."""
        for path in sorted((self.folder / KEPT).glob("*.toml")):
            try:
                variant = self.open(path)
            except InputError as error:
                self.refused[f"{KEPT}/{path.name}"] = str(error)
                continue
            changes = path.with_suffix(f".{HISTORY}")
            try:
                variant.before, variant.after = read_changes(changes)
            except InputError as error:
                self.refused[f"{KEPT}/{changes.name}"] = f"{error}; undo begins anew"

    def open_all(self) -> None:
        """Open the designs of drives in the folder; other files and links are left. The first
        variant is shown."""
        for path in sorted(self.folder.glob("*.toml")):
            if path.stem not in self.variants and not path.is_symlink():
                try:
                    self.open(path)
                except InputError as error:
                    if has_section(path, "drive"):
                        self.refused[path.name] = str(error)
        self.shown = min(self.variants, default="")

    def show_again(self, choices: Choices) -> None:
        """Show the variants that an earlier server has shown last."""
        if choices.shown in self.variants:
            self.shown = choices.shown
            self.beside = choices.beside if choices.beside in self.variants else ""

    def save(self, *, overwrite: bool = False) -> Path:
        """Write the variant that is shown to NAME.toml. Raises OutputError where there is such a
        file, unless it is to be replaced."""
        path = self.folder / f"{self.shown}.toml"
        if path.is_symlink():
            raise OutputError(f"{path} is a link: the app writes files of its folder only")
        if path.exists() and not overwrite:
            raise OutputError(f"{path} exists: save under another name, or replace it")
        write_file(path, self.variant.text.encode())
        return path
