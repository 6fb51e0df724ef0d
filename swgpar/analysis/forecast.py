"""What a run will need, before anything is meshed: elements, unknowns, memory and time.

Memory and time of a gear's thin bodies grow linearly with the unknowns. The constants are those of
runs on two cores with 27,000 to 790,000 unknowns (docs/verification/forecast.md); other machines
need more or less time.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from mpi4py import MPI

from swgpar.analysis.shortcuts import SAMPLES, with_shortcuts
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError, OutOfMemoryError
from swgpar.load.load_sequence import program_points
from swgpar.meshing import MeshRecipe
from swgpar.meshing.sector_counts import sector_counts
from swgpar.petsc import is_out_of_memory


@dataclass(frozen=True)
class RunNeeds:
    """Needs of a default run on two ranks: base + growing * unknowns / 100,000.

    memory, memory_base : GB of all ranks;  seconds, seconds_base : wall time
    """

    memory: float
    memory_base: float
    seconds: float
    seconds_base: float


NEEDS = {
    "plane": RunNeeds(0.18, 0.61, 12.0, 4.3),
    "cup": RunNeeds(0.34, 1.31, 8.4, 17.4),
}
NEEDS["pancake"] = NEEDS["cup"]

START = 4.0
"""Increments that take as long as the rest of a default run: start, windows, evaluation, report."""


WHOLE_MESH = 7e-7
"""Memory (GB) for each element of the whole drive while its mesh is written: up to 670 bytes."""


def duration_text(seconds: float) -> str:
    """Seconds of a forecast, to one or two digits."""
    if seconds < 95.0:
        return f"{max(10.0 * round(seconds / 10.0), 10.0):.0f} s"
    return f"{seconds / 60.0:.0f} min"


@dataclass(frozen=True)
class Forecast:
    """elements : of the whole drive;  unknowns : modelled;  memory : GB;  seconds : wall time"""

    elements: int
    unknowns: int
    memory: float
    seconds: float


def forecast(design: DriveDesign, recipe: MeshRecipe) -> Forecast:
    """Needs of a run with the default shortcuts and the direct solver, without condensed sectors.

    The time grows with the increments beyond those of a default run, among them the points of a
    load program and the angles of [deviations], as if these were computed on the mesh of the run.
    Nothing is meshed. Raises InputError where the recipe lacks a section.
    """
    plane = design.drive.model == "plane"
    elements = unknowns = 0
    for gear, counts in sector_counts(design.geometry, recipe).items():
        fixed = (
            counts.outer if gear == design.kinematics.standing_gear and design.frame_is_rigid else 0
        )
        free = counts.nodes - counts.shared - fixed
        elements += counts.elements * counts.n_sectors
        unknowns += (2 if plane else 3) * free * (counts.n_sectors // design.copies)
    needs, size = NEEDS[design.drive.model], unknowns / 1e5
    usual = SAMPLES[design.drive.model]
    longer = max((START + _increments(design, recipe)) / (START + usual), 1.0)
    return Forecast(
        elements=elements,
        unknowns=unknowns,
        memory=needs.memory_base + needs.memory * size,
        seconds=longer * (needs.seconds_base + needs.seconds * size),
    )


def _increments(design: DriveDesign, recipe: MeshRecipe) -> int:
    """Increments of a run with shortcuts from the loaded state on, angles of [deviations] among
    them."""
    shortened = with_shortcuts(design, recipe).design
    steps, kinematics, deviations = shortened.steps, design.kinematics, design.deviations
    count = len(program_points(shortened))
    if not count and steps.samples:
        count = steps.samples * design.periods
    elif not count:
        count = 1 + math.ceil(steps.rotation / steps.increment)
    if deviations is not None:
        teeth = kinematics.teeth(kinematics.standing_gear)
        count += deviations.turns * teeth * deviations.angles_per_pitch
    return count


def fits(needs: Forecast, limit: float | None = None, comm: MPI.Comm = MPI.COMM_SELF) -> bool:
    """Whether a run fits into the memory of the machines, or into `limit` (GB); collective."""
    return needs.memory <= (free_memory(comm) if limit is None else limit)


def require_memory(
    needs: Forecast, limit: float | None = None, comm: MPI.Comm = MPI.COMM_SELF
) -> None:
    """Refuse what does not `fit`, with an InputError; collective."""
    if fits(needs, limit, comm):
        return
    free = free_memory(comm)
    allowed = f"the {free:.3g} GB that are free; solver.memory_limit sets another limit"
    if limit is not None:
        allowed = f"solver.memory_limit = {limit:g} GB ({free:.3g} GB are free)"
    raise InputError(
        f"the mesh has {needs.elements:,} elements and {needs.unknowns:,} unknowns, which need "
        f"about {needs.memory:.3g} GB of memory: allowed are meshes that need at most {allowed}"
    )


def require_memory_of_mesh(design: DriveDesign, recipe: MeshRecipe) -> None:
    """Refuse a mesh whose whole drive does not fit into the memory, with an InputError."""
    needs = forecast(design, recipe)
    whole = replace(needs, memory=WHOLE_MESH * needs.elements)
    require_memory(whole, design.solver.memory_limit)


def free_memory(comm: MPI.Comm = MPI.COMM_SELF) -> float:
    """Free memory (GB) of the machines of all ranks; infinite if it is not known. Collective."""
    node = comm.Split_type(MPI.COMM_TYPE_SHARED)
    here = _free_here() if node.rank == 0 else 0.0
    node.Free()
    return float(comm.allreduce(here))


def _free_here() -> float:
    """Memory (GB) that is free on this machine, or in the container around this process."""
    try:
        content = Path("/proc/meminfo").read_text(encoding="ascii")
        free = float(content.partition("MemAvailable:")[2].split()[0]) * 1024.0 / 1e9
    except (OSError, IndexError):  # no Linux
        return float("inf")
    group = Path("/sys/fs/cgroup")
    try:
        most, used = (
            int((group / f"memory.{name}").read_text(encoding="ascii"))
            for name in ("max", "current")
        )
    except (OSError, ValueError):  # no container, or none with a limit
        return free
    return min(free, max(most - used, 0) / 1e9)


@contextmanager
def reported_memory(needs: Forecast) -> Iterator[None]:
    """Turn an allocation that fails inside the block, on this rank, into an OutOfMemoryError."""
    # made before it is needed: then there may be no memory for it
    failure = OutOfMemoryError(
        f"not enough memory: {needs.unknowns:,} unknowns need about {needs.memory:.3g} GB on all "
        "ranks: take a coarser mesh, or more memory"
    )
    failure.alone = True
    try:
        yield
    except Exception as error:
        if not is_out_of_memory(error):
            raise
        raise failure from None
