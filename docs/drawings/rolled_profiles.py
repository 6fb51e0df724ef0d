"""S-shaped teeth and cycloid teeth, with the path and the rolling circles that make them."""

from __future__ import annotations

import numpy as np
from _drafting import (
    INK,
    NOTE,
    RING,
    SPLINE,
    arc,
    axis_line,
    canvases,
    label,
    leader,
    plane_with,
    run,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS, GearName
from swgpar.profiles import ToothProfile

S_SHAPED = {"type": "s_shaped", "r_root": 0.25}
CYCLOID = {"type": "cycloid", "r_epicycloid": 1.0, "r_hypocycloid": 1.0, "r_root": 0.2}
COLOURS = {"face": "#2f7fd0", "middle": "#111111", "flank": "#2d9a57", "root": "#d07a20"}


def both(profile: dict[str, object]) -> DriveDesign:
    """The plane reference drive with this profile on both gears."""
    return plane_with(flexible_spline={"profile": profile}, ring_gear={"profile": profile})


def tooth(profile: ToothProfile, r_pitch: float) -> np.ndarray:
    """Outline (n, 2) mm of a tooth of a rack: x across it, y up from the pitch line."""
    flank = profile.point(np.linspace(0.0, profile.length, 300)) - (0.0, r_pitch)
    return np.concatenate([flank[::-1], flank * (-1.0, 1.0)])


def path(ax: Axes, design: DriveDesign) -> None:
    """A tooth in its slot on the path of racks, and that path."""
    rack, module = design.rack_path(), design.drive.module
    spline, ring = (
        tooth(design.profile(gear), design.teeth(gear).r_pitch)
        for gear in ("flexible_spline", "ring_gear")
    )
    half = 0.5 * np.pi * module
    for side in (-1.0, 1.0):
        shifted = ring + (side * half, 0.0)
        edge = np.array([(shifted[:, 0].min(), 1.2), (shifted[:, 0].max(), 1.2)])
        ax.fill(*np.concatenate([shifted, edge]).T, fc=RING, alpha=0.6, lw=0)
    theta = np.linspace(0.0, 0.98 * np.pi, 200)
    x = rack.apart / rack.lobes * (theta - rack.kappa * np.sin(theta))
    y = rack.apart * (rack.kappa * np.cos(theta) - 1.0)
    for at in np.radians([0.0, 60.0, 90.0, 115.0, 135.0]):
        place = np.array([np.interp(at, theta, x), np.interp(at, theta, y)])
        ax.plot(*(spline + place).T, color=SPLINE, lw=1.1)
    ax.plot(x, y, color=NOTE, lw=1.4)
    ax.plot(*np.transpose([(x[0], y[0]), (x[-1], y[-1])]), ".", color=NOTE)
    leader(ax, (1.9, -1.2), "path of a tooth, X and Y", (float(x[120]), float(y[120])), fontsize=9)
    ax.set_xlim(-2.2, 3.4)
    ax.set_ylim(-2.0, 1.3)
    ax.set_title("a tooth in its slot, on the path of racks", fontsize=10)


def flank(ax: Axes, design: DriveDesign, gear: GearName, title: str) -> None:
    """One flank with its circles and its segments."""
    profile, r_pitch = design.profile(gear), design.teeth(gear).r_pitch
    half = np.degrees(np.pi / profile.n_teeth)
    points = profile.point(np.linspace(0.0, profile.length, 300))
    rim = profile.r_root_circle - (0.3 if profile.external else -0.3)
    end = np.radians(half)
    corner = rim * np.array([(np.sin(end), np.cos(end)), (0.0, 1.0)])
    root = profile.r_root_circle * np.array([(np.sin(end), np.cos(end))])
    outline = np.concatenate([[(0.0, profile.r_tip_circle)], points, root, corner])
    ax.fill(*outline.T, fc=SPLINE if profile.external else RING, alpha=0.35, lw=0)
    for radius, name in (
        (profile.r_tip_circle, "$r_A$"),
        (r_pitch, "$r_P$"),
        (profile.r_root_circle, "$r_D$"),
    ):
        line = arc((0.0, 0.0), radius, 90.0 + 0.3 * half, 90.0 - 1.2 * half)
        ax.plot(*line.T, color=INK, lw=0.6, dashes=(12, 3, 2, 3) if radius == r_pitch else (5, 2))
        label(ax, (line[-1][0] + 0.1, line[-1][1]), name, color=INK, ha="left")
    for begin, segment in zip(profile.breaks, profile.segments, strict=False):
        part = profile.point(np.linspace(begin, begin + segment.length, 80))
        ax.plot(*part.T, color=COLOURS[segment.name], lw=2.6)
    low, high = sorted((profile.r_tip_circle, profile.r_root_circle))
    axis_line(ax, (0.0, low - 0.4), (0.0, high + 0.4))
    ax.set_title(title, fontsize=10)


def s_shaped() -> Figure:
    """The path, and a flank of the flexible spline."""
    design = both(S_SHAPED)
    figure, axes = canvases(11.0, 4.6, 1, 2, width_ratios=(1.6, 1.0))
    path(axes[0], design)
    flank(axes[1], design, "flexible_spline", "tooth of the flexible spline")
    profile = design.profile("flexible_spline")
    faces, below = (
        profile.point(0.5 * (profile.breaks[k] + profile.breaks[k + 1]))[0] for k in (0, 2)
    )
    leader(axes[1], (1.25, 60.45), "half of the path", tuple(faces), color=COLOURS["face"])
    leader(axes[1], (0.45, 59.4), "its image", tuple(below), color=COLOURS["flank"])
    return figure


def rolling(ax: Axes, r_pitch: float, rho: float, at: np.ndarray, centre: float) -> None:
    """A rolling circle that touches the pitch circle at the angle `centre` (rad from +y), and the
    point of it on the flank."""
    middle = (r_pitch + rho) * np.array([np.sin(centre), np.cos(centre)])
    ax.plot(*arc(tuple(middle), abs(rho), 0.0, 360.0).T, color=NOTE, lw=0.9)
    ax.plot(*np.transpose([middle, at]), color=NOTE, lw=0.7)
    ax.plot(*middle, "+", color=NOTE)
    ax.plot(*at, "o", color=NOTE, ms=4)


def cycloid() -> Figure:
    """Both gears with the circles whose points move on the flanks."""
    design = both(CYCLOID)
    figure, axes = canvases(9.0, 5.4, 1, 2)
    for ax, gear, title in zip(
        axes,
        GEARS,
        ("external tooth (flexible spline)", "internal tooth (ring gear)"),
        strict=True,
    ):
        profile, r_pitch = design.profile(gear), design.teeth(gear).r_pitch
        flank(ax, design, gear, title)
        out, start = 1.0 if profile.external else -1.0, 0.5 * np.pi / profile.n_teeth
        for index, side in ((0, 1.0), (2, -1.0)):
            rho = out * side
            at = profile.point(0.5 * (profile.breaks[index] + profile.breaks[index + 1]))[0]
            # the circle has rolled to where its centre is one radius away from the point
            places = start - side * np.linspace(0.0, 3.0, 3001) / r_pitch
            centres = (r_pitch + rho) * np.column_stack([np.sin(places), np.cos(places)])
            place = places[np.abs(np.linalg.norm(centres - at, axis=1) - 1.0)[200:].argmin() + 200]
            rolling(ax, r_pitch, rho, at, place)
            name = "r_epicycloid" if rho > 0.0 else "r_hypocycloid"
            centre = (r_pitch + rho) * np.array([np.sin(place), np.cos(place)])
            label(ax, (centre[0], centre[1] + 0.2 * rho), name, fontsize=8)
        ax.set_xlim(-1.3, 2.9)
        ax.set_ylim(r_pitch - 2.2, r_pitch + 2.2)
    return figure


if __name__ == "__main__":
    run({"profile_s_shaped": s_shaped, "profile_cycloid": cycloid})
