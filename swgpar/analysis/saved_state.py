"""A solved state of a drive in a file: rows by sector, multipliers, and what is modelled in
full."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from swgpar.contact import friction
from swgpar.fem.body import FLEXIBLE_SPLINE, RING_GEAR
from swgpar.fem.vectors import read_field, write_field
from swgpar.model.drive_model import DriveModel
from swgpar.results import parallel_hdf5
from swgpar.results.parallel_hdf5 import Block


@dataclass(frozen=True)
class SolvedState:
    """What a state has beside its rows.

    multipliers : of the constraints
    modelled_sectors : teeth and sectors that are modelled in full, as
    `DiscreteProblem.modelled_sectors` gives them
    """

    multipliers: list[float]
    modelled_sectors: list[list[int]]

    @classmethod
    def of(cls, model: DriveModel) -> SolvedState:
        """Of the model's present state; collective."""
        return cls(model.problem.multipliers().tolist(), model.problem.modelled_sectors())


def state_rows(
    model: DriveModel, displacement: Mapping[str, np.ndarray] | None = None
) -> dict[str, Block]:
    """Displacements of all bodies by name, and with friction the tractions of the flanks;
    collective.

    displacement : by body, (n_sectors, n_local, 3) mm of the owned sectors; None reads those of the
    model's x
    """
    blocks, partition = {}, model.partition
    for name, layout in partition.layouts.items():
        first, end = partition.owned_sectors(name)
        if displacement is None:
            values = read_field(partition, name, np.arange(first, end), model.problem.x)
        else:
            values = np.ascontiguousarray(displacement[name])
        blocks[name] = Block(values, first, layout.count)
    if model.design.contact.friction:
        first, end = partition.owned_sectors(FLEXIBLE_SPLINE)
        for row, values in model.problem.flanks_of(RING_GEAR).traction_rows(first, end).items():
            blocks[row] = Block(values, first, partition.layouts[FLEXIBLE_SPLINE].count)
    return blocks


def restore_state(model: DriveModel, path: Path, solved: SolvedState) -> None:
    """Bring back a state from the rows in the file, on any number of ranks; collective."""
    partition, problem = model.partition, model.problem
    owned = {name: partition.owned_sectors(name) for name in partition.layouts}
    ranges = {name: (first, end - first) for name, (first, end) in owned.items()}
    arrays = parallel_hdf5.read_rows(path, model.comm, ranges)
    for name, sectors in owned.items():
        write_field(partition, name, np.arange(*sectors), arrays[name], problem.x)
    if model.comm.rank == model.comm.size - 1:
        problem.x.array[-partition.n_multipliers :] = solved.multipliers
    problem.resume_sectors(solved.modelled_sectors)
    if model.design.contact.friction:
        # a rank needs the flanks that its ring teeth face too
        every = (0, partition.layouts[FLEXIBLE_SPLINE].count)
        rows = parallel_hdf5.read_rows(path, model.comm, dict.fromkeys(friction.ROWS, every))
        problem.resume(friction.from_rows(rows))
