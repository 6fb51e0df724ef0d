"""The section of the teeth as a figure of Plotly."""

from __future__ import annotations

from typing import Any

import numpy as np

from swgpar.app.section_picture import SectionPicture
from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.arrays import Floats

COLOURS = {
    "housing": "#b8b8b8",
    "ring_gear": "#7c8fa8",
    "flexible_spline": "#d9a23b",
    "wave_generator": "#8fb58f",
}
NEAR = 0.2
"""Gap over the module below which a flank is marked with its gap."""

OVERLAP, TOUCHING, APART = "#c0182b", "#e6c229", "#2f7fb8"
"""Colours of flanks that overlap, and of smallest and largest gaps that are marked."""


def section_figure(design: DriveDesign, picture: SectionPicture) -> dict[str, Any]:
    """Figure of both gears and the cam, true to scale, with the gaps of the flanks.

    The view is that of the teeth at the lobe next to +y, and stays where a user has moved it.
    """
    traces = [_body(name, curves) for name, curves in picture.curves.items()]
    width = 7.0 * np.pi * design.drive.module
    angle = np.radians(picture.angle_deg)
    top = design.major_semi_axis + design.flexible_spline.rim
    x, y = -top * np.sin(angle), top * np.cos(angle)
    lines = {"showgrid": False, "zeroline": False, "title": {"text": "mm"}}
    return {
        "data": [*traces, _gaps(design, picture)],
        "layout": {
            "uirevision": "kept",
            "dragmode": "pan",
            "margin": {"l": 45, "r": 10, "t": 10, "b": 40},
            "showlegend": False,
            "font": {"color": "#7a7a7a"},
            "hovermode": "closest",
            "paper_bgcolor": "rgba(0,0,0,0)",
            "plot_bgcolor": "rgba(0,0,0,0)",
            "xaxis": {**lines, "range": [x - 0.5 * width, x + 0.5 * width]},
            "yaxis": {
                **lines,
                "range": [y - 0.4 * width, y + 0.4 * width],
                "scaleanchor": "x",
            },
        },
        "config": {"scrollZoom": True, "displaylogo": False, "responsive": True},
    }


def _body(name: str, curves: list[Floats]) -> dict[str, Any]:
    """A filled body; a curve inside another one, run through the other way, is its hole."""
    pieces = []
    for index, curve in enumerate(curves):
        closed = np.vstack([curve, curve[:1]])
        pieces += [closed if _runs_left(curve) == (index == 0) else closed[::-1], [[None, None]]]
    points = np.vstack([np.asarray(piece, dtype=object) for piece in pieces])[:-1]
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name.replace("_", " "),
        "x": [_rounded(value) for value in points[:, 0]],
        "y": [_rounded(value) for value in points[:, 1]],
        "fill": "toself",
        "fillcolor": f"{COLOURS[name]}66",
        "line": {"color": COLOURS[name], "width": 1},
        "hoverinfo": "skip",
    }


def _runs_left(curve: Floats) -> bool:
    """Whether a closed curve runs counter-clockwise."""
    x, y = curve.T
    return bool((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() > 0.0)


def _rounded(value: Any) -> float | None:
    """mm, to a hundredth of a µm."""
    return None if value is None else round(float(value), 5)


def _gaps(design: DriveDesign, picture: SectionPicture) -> dict[str, Any]:
    gaps, near = picture.gaps, NEAR * design.drive.module
    shown = gaps.gap < near
    overlap, place = gaps.gap[shown] < 0.0, gaps.place[shown]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "gaps",
        "x": [_rounded(value) for value in place[:, 0]],
        "y": [_rounded(value) for value in place[:, 1]],
        "marker": {
            "size": np.where(overlap, 11, 7).tolist(),
            "symbol": np.where(overlap, "x", "circle").tolist(),
            "color": [1e3 * _gap for _gap in gaps.gap[shown].tolist()],
            "cmin": 0.0,
            "cmax": 1e3 * near,
            "colorscale": [[0.0, OVERLAP], [1e-6, TOUCHING], [1.0, APART]],
            "colorbar": {"title": {"text": "gap, µm"}, "thickness": 12},
        },
        "text": [
            f"tooth {tooth}: {'overlap' if gap < 0.0 else 'gap'} {abs(1e3 * gap):.2f} µm"
            for tooth, gap in zip(gaps.tooth[shown], gaps.gap[shown], strict=True)
        ],
        "hoverinfo": "text",
    }
