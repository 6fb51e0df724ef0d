"""Shapes of the small drive's cup: overrides, and exact volumes of their walls."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from support.paths import DESIGN
from swgpar.checks.design_file import make_drive
from swgpar.design.drive_design import DriveDesign
from swgpar.input.toml_file import read_toml

Changes = dict[str, Any]
"""Keys of the section [cup] that differ from those of the small drive; None: the key is left
out."""

CONTOUR: Changes = {
    "contour": [
        {"distance": 2.0, "thickness": 0.48},
        {"distance": 5.0, "thickness": 0.36, "rounding": 4.0},
        {"distance": 8.0, "thickness": 0.6, "radius": 18.8, "rounding": 4.0},
    ]
}
HAT: Changes = {"shape": "hat", "inner_radius": None, "flange_radius": 26.0, "end_thickness": 0.8}
SHORT: Changes = {"length": 6.0}
DIAPHRAGM: Changes = {
    "end_thickness": 0.8,
    "end_contour": [
        {"radius": 16.0, "thickness": 0.4, "rounding": 3.0},
        {"radius": 12.0, "thickness": 0.4, "rounding": 1.0},
        {"radius": 10.0, "thickness": 1.6, "rounding": 1.0},
    ],
}
"""A closed end that is thin between its fillet and a hub."""
BOSS: Changes = {
    "end_thickness": 0.5,
    "end_contour": [
        {"radius": 11.0, "thickness": 0.5},
        {"radius": 8.0, "thickness": 3.9, "distance": 12.7, "rounding": 1.0},
    ],
}
"""A hub that is thicker on both sides and reaches into the cup."""
DISHED: Changes = {
    "end_thickness": 0.5,
    "end_contour": [
        {"radius": 12.0, "distance": 12.0, "near_radius": 12.337, "near_distance": 11.5},
        {"radius": 11.0, "distance": 9.5, "near_radius": 11.337, "near_distance": 9.0},
    ],
}
"""A closed end with a steep cone between two rings."""
RING: Changes = {
    "shape": "hat",
    "inner_radius": None,
    "flange_radius": 26.0,
    "end_thickness": 0.5,
    "end_contour": [
        {"radius": 21.5, "thickness": 0.5, "rounding": 0.6},
        {"radius": 22.0, "thickness": 1.0, "rounding": 0.6},
    ],
}
"""A flange with a step to the ring of its bolts."""

ATTACHED = {
    "clamped": ("cup.attachment=clamped", "cup.clamping_radius=10"),
    "bolted": (
        "cup.attachment=bolted",
        "cup.bolts=6",
        "cup.bolt_circle=20",
        "cup.washer_diameter=3",
    ),
}
"""Overrides that clamp or bolt the closed end of the small drive."""


def cone(degrees: float, thickness: float = 0.48, rounding: float = 0.0) -> Changes:
    """A wall with a cone of this slope between two cylinders, all equally thick."""
    slope = np.radians(degrees)
    # from the corner inside to that outside, on the bisector
    along = thickness * float(np.tan(0.5 * slope))
    last = 4.0 + 5.0 / float(np.tan(slope))
    corners = [(4.0, 18.6), (last, 13.6)]
    contour: list[dict[str, float]] = [
        {
            "distance": distance,
            "radius": radius,
            "outer_distance": distance + along,
            "outer_radius": radius + thickness,
            "rounding": rounding,
        }
        for distance, radius in corners
    ]
    return {"length": 14.0, "contour": contour}


SHAPES: dict[str, Changes] = {
    "contour": CONTOUR,
    "hat": HAT,
    "short": SHORT,
    "hat, contour": HAT | CONTOUR,
    "thick end": {"fillet_radius": 0.0, "inside_radius": 0.6, "end_thickness": 2.0},
    "rounded end": {"fillet_radius": 0.7, "inside_radius": 0.4, "end_thickness": 1.0},
    "diaphragm": DIAPHRAGM,
    "boss": BOSS,
    "dished": DISHED,
    "ring": RING,
    "sharp hat": HAT | {"fillet_radius": 0.0, "inside_radius": 0.5, "end_thickness": 1.2},
}


SHORT_WALL: Changes = {"length": 2.2}
"""Teeth up to 0.2 modules before the fillet."""

WALLS: dict[str, Changes] = SHAPES | {"cone": cone(79.0, rounding=0.5)}
"""The start that bends with the cam has a jump where the plate of a narrow end begins."""


def shaped(changes: Changes, *overrides: str) -> DriveDesign:
    """The small drive with another cup."""
    table = read_toml(DESIGN)
    cup = {key: value for key, value in {**table["cup"], **changes}.items() if value is not None}
    for override in overrides:
        key, _, value = override.partition("=")
        section, name = key.split(".")
        table.setdefault(section, {})[name] = json.loads(value)
    return make_drive({**table, "cup": cup})


def revolved(points: np.ndarray) -> float:
    """Volume (mm³) of a closed polygon (n, 2) of r and z that turns about the axis, by Guldin's
    rule."""
    (r, z), (r_next, z_next) = points.T, np.roll(points, -1, axis=0).T
    return abs(float(np.sum((z_next - z) * (r**2 + r * r_next + r_next**2)))) * np.pi / 3.0


def wall_volume(design: DriveDesign, n: int = 20001) -> float:
    """Volume (mm³) of the wall behind the teeth without the fillet there, by a fine polygon of its
    section."""
    wall, cup = design.cup_sizes.wall, design.cup
    share, angle = np.linspace(0.0, 1.0, n), np.linspace(0.0, 0.5 * np.pi, n)
    if cup.inside_radius is not None:
        return revolved(np.concatenate(_lines_with_two_radii(design, share, angle)))
    lines = []
    for line, thickness in ((wall.inner, 0.0), (wall.outer, wall.thickness)):
        near = wall.outwards == bool(thickness)
        s = share * (cup.length - cup.fillet_radius)
        if wall.outwards:
            a, b = (
                cup.fillet_radius - thickness,
                cup.fillet_radius - (wall.end_thickness if thickness else 0.0),
            )
            side = -1.0
        else:
            off = 0.0 if thickness else 1.0
            a, b = (
                cup.fillet_radius - off * wall.thickness,
                cup.fillet_radius - off * wall.end_thickness,
            )
            side = 1.0
        center = line.points[-1, 1] - side * a, cup.length - cup.fillet_radius
        fillet = np.column_stack(
            [center[0] + side * a * np.cos(angle), center[1] + b * np.sin(angle)]
        )
        plate = wall.plate.outer if near else wall.plate.inner
        way = share * plate.points[-1, 0]
        end = wall.off_plate(way, plate.radius(way)) - [0.0, wall.back]
        lines.append(np.concatenate([np.column_stack([line.radius(s), s]), fillet, end]))
    return revolved(np.concatenate([lines[0], lines[1][::-1]]))


def _lines_with_two_radii(
    design: DriveDesign, share: np.ndarray, angle: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) of r and distance from the teeth of the inner line, and of the outer one
    backwards. share, angle : (n,) along the wall and the arcs"""
    wall, cup = design.cup_sizes.wall, design.cup
    side, near = -1.0 if wall.outwards else 1.0, cup.length - wall.end_thickness
    concave, convex = (cup.inside_radius, near), (cup.fillet_radius, cup.length)
    lines = []
    for line, (radius, face) in (
        (wall.inner, convex if wall.outwards else concave),
        (wall.outer, concave if wall.outwards else convex),
    ):
        s, r_end = share * (face - radius), line.points[-1, 1]
        straight = np.column_stack([line.radius(np.minimum(s, wall.length)), s])
        arc = np.column_stack(
            [
                r_end - side * radius * (1.0 - np.cos(angle)),
                face - radius * (1.0 - np.sin(angle)),
            ]
        )
        lines.append(np.concatenate([straight, arc, [[cup.edge, face]]]))
    return lines[0], lines[1][::-1]


CLAMPED: Changes = {"attachment": "clamped", "clamping_radius": 9.0}
HAT_CLAMPED: Changes = HAT | {"attachment": "clamped", "clamping_radius": 23.0}


def bolted(bolts: int, washer: float = 2.0) -> Changes:
    """The closed end on bolts."""
    return {"attachment": "bolted", "bolts": bolts, "bolt_circle": 20.0, "washer_diameter": washer}


ATTACHMENTS: dict[str, Changes] = {
    "clamped": CLAMPED,
    "hat, clamped": HAT_CLAMPED,
    "eight bolts": bolted(8),
    "hat, ten bolts": HAT | {**bolted(10, 3.0), "bolt_circle": 47.0},
}
"""The cup is made stiffer than on its bore."""
