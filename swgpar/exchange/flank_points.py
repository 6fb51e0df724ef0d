"""Points of the tooth flanks: a CSV and a DXF file for each gear, that `profile.type = "points"`
reads."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.exchange.dxf import draw, new_document
from swgpar.exchange.outlines import flank_edges
from swgpar.input.toml_file import to_toml
from swgpar.profiles import ToothProfile

PART_POINTS = 65
"""Points of a part of a flank: splines through them meet it to a millionth of the module."""


def points_section(profile: ToothProfile, file: str) -> dict[str, Any]:
    """Content of a section `profile` that makes this flank from a file with its points."""
    inner = profile.point(profile.breaks[1:-1])
    return {
        "type": "points",
        "file": file,
        "joints": np.hypot(*inner.T).tolist(),
        "rounded_tip": profile.tip_end > 0.0,
    }


def write_flank_points(design: DriveDesign, folder: Path) -> list[Path]:
    """Write GEAR.csv and GEAR.dxf for each gear: the flank at x > 0 of a tooth on +y, mm, with its
    tip relief, and teeth.toml, the sections that read the CSV files; c_P is 1 there.

    Call it on one rank. Raises InputError without the package ezdxf.
    """
    paths: list[Path] = []
    sections: dict[str, Any] = {}
    for gear in design.gears:
        profile = design.profile(gear)
        s = [np.linspace(begin, end, PART_POINTS)[:-1] for begin, end in pairwise(profile.breaks)]
        points = profile.point(np.append(np.concatenate(s), profile.length))
        table = folder / f"{gear}.csv"
        lines = [f"{x!r},{y!r}" for x, y in points.tolist()]
        head = f"# flank of {gear}, from tip to root, axis of the gear at 0, 0\nx_mm,y_mm\n"
        table.write_text(head + "\n".join(lines) + "\n", encoding="utf-8")
        document = new_document()
        document.layers.add(gear)
        draw(document.modelspace(), flank_edges(profile), gear)
        drawing = folder / f"{gear}.dxf"
        document.saveas(drawing)
        paths += [table, drawing]
        sections[gear] = {"c_P": 1.0, "profile": points_section(profile, table.name)}
    teeth = folder / "teeth.toml"
    teeth.write_text(to_toml(sections), encoding="utf-8")
    return [*paths, teeth]
