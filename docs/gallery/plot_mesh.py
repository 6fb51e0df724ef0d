"""
Mesh close-up
=============

The mesh of one tooth of each gear on two recipes, coloured by the quality of its elements.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pyvista
from matplotlib.collections import PolyCollection

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
design = swgpar.load_design(DRIVERS / "plane_half_turn.toml")
meshes = {name: swgpar.mesh(design, name) for name in ("plane_coarse", "plane")}

# %%
# The quality of the whole mesh: the scaled Jacobian is 1 for a rectangle and 0 for an element
# that has collapsed.

for name, mesh in meshes.items():
    for body, quality in mesh.quality.items():
        smallest = quality["min_scaled_jacobian"]
        print(f"{name:14} {body:16} {quality['elements']:6.0f} elements", end="   ")
        print(f"smallest scaled Jacobian {smallest:.3f}")

# %%
# The teeth at the major axis, undeformed.


def scaled_jacobian(corners: np.ndarray) -> np.ndarray:
    """Smallest scaled Jacobian of quadrilaterals (n, 4, 2) over their corners."""
    out = np.roll(corners, -1, axis=1) - corners
    back = np.roll(corners, 1, axis=1) - corners
    cross = out[..., 0] * back[..., 1] - out[..., 1] * back[..., 0]
    lengths = np.linalg.norm(out, axis=2) * np.linalg.norm(back, axis=2)
    return (cross / lengths).min(axis=1)


figure, axes = plt.subplots(1, 2, figsize=(10.0, 4.6), sharey=True, layout="constrained")
for panel, (name, mesh) in zip(axes, meshes.items()):
    for body in mesh.bodies.values():
        corners = body.points[body.cells][:, :4, :2]
        near = (np.abs(corners[..., 0]).max(axis=1) < 3.0) & (corners[..., 1].min(axis=1) > 50.0)
        quads = PolyCollection(
            corners[near],
            array=scaled_jacobian(corners[near]),
            cmap="viridis",
            clim=(0.5, 1.0),
            edgecolors="white",
            linewidths=0.4,
        )
        panel.add_collection(quads)
    panel.set(title=name, xlabel="x (mm)", aspect="equal", xlim=(-2.6, 2.6), ylim=(58.0, 63.9))
axes[0].set_ylabel("y (mm)")
figure.colorbar(quads, ax=axes, label="scaled Jacobian")

# %%
# The cup drive: the same cross-section, swept along the face width, and the wall of the cup.

cup = swgpar.mesh(swgpar.load_design(DRIVERS / "cup_45deg.toml"), "coarse")
grid = cup.grid()
middle = grid.cell_centers().points
near = np.abs(np.arctan2(middle[:, 0], middle[:, 1])) < np.radians(7.5)
part = grid.extract_cells(near & (grid.cell_data["body"] == 0))

plotter = pyvista.Plotter(off_screen=True, window_size=(1200, 700))
plotter.add_mesh(part, color="lightsteelblue", show_edges=True, edge_color="navy")
plotter.camera_position = [(60.0, 110.0, -60.0), (0.0, 47.0, 22.0), (0.0, 1.0, 0.0)]
plotter.camera.zoom(1.3)
figure, panel = plt.subplots(figsize=(9.0, 5.25), layout="constrained")
panel.imshow(plotter.screenshot(return_img=True))
panel.axis("off")
plotter.close()
plt.show()
