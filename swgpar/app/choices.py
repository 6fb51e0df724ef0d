"""What has been chosen beside the designs, kept in the workspace."""

from __future__ import annotations

import contextlib
import json
import os
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from swgpar.results.atomic import to_json, write_file

RECORD = "app.json"
"""File of the workspace with the choices."""

USUAL = "usual"
"""The mesh of a command without `--mesh`."""


def most_ranks() -> int:
    """Ranks of a job: the cores of this machine."""
    return os.cpu_count() or 1


@dataclass
class Choices:
    """Choices that another window and the next server show, too.

    shown, beside : names of variants, empty for none
    mesh, accuracy, ranks : of jobs; an empty accuracy is that of the mesh
    is_solid : whether the loaded states of drives in 3D are wanted
    """

    shown: str = ""
    beside: str = ""
    mesh: str = USUAL
    accuracy: str = ""
    ranks: int = min(2, most_ranks())
    is_solid: bool = False

    @property
    def options(self) -> list[str]:
        """Options of a run and of a rating."""
        chosen = {"--mesh": self.mesh, "--accuracy": self.accuracy}
        return [part for pair in chosen.items() if pair[1] not in (USUAL, "") for part in pair]

    def keep(self, folder: Path) -> None:
        """Write the choices into a workspace."""
        write_file(folder / RECORD, to_json(asdict(self)))


def read_choices(folder: Path) -> Choices:
    """The choices of a workspace; the usual ones where there is no record, or no valid one."""
    with contextlib.suppress(OSError, ValueError, TypeError, AttributeError):
        record = json.loads((folder / RECORD).read_text(encoding="utf-8"))
        usual = asdict(Choices())
        valid = all(type(record.get(name)) is type(value) for name, value in usual.items())
        if valid and 1 <= record["ranks"] <= most_ranks():
            return Choices(**{one.name: record[one.name] for one in fields(Choices)})
    return Choices()
