"""CSV files of the cam, and of the wall and end of a cup, which a design can read again."""

from __future__ import annotations

from pathlib import Path

from swgpar.design.drive_design import DriveDesign
from swgpar.exchange.wall_lines import wall_lines
from swgpar.geometry.arrays import Floats
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
        paths.append(_written(folder / f"{name}.csv", "x (mm), y (mm)", points, ".9f"))
    for name, one in wall_lines(design).items():
        heading = "distance (mm), radius (mm), rounding (mm)"
        paths.append(_written(folder / f"wall_{name}.csv", heading, one.corners(), ".12g"))
    return paths


def _written(path: Path, heading: str, rows: Floats, form: str) -> Path:
    """The path of a table that is written. rows : (n, m);  form : of its numbers"""
    lines = [", ".join(f"{value:{form}}" for value in row) for row in rows]
    path.write_text("\n".join([heading, *lines, ""]), encoding="ascii")
    return path
