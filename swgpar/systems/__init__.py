"""Kinds of systems that swgpar computes: drives on meshes, and gear trains. `registry` lists
them."""

from swgpar.systems.protocol import Measured, Result, System
from swgpar.systems.registry import SYSTEMS, system_of_section, system_of_table

__all__ = [
    "SYSTEMS",
    "Measured",
    "Result",
    "System",
    "system_of_section",
    "system_of_table",
]
