"""
Optimisation
============

Two keys of the plane reference drive, the thickness of the rim and the minor axis of the cam, are
varied to lower the tension and the largest force on a tooth at once. A search of real use takes
more evaluations and a finer mesh.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import swgpar

DRIVERS = Path(__file__).parents[2] / "drivers"
GEAR = "tip = 2\nlayers = 1\nflank = 6\nroot = 3\nunder = 1\nrim = 2\n"
OPTIMISATION = f"""
[optimise]
title = "Rim and cam of the plane drive"
design = "{DRIVERS / "plane_half_turn.toml"}"
mesh = "mesh.toml"
set = [
    "steps.samples=4", "steps.rotation=3.0", "steps.bent_start=true",
    "solver.condensed_sectors=true",
]
evaluations = 10
sampler = "nsga2"

[[optimise.variable]]
keys = ["flexible_spline.rim"]
low = 0.7
high = 1.3

[[optimise.variable]]
keys = ["wave_generator.C"]
low = 0.97
high = 1.0

[[optimise.objective]]
quantity = "mean.fs_s1"

[[optimise.objective]]
quantity = "sharing.largest_force"
"""

folder = Path(tempfile.mkdtemp())
(folder / "mesh.toml").write_text(f"[flexible_spline]\n{GEAR}\n[ring_gear]\n{GEAR}")
(folder / "optimise.toml").write_text(OPTIMISATION)
found = swgpar.optimise(folder / "optimise.toml", folder / "results", progress=False)

# %%
# The results folder has the report ``optimise.html`` and a design file of every design of the
# Pareto front.

print(*sorted(path.name for path in (found.folder / "best").iterdir()))
for number in found.best:
    evaluation = found.evaluations[number]
    values = ", ".join(f"{key} {value:.3f}" for key, value in evaluation.values.items())
    print(f"evaluation {number}: {values}")

# %%
# No design of the front can be improved in one objective without loss in the other.

evaluations = [e for e in found.evaluations.values() if e.status == "feasible"]
stress = [e.quantities["mean.fs_s1"] for e in evaluations]
force = [e.quantities["sharing.largest_force"] for e in evaluations]
front = sorted(
    (e.quantities["mean.fs_s1"], e.quantities["sharing.largest_force"])
    for e in (found.evaluations[number] for number in found.best)
)

figure, axes = plt.subplots(1, 2, figsize=(10.0, 4.0), layout="constrained")
axes[0].plot(stress, force, "o", label="all designs")
axes[0].plot(*zip(*front), "s-", color="tab:orange", label="Pareto front")
axes[0].set(
    xlabel="tension of the spline, mean over the rotation (MPa)",
    ylabel="largest force of a pair of flanks (N)",
)
axes[0].legend()
rim = [e.values["flexible_spline.rim"] for e in evaluations]
cam = [e.values["wave_generator.C"] for e in evaluations]
points = axes[1].scatter(rim, cam, c=stress, cmap="turbo", s=60)
axes[1].set(xlabel="thickness of the rim (mm)", ylabel="C, factor of the cam's minor axis")
figure.colorbar(points, ax=axes[1], label="tension (MPa)")
plt.show()
