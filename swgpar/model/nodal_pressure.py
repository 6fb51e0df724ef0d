"""Contact pressure at the nodes of the flexible spline, for fields and figures."""

from __future__ import annotations

import numpy as np

from swgpar.contact.contact import FacePressure
from swgpar.fem.elements import BodyElements
from swgpar.fem.vectors import sum_at_owners
from swgpar.load.load_states import LoadState
from swgpar.solve.discrete_problem import DiscreteProblem


def nodal_pressure(problem: DiscreteProblem, state: LoadState, body: BodyElements) -> np.ndarray:
    """Mean pressure of all contacts around each node of the owned sectors; (n_sectors, n_local)
    MPa.

    Area-weighted by the shape functions over the faces of the last evaluation; collective.
    """
    n = len(problem.local_nodes)
    sums = np.zeros((n, 3))  # force and area, as two components of a vector of the model
    for contact in problem.pressure_contacts:
        faces = contact.owned_pressure() if contact.is_active(state) else None
        if faces is not None:
            _add_nodal(faces, sums)
    total = sum_at_owners(problem.partition, problem.local_nodes.number, sums)
    force, area, _ = problem.exchange(total).T
    total.destroy()
    mean = np.divide(force, area, out=np.zeros(n), where=area > 0.0)
    local = body.local[body.owned]
    return np.where(local >= 0, mean[local], 0.0)


def _add_nodal(faces: FacePressure, sums: np.ndarray) -> None:
    """Add forces (N) and areas (mm²) of faces to the columns 0 and 1 of sums (n_local, 3)."""
    free, subscripts = faces.conn >= 0, "fqa" if faces.shape.ndim == 3 else "qa"
    for k, load in enumerate((faces.weight * faces.pressure, faces.weight)):
        nodal = np.einsum(f"fq,{subscripts}->fa", load, faces.shape)[free]
        sums[:, k] += np.bincount(faces.conn[free], nodal, minlength=len(sums))
