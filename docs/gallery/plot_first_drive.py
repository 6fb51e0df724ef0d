"""
A first drive
=============

The plane model of the reference drive: 120 and 122 teeth, an elliptical cam, 2 N·m on the
output. It is the toothed section of the drive in plane stress and runs in seconds.
"""

# ranks: 1 2

from pathlib import Path

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"

# %%
# ``steps.samples`` computes evenly spaced angles of one period of the motion, instead of
# increments over the whole rotation. The state repeats after 360° / 122 of the cam.

design = swgpar.load_design(
    DRIVERS / "plane_half_turn.toml",
    {"steps.samples": 8, "steps.rotation": 9.0},
)

# %%
# A mesh is a name ("plane_coarse"), the path of a recipe, or a dictionary. This one is
# coarser than those of the package. Without ``out`` the run leaves no files behind.

gear = {"tip": 2, "layers": 1, "flank": 6, "root": 3, "under": 1, "rim": 2}
result = swgpar.run(design, mesh={"flexible_spline": gear, "ring_gear": gear})

# %%
# The history has a column per quantity and a value per increment.

for column in ("step", "wg_angle_deg", "fs_s1", "fs_vm", "wg_torque_Nmm", "pairs_in_contact"):
    print(f"{column:20}", *(f"{float(value):9.3f}" for value in result.history[column][:6]))

# %%
# The largest stresses over the angle of the wave generator.

result.plot.stress()

# %%
# The input torque. Without friction its mean is the output torque divided by the ratio. The
# transmission error is the angle of the output less its kinematic value.

result.plot.torque_and_transmission_error()

# %%
# The deformed drive, coloured by the von Mises stress.

result.plot.deformed()
