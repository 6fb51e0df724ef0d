"""Contact pressure at the nodes of the flexible spline, for pictures."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from swgpar.fem.elements import BodyElements
from swgpar.fem.vectors import create_vector
from swgpar.solve.newton import NewtonSolver


def nodal_pressure(equilibrium: NewtonSolver, body: BodyElements) -> np.ndarray:
    """Mean pressure of cam and flanks around each node of the owned sectors; (n_sectors, n_local) MPa.

    Area-weighted by the shape functions over the faces of the last evaluation; collective.
    """
    n = len(equilibrium.local)
    sums = np.zeros((n, 3))  # force and area, as two components of a vector of the model

    def add(conn: np.ndarray, shape: np.ndarray, weight: np.ndarray, pressure: np.ndarray) -> None:
        free, shape_of = conn >= 0, "fqa" if shape.ndim == 3 else "qa"
        for k, load in enumerate((weight * pressure, weight)):
            nodal = np.einsum(f"fq,{shape_of}->fa", load, shape)[free]
            sums[:, k] += np.bincount(conn[free], nodal, minlength=n)

    scene = equilibrium.scene
    for contact, on in ((equilibrium.rigid, scene.cam), (equilibrium.pins, scene.pins)):
        if on is not None:
            own = contact.owned
            add(contact.conn[own], contact.shape, contact.weight[own], contact.pressure[own])
    teeth = equilibrium.teeth
    if scene.teeth is not None and teeth.faces is not None:
        own, faces = teeth.pair_owned[teeth.faces.patch], teeth.faces
        add(faces.conn[own], faces.shape[own], faces.weight[own], teeth.pressure[own])
    total = create_vector(equilibrium.partition)
    total.setValuesBlocked(equilibrium.local.number, sums, addv=PETSc.InsertMode.ADD_VALUES)
    total.assemble()
    force, area, _ = equilibrium.exchange(total).T
    mean = np.divide(force, area, out=np.zeros(n), where=area > 0.0)
    local = body.local[body.owned]
    return np.where(local >= 0, mean[local], 0.0)
