"""The rooms of the package in the order of the data: a module imports only from its own room and those before it."""

from __future__ import annotations

ROOMS = (
    "rooms",
    "errors",
    "log",
    "input",
    "geometry",
    "design",
    "kernel",
    "meshing",
    "fem",
    "contact",
    "constraints",
    "solve",
    "results",
    "gear_trains",
    "analysis",
    "studies",
    "cli",
)
