"""The kinds of systems. A new one is an entry of `SYSTEMS`; command line, Python API and studies then know it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from swgpar.errors import InputError
from swgpar.input.design import Design
from swgpar.systems.drive import DRIVE
from swgpar.systems.gear_train import GEAR_TRAIN
from swgpar.systems.protocol import System

SYSTEMS: dict[str, System[Any, Any]] = {"gear_train": GEAR_TRAIN, "drive": DRIVE}
"""By name, in the order in which design files are recognised; a file of none of them is read as the last one."""


def system_of_table(table: Mapping[str, Any]) -> System[Any, Any]:
    """The kind of a design from the content of its file, or from the key "design" of a summary."""
    *_, last = SYSTEMS.values()
    return next((system for system in SYSTEMS.values() if system.section in table), last)


def system_of(design: Design) -> System[Any, Any]:
    """The kind of a checked design."""
    for system in SYSTEMS.values():
        if isinstance(design, system.design_type):
            return system
    raise InputError(f"{type(design).__name__} is not a design: allowed what swgpar.load_design returns")
