"""A part of a tooth sector: what is left when elements are removed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swgpar.meshing.sector import SectorMesh


def trimmed(mesh: SectorMesh, keep: NDArray[np.bool_]) -> SectorMesh:
    """The sector with the elements of the mask `keep` (n_elem,) only.

    The node set ``cut`` holds the nodes that kept and removed elements share, beside those that it
    has already. Sets, faces and flanks keep what is left of them; flanks must be left whole.
    """
    used = np.zeros(len(mesh.coords), dtype=bool)
    used[mesh.hexes[keep]] = True
    removed = np.zeros_like(used)
    removed[mesh.hexes[~keep]] = True
    removed[mesh.node_sets.get("cut", [])] = True
    number = np.cumsum(used) - 1

    def renumbered(nodes: NDArray[np.int32]) -> NDArray[np.int32]:
        return number[nodes].astype(np.int32)

    pairs = used[mesh.ccw_nodes]
    node_sets = {name: renumbered(nodes[used[nodes]]) for name, nodes in mesh.node_sets.items()}
    return replace(
        mesh,
        coords=mesh.coords[used],
        hexes=renumbered(mesh.hexes[keep]),
        ccw_nodes=renumbered(mesh.ccw_nodes[pairs]),
        cw_nodes=renumbered(mesh.cw_nodes[pairs]),
        faces={
            name: renumbered(faces[used[faces].all(axis=1)]) for name, faces in mesh.faces.items()
        },
        node_sets=node_sets | {"cut": renumbered(np.flatnonzero(used & removed))},
        flanks=tuple(replace(grid, nodes=renumbered(grid.nodes)) for grid in mesh.flanks),
    )
