"""What a run will need: elements, unknowns, memory and time, from one tooth sector of each gear.

Memory and time grow with the unknowns as the factor of the tangent does. The constants are those of runs on two cores
(docs/verification/forecast.md); other machines need more or less time.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from swgpar.analysis.drive_model import body_counts, build_layout
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.meshing import MeshRecipe, build_sector_meshes


@dataclass(frozen=True)
class Growth:
    """Needs of a run with 100,000 unknowns on two ranks, and the exponents with which they grow.

    memory : GB of all ranks;  base : GB of them that do not grow;  seconds : of a default run
    """

    memory: float
    base: float
    memory_exponent: float
    seconds: float
    time_exponent: float


GROWTH = {
    "plane": Growth(memory=0.5, base=0.3, memory_exponent=1.05, seconds=40.0, time_exponent=1.1),
    "cup": Growth(memory=0.5, base=0.3, memory_exponent=1.2, seconds=25.0, time_exponent=1.3),
}


@dataclass(frozen=True)
class Forecast:
    """elements : of the whole drive;  unknowns : modelled;  memory : GB of all ranks;  seconds : wall time"""

    elements: int
    unknowns: int
    memory: float
    seconds: float


def forecast(design: DriveDesign, recipe: MeshRecipe) -> Forecast:
    """Needs of a run with the default shortcuts. Raises InputError where the recipe gives no mesh."""
    counts = [body_counts(build_layout(design, mesh)) for mesh in build_sector_meshes(design, recipe).values()]
    unknowns = sum(count["dofs"] for count in counts)
    growth, size = GROWTH[design.drive.model], unknowns / 1e5
    return Forecast(
        elements=sum(count["elements_whole"] for count in counts),
        unknowns=unknowns,
        memory=growth.base + growth.memory * size**growth.memory_exponent,
        seconds=growth.seconds * size**growth.time_exponent,
    )


def require_memory(needs: Forecast) -> None:
    """Refuse what does not fit into the memory of this machine, with an InputError."""
    free = free_memory()
    if needs.memory > free:
        raise InputError(
            f"the mesh has {needs.unknowns:,} unknowns, which need about {needs.memory:.3g} GB of memory: allowed are "
            f"meshes that need less than the {free:.3g} GB that are free"
        )


def free_memory() -> float:
    """Memory (GB) that is free on this machine."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        found = next(line for line in lines if line.startswith("MemAvailable:"))
        return float(found.split()[1]) * 1024.0 / 1e9
    except (OSError, StopIteration):  # no Linux: without what caches could give back
        return os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 1e9
