"""The section of the teeth as a figure of Plotly."""

from __future__ import annotations

from base64 import b64encode
from typing import Any

import numpy as np

from swgpar.app.flank_gaps import NEAR, FlankGaps, flank_gaps
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GearName
from swgpar.geometry.arrays import Floats
from swgpar.geometry.rotation import rotated
from swgpar.presentation.body_curves import body_curves, inner_teeth
from swgpar.presentation.loaded_outline import LoadedOutline
from swgpar.presentation.overlap_areas import slot_overlap

COLOURS = {
    "housing": "#b8b8b8",
    "ring_gear": "#7c8fa8",
    "flexible_spline": "#d9a23b",
    "wave_generator": "#8fb58f",
    "dynamic_spline": "#a06cb0",
}
BREAK = np.full((1, 2), np.nan)
"""Between two curves of a body."""

OTHER_SIZE = np.log(1.25)
"""Logarithm of the ratio of two sizes from which designs are not seen in the same view."""

OVERLAP, TOUCHING, APART = "#c0182b", "#e6c229", "#2f7fb8"
"""Colours of flanks that overlap, and of smallest and largest gaps that are marked."""


def section_figure(
    design: DriveDesign, angle_deg: float = 0.0, loaded: LoadedOutline | None = None
) -> dict[str, Any]:
    """Figure of both gears and the cam, true to scale, with the gaps and overlaps of the flanks, or
    with stresses and forces of a loaded state, which is one at the angle 0 of the cam. The dynamic
    spline of a pancake drive, which is behind the ring gear, is a line.

    angle_deg : of the cam, counter-clockwise; the ring gear rests

    The view is that of the teeth at the lobe next to +y, or of its pairs of flanks under load. It
    stays where a user has moved it, for designs of about the same size.
    """
    angle = float(np.radians(angle_deg))
    bodies = body_curves(design.geometry, design.tooth_motion(), design.cam(), angle)
    traces = [_body(name, curves) for name, curves in bodies.items()]
    traces += [_behind(design, gear, angle) for gear in design.gears[2:]]
    shades = [shade for gear in design.gears[1:] for shade in _overlaps(design, gear, angle)]
    marks = _loads(loaded) if loaded else [*shades, *_gaps(design, angle_deg)]
    (x, y), width = _view(design, angle, loaded)
    sizes = design.drive.module, design.major_semi_axis
    lines = {"type": "linear", "showgrid": False, "zeroline": False, "title": {"text": "mm"}}
    return {
        "data": [*traces, *marks],
        "layout": {
            **({} if loaded else {"coloraxis": _gap_colours(design)}),
            "uirevision": f"{loaded is None} {np.round(np.log(sizes) / OTHER_SIZE)}",
            "dragmode": "pan",
            "margin": {"l": 45, "r": 10, "t": 30, "b": 40},
            "showlegend": len(design.gears) > 2,
            "legend": {"x": 0.0, "y": 1.0, "bgcolor": "rgba(0,0,0,0)"},
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
        "config": {
            "scrollZoom": True,
            "displaylogo": False,
            "responsive": True,
            "modeBarButtonsToRemove": ["select2d", "lasso2d"],  # nothing follows from a selection
        },
    }


def moved(figure: dict[str, Any], before: dict[str, Any]) -> dict[str, Any]:
    """The figure, such that Plotly moves the curves and the marks of gaps that are drawn and leaves
    axes and bar as they are; itself where more has changed since the figure before."""
    layout = figure["layout"]
    names, former = ([trace["name"] for trace in one["data"]] for one in (figure, before))
    if "coloraxis" not in layout or layout != before["layout"] or names != former:
        return figure
    return figure | {"layout": layout | {"transition": {"duration": 0}}}


def _view(design: DriveDesign, angle: float, loaded: LoadedOutline | None) -> tuple[Floats, float]:
    """Middle (2,) mm and width (mm) of what is shown first. angle : rad, of the cam"""
    usual, top = 7.0 * np.pi * design.drive.module, design.major_semi_axis
    top += design.flexible_spline.rim
    if loaded is not None:
        place = loaded.pairs.place
        lobe = np.abs(np.arctan2(place[:, 0], place[:, 1])) < np.pi / design.wave_generator.lobes
        if lobe.any():
            low, high = place[lobe].min(axis=0), place[lobe].max(axis=0)
            return 0.5 * (low + high), max(usual, 1.3 * float(high[0] - low[0]))
    return np.array([-top * np.sin(angle), top * np.cos(angle)]), usual


def _body(name: str, curves: list[Floats]) -> dict[str, Any]:
    """A filled body; a curve inside another one, run through the other way, is its hole."""
    drawn: list[Floats] = []
    for index, curve in enumerate(curves):
        closed = np.vstack([curve, curve[:1]])
        turned = closed if _runs_left(curve) == (index == 0) else closed[::-1]
        drawn += [turned, BREAK]
    text, colour = name.replace("_", " "), COLOURS[name]
    return _filled(np.vstack(drawn[:-1]), text, f"{colour}66", colour) | {"hoverinfo": "skip"}


def _behind(design: DriveDesign, gear: GearName, angle: float) -> dict[str, Any]:
    """Teeth of a ring gear behind the other one, as a line. angle : rad, of the cam"""
    teeth = inner_teeth(design.profile(gear), design.teeth(gear).n_teeth, design.drive.module)
    curve = rotated(np.concatenate([teeth, teeth[:1]]), _turned(design, gear, angle))
    line = _filled(curve, gear.replace("_", " "), "rgba(0,0,0,0)", COLOURS[gear])
    return line | {"fill": "none", "hoverinfo": "skip", "showlegend": True}


def _turned(design: DriveDesign, gear: GearName, angle: float) -> float:
    """Angle (rad) of a ring gear after the cam has turned by `angle` (rad) and the flexible spline
    has rolled in both; 0 of the one that rests."""
    return angle * (1.0 - design.drive.teeth_rg / design.teeth(gear).n_teeth)


def _filled(points: Floats, name: str, inside: str, outline: str) -> dict[str, Any]:
    """Areas within closed curves of points (n, 2), mm, and their outlines; two colours."""
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": _packed(points[:, 0]),
        "y": _packed(points[:, 1]),
        "fill": "toself",
        "fillcolor": inside,
        "line": {"color": outline, "width": 1},
        "showlegend": False,
    }


def _overlaps(design: DriveDesign, gear: GearName, angle: float) -> list[dict[str, Any]]:
    """Areas of a ring gear that teeth cover on their whole path, in all slots, and those at the
    angle of the cam, rad; none where teeth have clearance."""
    profiles = design.profile("flexible_spline"), design.profile(gear)
    slot = slot_overlap(*profiles, design.tooth_motion(ring=gear), design.drive.module)
    if not slot.path:
        return []
    turned = _turned(design, gear, angle)
    slots = turned + slot.pitch * np.arange(design.teeth(gear).n_teeth)
    path = [rotated(curve, place) for place in slots for curve in slot.path]
    covered = [rotated(curve, turned) for curve in slot.covered(angle - turned)]
    what = f"overlap with the {gear.replace('_', ' ')}"
    return [
        _shade(path, f"{what} at some angle of the cam", "40"),
        _shade(covered, f"{what} at this angle", "d0"),
    ]


def _shade(curves: list[Floats], text: str, opacity: str) -> dict[str, Any]:
    """Areas inside of closed curves (n, 2), mm. opacity : two hexadecimal digits"""
    points = np.vstack([each for curve in curves for each in (curve, curve[:1], BREAK)] or [BREAK])
    colour = f"{OVERLAP}{opacity}"
    hover = {"hoveron": "fills", "text": text, "hoverinfo": "text"}
    return _filled(points, text, colour, colour) | hover


def _bar(title: str) -> dict[str, Any]:
    """Bar of colours, whose title is beside it: above, it touches the largest number."""
    return {"title": {"text": title, "side": "right"}, "thickness": 12}


def _packed(values: Floats) -> dict[str, str]:
    """Numbers as Plotly reads them fastest: single precision, to 4 nm at 70 mm."""
    return {"dtype": "f4", "bdata": b64encode(values.astype("<f4").tobytes()).decode()}


def _runs_left(curve: Floats) -> bool:
    """Whether a closed curve runs counter-clockwise."""
    x, y = curve.T
    return bool((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() > 0.0)


def _rounded(values: Floats) -> list[float]:
    """mm, to a tenth of a µm."""
    rounded: list[float] = np.round(values, 4).tolist()
    return rounded


def _gaps(design: DriveDesign, angle_deg: float) -> list[dict[str, Any]]:
    """Gaps of flanks to each ring gear, and overlaps above them, the smallest on top."""
    apart, overlaps = [], []
    for gear, symbol in zip(design.gears[1:], ("circle", "diamond"), strict=False):
        found = flank_gaps(design, angle_deg, gear)
        found = found.taken(np.argsort(-found.gap, kind="stable"))
        apart.append(_marks(found.taken(found.gap >= 0.0), gear, "gap", symbol))
        if (deep := found.gap < 0.0).any():
            overlaps.append(_marks(found.taken(deep), gear, "overlap, gap", "x"))
    return [*apart, *overlaps]


def _gap_colours(design: DriveDesign) -> dict[str, Any]:
    """Colours of gaps, with their bar."""
    return {
        "cmin": 0.0,
        "cmax": 1e3 * NEAR * design.drive.module,
        "colorscale": [[0.0, OVERLAP], [1e-6, TOUCHING], [1.0, APART]],
        "colorbar": _bar("gap, µm"),
    }


def _marks(found: FlankGaps, gear: GearName, word: str, symbol: str) -> dict[str, Any]:
    """Marks of gaps to a ring gear. Each is known by its flank, and a change moves it."""
    sides = np.where(found.clockwise, "clockwise", "counter-clockwise")
    ring = gear.replace("_", " ")
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "gaps",
        "showlegend": False,
        "x": _packed(found.place[:, 0]),
        "y": _packed(found.place[:, 1]),
        "ids": [f"tooth {n}, {side}" for n, side in zip(found.tooth, sides, strict=True)],
        "marker": {
            "size": 6 if symbol == "x" else 7,
            "symbol": symbol,
            "color": np.round(1e3 * found.gap, 3).tolist(),
            "coloraxis": "coloraxis",
        },
        "hovertemplate": f"%{{id}}, {ring}: {word} %{{marker.color:.2f}} µm<extra></extra>",
    }


def _loads(loaded: LoadedOutline) -> list[dict[str, Any]]:
    """Tension of the deformed surfaces, and pairs of flanks as discs by their shares."""
    pairs = loaded.pairs
    tension = {
        "type": "scatter",
        "mode": "markers",
        "name": "tension",
        "showlegend": False,
        "x": _rounded(loaded.place[:, 0]),
        "y": _rounded(loaded.place[:, 1]),
        "marker": {
            "size": 6,
            "color": np.round(loaded.s1, 1).tolist(),
            "cmin": 0.0,
            "cmax": float(loaded.s1.max()),
            "colorscale": [[0.0, TOUCHING], [1.0, OVERLAP]],
            "colorbar": _bar("s1, MPa"),
        },
        "hovertemplate": "largest principal stress %{marker.color:.1f} MPa<extra></extra>",
    }
    forces = {
        "type": "scatter",
        "mode": "markers+text",
        "name": "pairs",
        "showlegend": False,
        "x": _rounded(pairs.place[:, 0]),
        "y": _rounded(pairs.place[:, 1]),
        "marker": {
            "size": (10.0 + 30.0 * np.sqrt(pairs.share)).tolist(),
            "color": "rgba(0,0,0,0)",
            "line": {"color": OVERLAP, "width": 2},
        },
        "text": [f"{100.0 * share:.0f} %" for share in pairs.share],
        "textposition": "top center",
        "hovertext": [
            f"tooth {tooth:.0f} on {ring:.0f}: {force:.3g} N, {100.0 * share:.1f} % of all"
            + (f", {pressure:.4g} MPa" if np.isfinite(pressure) else "")
            for tooth, ring, force, share, pressure in zip(
                pairs.tooth, pairs.ring_tooth, pairs.force, pairs.share, pairs.pressure, strict=True
            )
        ],
        "hoverinfo": "text",
    }
    return [tension, forces]
