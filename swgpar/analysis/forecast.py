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
from swgpar.analysis.turn_drive import (
    WORTH_GUESSES,
    checked_share,
    turn_design,
    turn_mesh,
    turned_pitches,
)
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError, OutOfMemoryError
from swgpar.load.load_sequence import program_points
from swgpar.meshing import MeshRecipe
from swgpar.meshing.race_sector import OUTER_RACE
from swgpar.meshing.sector_counts import race_counts, sector_counts
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

WITH_BEARING = 2.0
"""Newton iterations with balls over those on a rigid cam (docs/verification/forecast.md)."""

BY_GUESS, BY_LINEAR_MODEL = 0.45, 0.08
"""Times of an angle of whole turns from the guess of the linear model, and by this model alone,
over that of an increment on the same mesh (docs/verification/time_error.md)."""

EXTREME = 0.02
"""Share of the angles by Newton's iteration because they may be extreme, beside those that check
the linear model."""


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
    load program, and with the angles of [deviations] on their own mesh, as if no deviations
    repeated. Nothing is meshed. Raises InputError where the recipe lacks a section.
    """
    elements, unknowns = _counts(design, recipe)
    needs = NEEDS[design.drive.model]
    usual = SAMPLES[design.drive.model]
    shortened = with_shortcuts(design, recipe).design
    longer = max((START + _increments(shortened)) / (START + usual), 1.0)
    seconds = longer * (needs.seconds_base + _growing(design, unknowns))
    return Forecast(
        elements=elements,
        unknowns=unknowns,
        memory=needs.memory_base + needs.memory * unknowns / 1e5,
        seconds=seconds + _turn_seconds(shortened, recipe),
    )


def _counts(design: DriveDesign, recipe: MeshRecipe) -> tuple[int, int]:
    """Elements of the whole drive, and unknowns modelled."""
    dimensions = 2 if design.drive.model == "plane" else 3
    sectors = sector_counts(design.geometry, recipe)
    if design.bearing is not None:
        sectors[OUTER_RACE] = race_counts(design.geometry, recipe, design.race_width)
    elements = unknowns = 0
    for body, counts in sectors.items():
        fixed = (
            counts.outer if body == design.kinematics.standing_gear and design.frame_is_rigid else 0
        )
        free = counts.nodes - counts.shared - fixed
        elements += counts.elements * counts.n_sectors
        unknowns += dimensions * free * (counts.n_sectors // design.copies)
    return elements, unknowns


def _growing(design: DriveDesign, unknowns: int) -> float:
    """Seconds of a default run that grow with the unknowns."""
    share = 1.0 if design.bearing is None else WITH_BEARING
    return share * NEEDS[design.drive.model].seconds * unknowns / 1e5


def _increments(design: DriveDesign) -> int:
    """Increments of a run from the loaded state on."""
    steps = design.steps
    if points := program_points(design):
        return len(points)
    if steps.samples:
        return steps.samples * design.periods
    return 1 + math.ceil(steps.rotation / steps.increment)


def _turn_seconds(design: DriveDesign, recipe: MeshRecipe) -> float:
    """Seconds of the angles of [deviations]; 0 without them."""
    deviations = design.deviations
    if deviations is None:
        return 0.0
    pitches = turned_pitches(design)
    share, at_a_place = 1.0, pitches // design.kinematics.pitches
    if design.drive.model == "plane" and design.bearing is None and at_a_place >= WORTH_GUESSES:
        newton = 1.0
        if deviations.linear_model:
            newton = min(checked_share(at_a_place) + EXTREME, 1.0)
        share = newton * BY_GUESS + (1.0 - newton) * BY_LINEAR_MODEL
    unknowns = _counts(turn_design(design), turn_mesh(design, recipe))[1]
    of_increment = _growing(design, unknowns) / (START + SAMPLES[design.drive.model])
    return share * pitches * deviations.angles_per_pitch * of_increment


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
