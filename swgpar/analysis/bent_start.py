"""Start from the shape of the bent flexible spline, with all contacts at once.

Laid on the cam, that shape is so close to the loaded state that one solve takes the place of
deflection, engagement and torque.
"""

from __future__ import annotations

from swgpar.analysis.bent_spline import bent_bodies
from swgpar.fem.vectors import write_field
from swgpar.geometry.rotation import rotated
from swgpar.model.drive_model import DriveModel


def bend(model: DriveModel) -> None:
    """Set the model's x to the bent spline on the unturned cam, or on its bearing; collective."""
    model.problem.x.set(0.0)
    for body, field in bent_bodies(model.design).items():
        layout = model.partition.layouts[body]
        angle = layout.chain_angle(model.partition.owned_indices(body))
        points = rotated(layout.mesh.coords, angle[:, None])
        values = field.displacement(points.reshape(-1, 3)).reshape(points.shape)
        write_field(model.partition, body, values, model.problem.x)
