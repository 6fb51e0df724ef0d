"""Temperatures and the growth of a rigid frame in a job of CalculiX.

`*EXPANSION` stands with the materials in the mesh. With finite rotations a free body of CalculiX
has the stretch 1 + a by the growth a, as here.
"""

from __future__ import annotations

from collections.abc import Iterator

from swgpar.design.drive_design import DriveDesign
from swgpar.exchange.calculix_model import JobModel


def is_heated(design: DriveDesign) -> bool:
    """Whether a gear has another temperature than `load.reference_temperature`."""
    return any(design.temperature_rises[gear] for gear in design.gears)


def initial_temperature(model: JobModel, *others: str) -> Iterator[str]:
    """The reference temperature of all nodes, before the first step; nothing without a heated
    gear. others : sets of nodes beside those of the gears, which stay at it"""
    if not is_heated(model.design):
        return
    yield from ("*NSET, NSET=FLEXIBLE_SPLINE_NODES, GENERATE", f"1, {model.n_spline}")
    yield "*NSET, NSET=RING_GEAR_NODES, GENERATE"
    yield f"{model.n_spline + 1}, {len(model.points)}"
    reference = model.design.load.reference_temperature
    yield "*INITIAL CONDITIONS, TYPE=TEMPERATURE"
    yield from (f"{nodes}, {reference:.12g}" for nodes in ("ALL_NODES", *others))


def temperatures(model: JobModel) -> Iterator[str]:
    """Temperatures of the gears, in the first step; further steps keep them."""
    if not is_heated(model.design):
        return
    reference, rises = model.design.load.reference_temperature, model.design.temperature_rises
    yield "*TEMPERATURE"
    for gear in model.design.gears:
        yield f"{gear.upper()}_NODES, {reference + rises[gear]:.12g}"


def grown_frame(model: JobModel) -> list[str]:
    """Displacements of the ring gear's outer nodes by a frame that grows or is smaller; empty
    without."""
    growth = model.design.frame_growth
    if not growth:
        return []
    nodes = model.surface(model.ring, "outer").nodes
    return model.displaced(nodes, growth.of(model.points[nodes]))
