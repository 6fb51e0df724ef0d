"""Elements of windows, from one to the next finer one."""

from __future__ import annotations

from typing import Any, TypeVar

from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe import make_recipe

T = TypeVar("T")


def by_model(plane: T, in_space: T) -> dict[str, T]:
    """Constants of windows by `drive.model`: a pancake has those of a cup drive."""
    return {"plane": plane, "cup": in_space, "pancake": in_space}


RATIO = by_model(2.0, 1.5)
"""Ratio of element sizes of successive windows."""

COUNTS: dict[str, dict[str, dict[str, tuple[int, ...]]]] = {
    "plane": {
        "flexible_spline": {
            "root": (4, 8, 16, 32, 64),
            "under": (3, 6, 12, 24, 48),
            "rim": (4, 8, 16, 32, 64),
            "layers": (1, 2, 4, 8, 16),
            "tip": (2, 4, 8, 16, 32),
            "flank": (8, 16, 32, 64, 128),
        }
    },
    "cup": {
        "flexible_spline": {
            "root": (4, 6, 9, 13),
            "under": (2, 3, 4, 6),
            "rim": (2, 3, 4, 6),
            "layers": (2, 2, 3, 3),
            "tip": (2, 2, 2, 2),  # the flanks are far from the root
            "flank": (8, 8, 8, 12),
        },
        "ring_gear": {
            "root": (4, 6, 9, 13),
            "under": (2, 3, 4, 6),
            "rim": (2, 3, 4, 6),
            "layers": (1, 1, 2, 3),
            "tip": (2, 3, 4, 6),
            "flank": (8, 12, 18, 26),
        },
        "face_width": {"elements": (8, 12, 18, 26)},  # even: a crowned cam touches along the middle
        "cup": {"cylinder": (6, 9, 13, 20), "fillet": (1, 1, 1, 1), "closed_end": (1, 1, 1, 1)},
    },
}
"""Counts of the windows, coarse to fine. That of the cylinder is along all of it; fillet and closed
end are outside."""

COUNTS["pancake"] = {gear: COUNTS["cup"][gear] for gear in ("flexible_spline", "ring_gear")} | {
    "face_width": {"elements": (4, 6, 9, 13)}
}
"""The flexible spline has the elements of both ring gears along its face width, and the gap's."""

MOST_LEVELS = by_model(5, 4)
"""Windows that there are; the last one has some 200,000 and 60,000 elements."""

END_RATIO = (3.0, 6.0, 6.0, 6.0)
"""Middle elements along the face width over those at both ends, coarse to fine. With few elements
longer ones in the middle find the contact of the cam in more iterations."""

UNDER_RATIO = 3.0
"""Thickness of the lowest layer below the roots of a cup drive over that of the one at the root. In
the plane there are many equal ones."""

LAYER_RATIO = (3.0, 3.0, 2.5, 3.0)
"""Thickness of layers below the flank of the flexible spline in a cup drive over that of the next
nearer one, coarse to fine: beside the root they are as thin as the layers below it. One thick layer
does not bend as the surface does: at the split of the root arc, where three elements meet, the
tension came out up to 16 % too large."""

LEVELS = by_model(4, 3)
"""Windows in the loaded state."""

FEWEST_LEVELS = by_model(4, 2)
"""The same for a rough answer."""

RING_LEVELS = by_model(4, 2)
"""Windows of the ring gear. In the plane the first one is too coarse to show an order beside a
contact near the root (docs/verification/error_sources_plane.md)."""

NARROW_FROM = 2
"""Index of the first window of the flexible spline that is a narrow one of the one before."""

PERIOD_LEVEL = by_model(1, 1)
"""Index of the window with which the further angles of a period are computed."""


def window_recipe(model: str, level: int) -> MeshRecipe:
    """Recipe of the window `level`, from 0 on, of the "plane", "cup" or "pancake" model."""
    content: dict[str, Any] = {
        section: {name: values[level] for name, values in counts.items()}
        for section, counts in COUNTS[model].items()
    }
    content.setdefault("ring_gear", content["flexible_spline"])
    if "face_width" in content:
        content["face_width"]["end_ratio"] = END_RATIO[level]
        for gear in ("flexible_spline", "ring_gear"):
            content[gear]["under_ratio"] = UNDER_RATIO
        content["flexible_spline"] |= {"layer_ratio": LAYER_RATIO[level], "even_root": True}
    return make_recipe(content)
