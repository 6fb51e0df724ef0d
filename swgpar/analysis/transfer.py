"""A state of a drive on another mesh, or of another part of it."""

from __future__ import annotations

from collections.abc import Mapping

from scipy.sparse import csr_matrix

from swgpar.fem.vectors import read_field, write_field
from swgpar.geometry.rotation import rotated
from swgpar.meshing.interpolation import interpolated, interpolation
from swgpar.model.drive_model import DriveModel
from swgpar.petsc import PETSc


def meshed_alike(first: DriveModel, second: DriveModel) -> bool:
    """Whether the sectors of two models have the same nodes, at places of their own."""
    layouts, others = first.partition.layouts, second.partition.layouts
    return layouts.keys() == others.keys() and all(
        len(layout.mesh.coords) == len(others[body].mesh.coords)
        and layout.mesh.n_sectors == others[body].mesh.n_sectors
        for body, layout in layouts.items()
    )


Interpolations = Mapping[str, csr_matrix]
"""Matrices of `interpolation` from the sectors of one model to those of another one, by body."""


def interpolations(coarse: DriveModel, fine: DriveModel) -> Interpolations:
    """Those from the coarse model to the fine one."""
    return {
        body: interpolation(coarse.partition.layouts[body].mesh, layout.mesh)
        for body, layout in fine.partition.layouts.items()
    }


def transfer(
    coarse: DriveModel,
    x: PETSc.Vec,
    fine: DriveModel,
    y: PETSc.Vec,
    matrices: Interpolations | None,
) -> None:
    """Set y of the fine model to x of the coarse one, sector by sector; collective.

    One may model a part of the drive, and the other all of it: images of sectors are rotated.

    matrices : None where they are `meshed_alike`, so that values stay at their nodes
    """
    for body, layout in fine.partition.layouts.items():
        sectors = fine.partition.owned_indices(body)
        angle = layout.chain_angle(sectors)
        values = rotated(read_field(coarse.partition, body, sectors, x), -angle[:, None])
        if matrices is not None:
            values = interpolated(values, matrices[body])
        write_field(fine.partition, body, rotated(values, angle[:, None]), y)
    if fine.comm.rank == fine.comm.size - 1:
        n = fine.partition.n_multipliers
        y.array[-n:] = x.array_r[-n:]
