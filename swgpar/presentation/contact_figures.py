"""Figures of the contacts of flanks: pairs, how they share the load, and the pressure on them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from swgpar.errors import InputError
from swgpar.results.figure_set import from_zero, new_figure, panels, plot_line
from swgpar.results.table import Columns

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_FLANKS = 24
"""In the contact pattern, those with the largest forces."""

CELL = re.compile(r"p\d+_MPa")
"""Names of the columns of contact_lines.csv with the pressures of cells."""

ANGLE = "angle of the wave generator (degrees)"
ANGLE_AGAINST_RING = "angle of the wave generator against the ring gear (degrees)"


def _from_lobe(pairs: Columns, lobes: int) -> np.ndarray:
    """Angles (n,) of the pairs from the tip of the nearest lobe, degrees."""
    half = 180.0 / lobes
    return (pairs["angle_deg"] + half) % (2.0 * half) - half


def draw_pairs(pairs: Columns, lobes: int = 2) -> Figure:
    """Force and largest pressure of the pairs over the tooth's angle. pairs : columns of
    pairs.csv"""
    position = _from_lobe(pairs, lobes)
    figure, (upper, lower) = panels(2, 7.0, 6.0, shared=True)
    for axes, name in ((upper, "force_N"), (lower, "pressure_MPa")):
        for side, colour in (("clockwise", "tab:orange"), ("counter-clockwise", "tab:blue")):
            for edge, fill in ((0, colour), (1, "none")):
                chosen = (pairs["flank"] == side) & (pairs["edge"] == edge)
                label = f"{side} flank" + (", on an edge" if edge else "")
                if chosen.any():
                    axes.plot(
                        position[chosen],
                        pairs[name][chosen],
                        "o",
                        ms=4,
                        mec=colour,
                        mfc=fill,
                        label=label,
                    )
        from_zero(axes)
    upper.set(ylabel="normal force (N)", title="pairs of flanks in contact, at all computed angles")
    lower.set(ylabel="largest pressure (MPa)", xlabel="tooth, from the major axis (degrees)")
    figure.legend(
        *upper.get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=8
    )
    return figure


def draw_load_sharing(pairs: Columns, history: Columns, title: str, lobes: int = 2) -> Figure:
    """Share of every pair in the force, and the number of pairs.

    pairs, history : columns of these tables;  title : of the axis with the angle of the wave
    generator
    """
    figure, (upper, lower) = panels(2, 7.0, 6.0)
    far = np.abs(pairs["angle_deg"]) > 180.0 / lobes
    angle, share = _from_lobe(pairs, lobes), 100.0 * pairs["force_share"]
    other = ", other end" if lobes == 2 else ", other lobes"
    for side, colour in (("clockwise", "tab:orange"), ("counter-clockwise", "tab:blue")):
        for end, mark in ((~far, "o"), (far, "x")):
            chosen = (pairs["flank"] == side) & end
            if chosen.any():
                label = f"{side} flank" + (other if mark == "x" else "")
                upper.plot(
                    angle[chosen], share[chosen], mark, ms=5, mec=colour, mfc="none", label=label
                )
    upper.set(xlabel="pair, from the major axis (degrees)", ylabel="share of the force (%)")
    upper.set_title(
        "force of a pair over that of all pairs of its ring gear, at all computed angles",
        fontsize=10,
    )
    figure.legend(loc="outside lower center", ncols=3, fontsize=8)
    rows = np.unique(pairs["increment"]).astype(int) - 1
    if "pairs_in_contact" in history:  # not in a result of another version
        angles, count = history["wg_angle_deg"][rows], history["pairs_in_contact"][rows]
        plot_line(lower, angles, count, "o-", drawstyle="steps-mid", ms=4)
    lower.set(xlabel=title, ylabel="pairs in contact")
    for axes in (upper, lower):
        from_zero(axes)
    return figure


def draw_contact_pattern(pairs: Columns, lines: Columns, step: int | None, plane: bool) -> Figure:
    """Pressure on all loaded flanks: that of the cells, at their places.

    pairs, lines : columns of pairs.csv and contact_lines.csv
    step : of the history; None for that with the largest pressure. Raises InputError where no flank
    touches at it
    """
    if "cell_width_mm" not in lines:
        raise InputError(
            "contact_lines.csv has no cells: allowed with results of this version of swgpar"
        )
    if step is None:
        step = int(pairs["step"][np.nan_to_num(pairs["pressure_MPa"]).argmax()])
    increment = pairs["increment"][pairs["step"] == step].max(initial=0.0)  # the last one of a step
    chosen = np.flatnonzero((pairs["increment"] == increment) & np.isfinite(pairs["pressure_MPa"]))
    if not len(chosen):
        raise InputError(
            f"step = {step} has no flanks in contact: allowed are steps of result.pairs"
        )
    chosen = np.sort(chosen[np.argsort(-pairs["force_N"][chosen])][:MOST_FLANKS])
    flanks = [_Flank(pairs, lines, int(k)) for k in chosen]
    figure = new_figure(figsize=(10.0, 6.0), layout="constrained")
    angle = pairs["wg_angle_deg"][chosen[0]]
    figure.suptitle(
        f"contact of the flanks, angle of the wave generator {angle:.3g} degrees", fontsize=10
    )
    if plane:
        _draw_pressure_lines(figure, flanks)
    else:
        side = "ring gear" if "ring" in pairs else "open end of the cup"
        _draw_pressure_maps(figure, flanks, f"z (mm), {side} at negative z")
    return figure


class _Flank:
    """The pressure on a flank in contact: cells at the stations along its face width.

    pairs, lines : columns of the tables;  k : row of the pair

    Attributes
    ----------
    name : the flank and what it carries
    pressure : (n, m) MPa, of the cells across at the stations, constant on each
    s, z : (n, m + 1) and (n, 2) mm, edges of the cells across and along the face width
    """

    def __init__(self, pairs: Columns, lines: Columns, k: int) -> None:
        edge = ", on an edge" if pairs["edge"][k] else ""
        load = f"{pairs['force_N'][k]:.3g} N, {pairs['pressure_MPa'][k]:.4g} MPa{edge}"
        ring = f", {pairs['ring'][k].replace('_', ' ')}" if "ring" in pairs else ""
        self.name = f"tooth {pairs['tooth'][k]:.0f}, {pairs['flank'][k]}{ring}\n{load}"
        names = ("increment", "tooth", "flank", "ring_tooth", "ring")
        here = np.all([lines[name] == pairs[name][k] for name in names if name in pairs], axis=0)
        cells = [name for name in lines if CELL.fullmatch(name)]
        self.pressure = np.column_stack([lines[name][here] for name in cells])
        first, width = lines["first_cell_mm"][here], lines["cell_width_mm"][here]
        edges = np.arange(len(cells) + 1) - 0.5
        self.s = first[:, None] + width[:, None] * edges
        half = 0.5 * lines["cell_length_mm"][here]
        self.z = lines["z_mm"][here][:, None] + half[:, None] * np.array([-1.0, 1.0])

    def loaded(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners (n, 4, 2) mm, z and s, of the cells that carry a pressure, and it (n,) MPa."""
        station, cell = np.nonzero(self.pressure > 0.0)
        low, high = self.s[station, cell], self.s[station, cell + 1]
        left, right = self.z[station].T
        corners = np.array([[left, low], [right, low], [right, high], [left, high]])
        return corners.transpose(2, 0, 1), self.pressure[station, cell]


def _draw_pressure_lines(figure: Figure, flanks: list[_Flank]) -> None:
    axes = figure.add_subplot()
    for flank in flanks:
        axes.stairs(flank.pressure[0], flank.s[0], label=flank.name, lw=1.2)
    axes.set(
        xlabel="arc length from the tip (mm)", ylabel="contact pressure (MPa)", ylim=(0.0, None)
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)


def _draw_pressure_maps(figure: Figure, flanks: list[_Flank], along: str) -> None:
    from matplotlib import colormaps
    from matplotlib.collections import PolyCollection

    columns = min(5 if len(flanks) > 8 else 4, len(flanks))
    rows = -(-len(flanks) // columns)
    figure.set_size_inches(12.0, max(5.0, 2.2 * rows + 1.0))
    maps = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
    cells = [flank.loaded() for flank in flanks]
    corners = np.concatenate([places.reshape(-1, 2) for places, _ in cells])
    width = np.abs(corners[:, 0]).max()
    low, high = corners[:, 1].min(), corners[:, 1].max()
    margin = 0.1 * (high - low)
    top = max(pressure.max() for _, pressure in cells)
    for axes, flank, (places, pressure) in zip(maps, flanks, cells):
        image = PolyCollection(
            list(places), array=pressure, cmap="magma", edgecolors="face", lw=0.2
        )
        image.set_clim(0.0, top)
        axes.add_collection(image)
        axes.set(facecolor=colormaps["magma"](0.0), xlim=(-1.05 * width, 1.05 * width))
        axes.set_title(flank.name, fontsize=8 if rows == 1 else 7)
        axes.tick_params(labelsize=8)
    maps[0].set_ylim(high + margin, max(0.0, low - margin))  # the tip is above
    for axes in maps[len(flanks) :]:
        axes.set_axis_off()
    figure.supxlabel(along, fontsize=9)
    figure.supylabel("arc length from the tip (mm)", fontsize=9)
    figure.colorbar(image, ax=list(maps), label="contact pressure (MPa)")
