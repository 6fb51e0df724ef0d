"""Contact pressure at the nodes of the flexible spline, for pictures."""

from __future__ import annotations

import numpy as np

from swgpar.assembly import BodyElements


def nodal_pressure(equilibrium, body: BodyElements) -> np.ndarray:
    """Mean pressure of cam and flanks around each node of the owned sectors; (n_sectors, n_local) MPa.

    Area-weighted by the shape functions over the faces of the last evaluation.
    """
    n = len(equilibrium.local)
    force, area = np.zeros(n), np.zeros(n)

    def add(conn: np.ndarray, shape: np.ndarray, weight: np.ndarray, pressure: np.ndarray) -> None:
        free, shape_of = conn >= 0, "fqa" if shape.ndim == 3 else "qa"
        force[:] += np.bincount(
            conn[free], np.einsum(f"fq,{shape_of}->fa", weight * pressure, shape)[free], minlength=n
        )
        area[:] += np.bincount(conn[free], np.einsum(f"fq,{shape_of}->fa", weight, shape)[free], minlength=n)

    scene = equilibrium.scene
    for contact, on in ((equilibrium.rigid, scene.cam), (equilibrium.pins, scene.pins)):
        if on is not None:
            add(contact.conn, contact.shape, contact.weight, contact.pressure)
    teeth = equilibrium.teeth
    if scene.teeth is not None and teeth.faces is not None:
        add(teeth.faces.conn, teeth.faces.shape, teeth.faces.weight, teeth.pressure)
    mean = np.divide(force, area, out=np.zeros(n), where=area > 0.0)
    local = body.local[body.owned]
    return np.where(local >= 0, mean[local], 0.0)
