"""Distributed vectors of nodal unknowns: creation, ghost values, fields of sectors, multipliers."""

from __future__ import annotations

import numpy as np

from swgpar.fem.partition import Partition
from swgpar.geometry.rotation import to_images
from swgpar.petsc import PETSc


def create_vector(partition: Partition) -> PETSc.Vec:
    """Distributed vector of three unknowns per node, multipliers last."""
    return PETSc.Vec().createMPI(
        (3 * partition.n_own, 3 * partition.n_global), bsize=3, comm=partition.comm
    )


def sum_at_owners(partition: Partition, number: np.ndarray, values: np.ndarray) -> PETSc.Vec:
    """Vector of the sums over all ranks of values (n, 3) at the nodes with these global numbers
    (n,); collective."""
    vector = create_vector(partition)
    vector.setValuesBlocked(number, values, addv=PETSc.InsertMode.ADD_VALUES)
    vector.assemble()
    return vector


class Exchange:
    """Values of distributed vectors at the nodes with the given global numbers, (n,) int32.

    `destroy` releases its PETSc objects; Python alone does so late.
    """

    def __init__(self, partition: Partition, number: np.ndarray) -> None:
        self.target = PETSc.Vec().createSeq(3 * len(number), bsize=3)
        entries = (
            (3 * number[:, None] + np.arange(3, dtype=PETSc.IntType)).ravel().astype(PETSc.IntType)
        )
        source = PETSc.IS().createGeneral(entries, comm=PETSc.COMM_SELF)
        into = PETSc.IS().createStride(3 * len(number), 0, 1, comm=PETSc.COMM_SELF)
        template = create_vector(partition)
        self.scatter = PETSc.Scatter().create(template, source, self.target, into)
        for temporary in (template, source, into):
            temporary.destroy()

    def destroy(self) -> None:
        """Release the PETSc objects; collective."""
        self.scatter.destroy()
        self.target.destroy()

    def __call__(self, vector: PETSc.Vec) -> np.ndarray:
        """Local nodal values (n_local, 3) of a global vector, ghosts included."""
        self.scatter.scatter(
            vector, self.target, addv=PETSc.InsertMode.INSERT, mode=PETSc.ScatterMode.FORWARD
        )
        return self.target.array_r.reshape(-1, 3).copy()


def read_field(
    partition: Partition, body: str, sectors: np.ndarray, vector: PETSc.Vec
) -> np.ndarray:
    """Nodal values (n_sectors, n_node, 3) of any sectors, images rotated; collective."""
    number, sixths = partition.node_numbers(
        body, sectors, np.arange(len(partition.layouts[body].mesh.coords))
    )
    needed, position = np.unique(number, return_inverse=True)
    absent = int(len(needed) > 0 and needed[0] == -1)
    exchange = Exchange(partition, needed[absent:].astype(np.int32))
    values = exchange(vector)
    exchange.destroy()
    values = np.vstack([np.zeros((absent, 3)), values])[position.reshape(number.shape)]
    return partition.layouts[body].with_inner_nodes(sectors, to_images(values, sixths))


def write_field(partition: Partition, body: str, values: np.ndarray, vector: PETSc.Vec) -> None:
    """Set the owned entries of `vector` from values (n_sectors, n_node, 3) of the owned sectors."""
    nodes = np.arange(len(partition.layouts[body].mesh.coords))
    number, sixths = partition.node_numbers(body, partition.owned_indices(body), nodes)
    own = partition.owns(number) & (sixths == 0)
    vector.array.reshape(-1, 3)[number[own] - partition.row_start] = values[own]


def read_multipliers(partition: Partition, vector: PETSc.Vec) -> np.ndarray:
    """The multiplier entries of a full-length vector, on every rank."""
    comm, last, n = partition.comm, partition.comm.size - 1, partition.n_multipliers
    values = vector.array_r[-n:].copy() if partition.has_multipliers else np.empty(n)
    comm.Bcast(values, root=last)
    return values
