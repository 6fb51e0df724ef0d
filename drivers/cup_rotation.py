"""The reference cup drive through the Python API: the same job as `swgpar run
drivers/cup_45deg.toml`.

Problem: a strain wave gear with 120 / 122 teeth and its cup; the elliptical wave generator rotates
by 45 degrees under an output torque of 20 N m (Tables 7.1 to 7.4). Equations: equilibrium of two
elastic bodies with finite rotations, frictionless contact of cam on spline and of spline on ring
gear, and a torque that is work-conjugate to the mean rotation of the cup's bore. Expected run time:
about a minute on 2 cores.

    mpirun -n 2 python drivers/cup_rotation.py --out results/cup
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mpi4py import MPI

import swgpar


def main() -> float:
    """Run and return the mean of the largest tensile stress in the flexible spline, MPa."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--design", default=Path(__file__).with_name("cup_45deg.toml"))
    options.add_argument("--mesh", help="name or path of a mesh recipe (default: forces)")
    options.add_argument("--out", default="results/cup_rotation")
    options.add_argument(
        "--restart", action="store_true", help="continue from the checkpoint in --out"
    )
    options.add_argument(
        "--overwrite", action="store_true", help="replace results that --out already holds"
    )
    options.add_argument("--set", nargs="*", default=[], help="section.key=value")
    arguments = options.parse_args()

    design = swgpar.load_design(arguments.design, arguments.set)
    result = swgpar.run(
        design,
        arguments.mesh,
        arguments.out,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        progress=True,
    )
    if MPI.COMM_WORLD.rank == 0:
        columns = ("step", "wg_angle_deg", "fs_s1", "wg_torque_Nmm")
        for step, angle, stress, torque in zip(
            *(result.history[name] for name in columns), strict=True
        ):
            print(
                f"step {step:>3}  {angle:7.2f} deg  s1 {stress:7.1f} MPa  input torque "
                f"{torque:8.2f} N mm"
            )
    return result.summary.rotation.means.get("fs_s1", float("nan"))


if __name__ == "__main__":
    main()
