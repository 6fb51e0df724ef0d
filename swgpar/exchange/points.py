"""CSV files of the cam, and of the wall and end of a cup, which a design can read again."""

from __future__ import annotations

from pathlib import Path

from swgpar.design.drive_design import DriveDesign
from swgpar.exchange.wall_lines import wall_lines
from swgpar.geometry.cams import cam_outlines

CAM_POINTS = 1440
"""Points of a cam's outline, four to a degree."""


def write_points(design: DriveDesign, folder: Path) -> list[Path]:
    """Write wave_generator.csv, or a file for each roller: points around the curve, x and y in mm.
    For a cup write wall_inner.csv, wall_outer.csv, wall_end_far.csv and wall_end_near.csv: corners
    with distance from the back of the teeth, radius and the radius that rounds them, mm.

    Call it on one rank. `wave_generator.file` reads the file of a cam, `cup.inner_file` and so on
    those of a wall.
    """
    outlines = cam_outlines(design.cam(), CAM_POINTS)
    paths = []
    for number, points in enumerate(outlines, 1):
        name = "wave_generator" if len(outlines) == 1 else f"wave_generator_roller_{number}"
        path = folder / f"{name}.csv"
        lines = [f"{x:.9f}, {y:.9f}\n" for x, y in points]
        path.write_text("x (mm), y (mm)\n" + "".join(lines), encoding="ascii")
        paths.append(path)
    for name, one in wall_lines(design).items():
        path = folder / f"wall_{name}.csv"
        lines = [", ".join(f"{value:.12g}" for value in row) + "\n" for row in one.corners()]
        path.write_text("distance (mm), radius (mm), rounding (mm)\n" + "".join(lines), "ascii")
        paths.append(path)
    return paths
