"""Lines of a cup's wall and end on one sheet: distance from the back of the teeth, and radius."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.arrays import Floats
from swgpar.geometry.paired_lines import RoundedLine


@dataclass(frozen=True)
class SheetLine:
    """A surface of the wall, or a face of closed end or flange.

    line : in its own coordinates;  place : of their points (2,) on the sheet, (2,) mm
    """

    line: RoundedLine
    place: Callable[[Floats], Floats]

    def corners(self) -> Floats:
        """Distance, radius and rounding (n, 3) mm of its ends and of the points where it turns."""
        line = self.line
        turns = np.concatenate([[True], line.turning() != 0.0, [True]])
        return np.array(
            [
                [*self.place(point), rounding]
                for point, rounding in zip(line.points[turns], line.rounding[turns], strict=True)
            ]
        )


def wall_lines(design: DriveDesign) -> dict[str, SheetLine]:
    """Both surfaces of a cup's wall, and both faces of closed end or flange, by the names of their
    keys in [cup]; none without a cup."""
    if not design.has_cup:
        return {}
    wall = design.cup_sizes.wall

    def from_plate(point: Floats) -> Floats:
        radius, z = wall.off_plate(*point)
        return np.array([z - wall.back, radius])

    return {
        "inner": SheetLine(wall.inner, np.array),
        "outer": SheetLine(wall.outer, np.array),
        "end_far": SheetLine(wall.plate.inner, from_plate),
        "end_near": SheetLine(wall.plate.outer, from_plate),
    }
