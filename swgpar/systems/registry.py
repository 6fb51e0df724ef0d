"""The kinds of systems. A new one is an entry of `SYSTEMS`; command line, Python API and studies
then know it."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from swgpar.systems.protocol import System

SYSTEMS = {
    "gear_train": "swgpar.systems.gear_train.GEAR_TRAIN",
    "drive": "swgpar.systems.drive.DRIVE",
}
"""Section by which a design file is recognised -> where its system is. A system is imported when it
is needed: a run does not load what other systems compute with. A file with none of the sections is
read as the last one."""


def system_of_section(section: str) -> System[Any, Any]:
    """The kind of systems with this section, a key of `SYSTEMS`; a design has it as `system`."""
    module, _, name = SYSTEMS[section].rpartition(".")
    return getattr(import_module(module), name)


def system_of_table(table: Mapping[str, Any]) -> System[Any, Any]:
    """The kind of a design from the content of its file, or from the key "design" of a summary."""
    *_, last = SYSTEMS
    return system_of_section(next((section for section in SYSTEMS if section in table), last))
