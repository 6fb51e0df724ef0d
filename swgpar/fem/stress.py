"""Principal and von Mises stresses at the nodes, and their maxima over a body."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from swgpar.fem.elements import BodyElements
from swgpar.meshing.sector import SectorMesh

TENSOR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
"""Indices of the components xx yy zz xy yz zx in a tensor (3, 3)."""


def principal(stress: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Largest and smallest principal and von Mises stress, MPa, of (…, 6) xx yy zz xy yz zx."""
    s3, s2, s1 = np.moveaxis(np.linalg.eigvalsh(stress[..., TENSOR]), -1, 0)
    mises = np.sqrt(0.5 * ((s1 - s2) ** 2 + (s2 - s3) ** 2 + (s3 - s1) ** 2))
    return s1, s3, mises


def principal_at_nodes(
    mesh: SectorMesh, stress: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The same (n_sectors, n_node) of stresses (n_sectors, n_node, 6) at the nodes of sectors: both
    layers of the plane are alike."""
    if mesh.lower_nodes is None:
        return principal(stress)
    nodes, index = np.unique(mesh.lower_nodes, return_inverse=True)
    s1, s3, mises = (values[:, index] for values in principal(stress[:, nodes]))
    return s1, s3, mises


def rotated_tensor(stress: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Tensors (..., 6) xx yy zz xy yz zx, rotated about z by angles (...) rad."""
    c, s = np.cos(angle), np.sin(angle)
    xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
    return np.stack(
        [
            c * c * xx - 2.0 * c * s * xy + s * s * yy,
            s * s * xx + 2.0 * c * s * xy + c * c * yy,
            zz,
            c * s * (xx - yy) + (c * c - s * s) * xy,
            s * zx + c * yz,
            c * zx - s * yz,
        ],
        axis=-1,
    )


def body_fields(body: BodyElements, u: np.ndarray) -> dict[str, np.ndarray]:
    """Displacement, stress tensor, s1, s3 and von Mises stress at the nodes of the owned sectors.

    Nodes between a gear and its housing have the stress of the gear.
    """
    mesh, tensor = body.layout.mesh, body.nodal_stress(u)
    for part in range(1, len(mesh.parts)):
        nodes = np.setdiff1d(mesh.nodes_of(part), mesh.nodes_of(0))
        tensor[:, nodes] = body.nodal_stress(u, part)[:, nodes]
    s1, s3, mises = principal_at_nodes(mesh, tensor)
    displacement = body.displacement(u)[body.owned]
    return {"displacement": displacement, "stress": tensor, "s1": s1, "s3": s3, "vm": mises}


def part_maxima(
    comm: MPI.Comm, body: BodyElements, u: np.ndarray, fields: dict[str, np.ndarray]
) -> list[dict[str, float]]:
    """Maxima (MPa) over each part of a body: s1, s3 (positive in compression) and vm; collective.

    fields : of the body at displacement u (n_local, 3) mm, as `body_fields` gives them
    """
    mesh = body.layout.mesh
    if len(mesh.parts) == 1:
        return [maxima(comm, fields)]
    gear = {name: fields[name][:, mesh.nodes_of(0)] for name in ("s1", "s3", "vm")}
    housing = dict(zip(("s1", "s3", "vm"), principal(body.nodal_stress(u, 1)[:, mesh.nodes_of(1)])))
    return [maxima(comm, gear), maxima(comm, housing)]


def maxima(comm: MPI.Comm, fields: dict[str, np.ndarray]) -> dict[str, float]:
    """Maxima over the whole body (MPa): s1, s3 (positive in compression) and vm."""
    s1 = fields["s1"].max(initial=-np.inf)
    values = {"s1": s1, "s3": -fields["s3"].min(initial=np.inf), "vm": fields["vm"].max(initial=0)}
    return {name: float(comm.allreduce(value, op=MPI.MAX)) for name, value in values.items()}
