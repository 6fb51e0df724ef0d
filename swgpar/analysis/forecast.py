"""What a run will need: elements, unknowns, memory and time, from one tooth sector of each gear.

Memory and time of a gear's thin bodies grow linearly with the unknowns. The constants are those of runs on two cores
with 27,000 to 920,000 unknowns (docs/verification/forecast.md); other machines need more or less time.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from swgpar.analysis.drive_model import body_counts, build_layout
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.meshing import MeshRecipe, build_sector_meshes


@dataclass(frozen=True)
class Growth:
    """Needs of a run with default shortcuts and windows on two ranks: base + growing * unknowns / 100,000.

    memory, memory_base : GB of all ranks;  seconds, seconds_base : wall time
    """

    memory: float
    memory_base: float
    seconds: float
    seconds_base: float


GROWTH = {
    "plane": Growth(0.18, 0.61, 12.0, 4.3),
    "cup": Growth(0.54, 1.1, 23.0, 5.0),
}


@dataclass(frozen=True)
class Forecast:
    """elements : of the whole drive;  unknowns : modelled;  memory : GB of all ranks;  seconds : wall time"""

    elements: int
    unknowns: int
    memory: float
    seconds: float


def forecast(design: DriveDesign, recipe: MeshRecipe) -> Forecast:
    """Needs of a run with the default shortcuts, without condensed sectors.

    Raises InputError where the recipe gives no mesh.
    """
    counts = [body_counts(build_layout(design, mesh)) for mesh in build_sector_meshes(design, recipe).values()]
    unknowns = sum(count["dofs"] for count in counts)
    growth, size = GROWTH[design.drive.model], unknowns / 1e5
    return Forecast(
        elements=sum(count["elements_whole"] for count in counts),
        unknowns=unknowns,
        memory=growth.memory_base + growth.memory * size,
        seconds=growth.seconds_base + growth.seconds * size,
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
    """Memory (GB) that is free on this machine; infinite where it is not known."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        found = next(line for line in lines if line.startswith("MemAvailable:"))
        return float(found.split()[1]) * 1024.0 / 1e9
    except (OSError, StopIteration):  # no Linux
        return float("inf")
