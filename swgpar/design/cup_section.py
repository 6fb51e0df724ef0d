"""Section [cup] of the drive's design file: the wall of the flexible spline behind its teeth."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from swgpar.geometry.arrays import Floats
from swgpar.input.quantities import Section, not_negative, positive, quantity


def _layer(line: str) -> Any:
    return quantity(None, text=f"layer of a DXF file for the {line}; without it the model space")


class ContourPoint(Section):
    """One table [[cup.contour]]: a corner of the wall's section on its inner surface, and that on
    the outer one. Between corners both surfaces are straight."""

    distance: float = positive("from the back of the teeth along the axis", "mm")
    thickness: float | None = positive(
        "thickness of the wall, across the axis; needed without outer_radius", "mm", None
    )
    radius: float | None = positive(
        "inner radius of the wall; default that below the teeth", "mm", None
    )
    outer_distance: float | None = positive(
        "distance of the corner outside; default distance", "mm", None
    )
    outer_radius: float | None = positive(
        "radius of the corner outside, in place of thickness", "mm", None
    )
    rounding: float = not_negative("radius that rounds the corners at this point", "mm", 0.0)
    outer_rounding: float | None = not_negative(
        "that of the corner outside; default rounding", "mm", None
    )


class EndContourPoint(Section):
    """One table [[cup.end_contour]]: a corner of closed end or flange on its far face, and that on
    the near one, towards the teeth. Between corners both faces are straight."""

    radius: float = positive("from the axis", "mm")
    thickness: float | None = positive(
        "thickness of closed end or flange there, along the axis; needed without near_distance",
        "mm",
        None,
    )
    distance: float | None = positive(
        "from the back of the teeth to the far face; default cup.length", "mm", None
    )
    near_radius: float | None = positive(
        "radius of the corner on the near face; default radius", "mm", None
    )
    near_distance: float | None = positive(
        "from the back of the teeth to the near face, in place of thickness", "mm", None
    )
    rounding: float = not_negative("radius that rounds the corners at this point", "mm", 0.0)
    near_rounding: float | None = not_negative(
        "that of the corner on the near face; default rounding", "mm", None
    )


class Cup(Section):
    """Section [cup]: the wall of the flexible spline behind its teeth."""

    shape: Literal["cup", "hat"] = quantity(
        "cup", text="the wall ends in a closed end with a bore, or in a flange outwards (silk hat)"
    )
    length: float = positive(
        "from the back of the teeth to the far face of closed end or flange, beside the fillet",
        "mm",
    )
    thickness_coef: float = quantity(
        0.8,
        text="thickness of the wall at the back of the teeth over rim thickness",
        ge=0.1,
        le=1.0,
    )
    contour: list[ContourPoint] = quantity(
        [],
        text="points of a wall that is not straight, from the teeth on; behind the last one it is "
        "straight",
    )
    inner_file: str | None = quantity(
        None,
        text="CSV or DXF file of the inner surface in place of contour: distance from the back of "
        "the teeth and radius",
    )
    outer_file: str | None = quantity(
        None, text="file of the outer surface, which belongs to inner_file"
    )
    inner_layer: str | None = _layer("inner surface")
    outer_layer: str | None = _layer("outer surface")
    end_thickness: float | None = positive(
        "thickness of closed end or flange beside the fillet; default that of the wall", "mm", None
    )
    end_contour: list[EndContourPoint] = quantity(
        [],
        text="points of a closed end or flange that is not flat, from the fillet on; behind the "
        "last one it is",
    )
    end_far_file: str | None = quantity(
        None,
        text="CSV or DXF file of the far face in place of end_contour: distance from the back of "
        "the teeth and radius",
    )
    end_near_file: str | None = quantity(
        None, text="file of the near face, which belongs to end_far_file"
    )
    end_far_layer: str | None = _layer("far face")
    end_near_layer: str | None = _layer("near face")
    fillet_radius: float = not_negative(
        "radius between wall and closed end on the outer side, between wall and flange on the "
        "inner side; 0 is a sharp corner, with inside_radius",
        "mm",
    )
    inside_radius: float | None = positive(
        "fillet radius in the corner on the other side; default a quarter of an ellipse "
        "around the centre of fillet_radius",
        "mm",
        None,
    )
    inner_radius: float | None = positive(
        'bore radius of the closed end, needed with shape "cup"', "mm", None
    )
    flange_radius: float | None = positive(
        'outer radius of the flange, needed with shape "hat"', "mm", None
    )
    back_fillet: float = not_negative("fillet radius between back of teeth and wall", "mm", 0.0)

    attachment: Literal["edge", "clamped", "bolted"] = quantity(
        "edge",
        text="what carries the torque: the bare bore or rim of the flange, a clamped ring of "
        "closed end or flange, bolts",
    )
    clamping_radius: float | None = positive(
        'radius to which closed end or flange is clamped, needed with "clamped"', "mm", None
    )
    bolts: int | None = quantity(
        None, text='bolts, evenly spaced, the first on +y, needed with "bolted"', ge=3, le=400
    )
    bolt_circle: float | None = positive(
        'diameter of the circle of the bolts, needed with "bolted"', "mm", None
    )
    washer_diameter: float | None = positive(
        'diameter of the area under a bolt, needed with "bolted"', "mm", None
    )
    bolt_preload: float | None = positive(
        "preload of a bolt: washers are judged against sliding and gaping", "N", None
    )
    joint_friction: float | None = positive(
        "friction coefficient between closed end or flange and what it is bolted to, needed "
        "with bolt_preload",
        default=None,
        le=1.0,
    )

    def is_attached(self, points: Floats) -> NDArray[np.bool_]:
        """Whether points (..., 2) mm of closed end or flange are clamped or lie under a bolt,
        undeformed."""
        x, y = points[..., 0], points[..., 1]
        radius = np.hypot(x, y)
        if self.attachment == "clamped":
            return (
                radius >= self.clamping_radius
                if self.shape == "hat"
                else radius <= self.clamping_radius
            )
        if self.attachment == "edge":
            return np.zeros(radius.shape, dtype=bool)
        angle, step = np.arctan2(-x, y), 2.0 * np.pi / self.bolts
        angle -= step * np.round(angle / step)
        across, along = radius * np.sin(angle), radius * np.cos(angle) - 0.5 * self.bolt_circle
        return np.hypot(across, along) <= 0.5 * self.washer_diameter

    @property
    def attached_width(self) -> float:
        """Width (mm) of the clamped ring, or diameter of the area under a bolt."""
        return self.washer_diameter or abs((self.clamping_radius or self.edge) - self.edge)

    @property
    def attached_ring(self) -> tuple[float, float] | None:
        """Radii (mm) between which closed end or flange is clamped, or its bolts lie."""
        if self.attachment == "edge":
            return None
        if self.attachment == "bolted":
            middle, half = 0.5 * self.bolt_circle, 0.5 * self.washer_diameter
            return middle - half, middle + half
        return (
            (self.clamping_radius, np.inf) if self.shape == "hat" else (0.0, self.clamping_radius)
        )

    @property
    def edge(self) -> float:
        """Radius (mm) of the bore, or of the rim of the flange."""
        return self.flange_radius if self.shape == "hat" else self.inner_radius
