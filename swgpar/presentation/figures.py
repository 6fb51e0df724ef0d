"""Figures of a drive's result."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from mpi4py import MPI

from swgpar.design.kinematics import Kinematics
from swgpar.drive_results.drive_data import SPLINE, DriveData
from swgpar.errors import InputError
from swgpar.evaluation.transmission_error import orders
from swgpar.meshing.drive_geometry import DriveGeometry
from swgpar.presentation.ball_figure import draw_ball_loads
from swgpar.presentation.circumference_figure import FIELDS, draw_circumference
from swgpar.presentation.contact_figures import (
    ANGLE,
    ANGLE_AGAINST_RING,
    draw_contact_pattern,
    draw_load_sharing,
    draw_pairs,
)
from swgpar.presentation.deformed_figures import (
    draw_cup_section,
    draw_deformed,
    draw_loaded_teeth,
    draw_plane_deformed,
)
from swgpar.presentation.fatigue_figures import draw_haigh, sector_picture
from swgpar.presentation.program_figures import torque_against_rotation
from swgpar.presentation.sections import PlaneBody
from swgpar.results.field_sources import chosen_increment
from swgpar.results.figure_set import (
    FEWEST,
    Drawings,
    FigureSet,
    from_zero,
    new_figure,
    panels,
    plot_line,
)
from swgpar.results.history import COLUMNS
from swgpar.results.sector_fields import SectorFields

if TYPE_CHECKING:
    import pyvista
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

T = TypeVar("T")

STRESSES = ("fs_s1", "fs_s3", "fs_vm", "rg_vm")
"""Columns of the history in the figure of stresses."""


class DriveFigures(FigureSet):
    """Figures of a drive: each method draws one and returns a matplotlib figure.

    `save` writes all of them. Every rank calls it, and the methods whose figures show fields.
    """

    exact_size = ("deformed_drive", "loaded_teeth", "cup_section", "safety")
    pictures = ("deformed_drive", "safety")

    def __init__(self, result: DriveData, comm: MPI.Comm, *, gathered: bool) -> None:
        super().__init__(comm, gathered=gathered)
        self._result = result
        self._drawn: dict[int, list[pyvista.UnstructuredGrid]] = {}

    @property
    def drawings(self) -> Drawings:
        result = self._result
        pressure = result.pairs["pressure_MPa"] if result.pairs else ()
        available: dict[str, object] = {
            "stress": True,
            "torque_against_rotation": result.program,
            "torque_and_transmission_error": not result.program,
            "transmission_error_spectrum": result.transmission_error,
            "pairs": result.pairs,
            "load_sharing": result.pairs,
            "contact_pattern": np.isfinite(pressure).any()
            and "cell_width_mm" in result.contact_lines,
            "haigh": result.fatigue,
            "safety": result.fatigue,
            "ball_loads": result.balls,
            "deformed_drive": result.increments,
            "loaded_teeth": result.increments,
            "cup_section": result.increments and self._has_cup,
            "stress_around": result.increments,
        }
        methods = {name: name for name in available} | {"deformed_drive": "deformed"}
        return {name: getattr(self, methods[name]) for name, given in available.items() if given}

    def stress(self) -> Figure:
        """Largest stresses of both bodies (MPa) against the angle of the wave generator, under
        load."""
        figure = self._over_angle(self._draw_stress)
        figure.legend(loc="outside lower center", ncols=2, fontsize=8)
        return figure

    def _draw_stress(self, axes: Axes) -> None:
        for name in STRESSES:
            self._draw(axes, name, COLUMNS[name].label)
        root = self._result.summary.root_stress
        if root and root.period:
            label = "flexible spline, s1 at the teeth by windows"
            x, y = np.array(root.period).T
            plot_line(axes, x, y, "k^--", ms=4, lw=0.8, label=label)
        axes.set_title("largest stresses (nodal averages)" + self._over_period())
        axes.set_ylabel("stress (MPa)")
        from_zero(axes)

    def torque(self) -> Figure:
        """Input torque (N·mm) against the angle of the wave generator, beside that of the energy
        balance."""
        return self._over_angle(self._draw_torque)

    def transmission_error(self) -> Figure:
        """Angle of the output less its kinematic value (arc seconds) against the angle of the wave
        generator."""
        return self._over_angle(self._draw_transmission_error)

    def torque_and_transmission_error(self) -> Figure:
        """Input torque and transmission error in one figure."""
        return self._over_angle(self._draw_torque, self._draw_transmission_error)

    def transmission_error_spectrum(self) -> Figure:
        """Transmission error (arc seconds) over the angle of the input, and its orders of the
        input's turn.

        Over whole turns with deviations, or over the sampled period of the ideal drive.
        """
        rows = _needed(
            self._result.transmission_error, "transmission error", "steps.samples or [deviations]"
        )
        summary = self._result.summary.transmission_error
        figure, (upper, lower) = panels(2, 7.0, 6.0)
        error = rows["transmission_error_arcsec"]
        plot_line(upper, rows["wg_angle_deg"], error - error.mean(), lw=1.0)
        upper.set(xlabel=self._angle, ylabel="arc seconds")
        upper.set_title(f"transmission error less its mean, {summary.covered}")
        order, amplitude, _ = orders(summary.turns, rows)
        lower.vlines(order, 0.0, amplitude, lw=1.2)
        for line in summary.spectrum[:4]:
            label = f"{line.order:.4g}: {line.cause}"
            lower.plot(line.order, line.amplitude, "o", ms=4, label=label)
        lower.set(xlabel="order of the input's turn", ylabel="amplitude (arc seconds)")
        lower.set_ylim(0.0, None)
        if summary.spectrum:
            lower.legend(fontsize=7)
        return figure

    def _draw_torque(self, axes: Axes) -> None:
        rotation = self._result.summary.rotation
        driven, expected = rotation.input, rotation.wg_torque_expected_Nmm
        if driven:
            self._draw(axes, "input_torque_Nmm", "ring gear")
            expected = driven.torque_expected_Nmm
        else:
            self._draw(axes, "wg_torque_Nmm", "wave generator")
        axes.axhline(expected, color="0.4", ls="--", label="energy balance, T / ratio")
        axes.set(ylabel="torque (N·mm)", title="input torque" + self._over_period())
        axes.legend(fontsize=8)

    def _draw_transmission_error(self, axes: Axes) -> None:
        self._draw(axes, "transmission_error", None)
        axes.set_title("transmission error of the ideal drive: output less its kinematic angle")
        axes.set_ylabel("arc seconds")

    def torque_against_rotation(self) -> Figure:
        """Torque on the output (N·m) against its rotation (arc minutes), along a load program."""
        allowed = "load.program, [stiffness] or [ratcheting]"
        program = _needed(self._result.program, "load program", allowed)
        return torque_against_rotation(program, self._result.summary)

    def pairs(self) -> Figure:
        """Force (N) and largest contact pressure (MPa) of the pairs, over the tooth's angle from
        the major axis.

        All computed increments under load are drawn: a tooth goes through these positions one after
        the other. Pairs whose contact lies on an edge have hollow marks: their pressure is no
        property of the drive.
        """
        return draw_pairs(self._pairs(), self._kinematics.lobes)

    def load_sharing(self) -> Figure:
        """Share (%) of every pair in the forces between the flanks, over its angle from the major
        axis.

        All computed increments under load are drawn, and below the number of pairs at these angles.
        """
        pairs, history = self._pairs(), self._result.history
        return draw_load_sharing(pairs, history, self._angle, self._kinematics.lobes)

    def haigh(self) -> Figure:
        """Haigh's diagram of all nodes of a sector, and the normal stress over the cycle where the
        safety is the least.

        Runs with the section [fatigue] have it.
        """
        sector, cycle = self._fatigue(), self._result.fatigue_cycle
        return draw_haigh(sector, cycle, self._result.summary, self._angle)

    def safety(self) -> Figure:
        """One sector of the flexible spline, coloured by Goodman's safety factor."""
        return _as_figure(sector_picture(self._fatigue(), self._result.is_plane))

    def _pairs(self) -> Mapping[str, np.ndarray]:
        return _needed(self._result.pairs, "flanks in contact under load", "load.torque above 0")

    def _fatigue(self) -> SectorFields:
        return _needed(self._result.fatigue, "fatigue", "the section [fatigue]")

    def _draw(self, axes: Axes, name: str, label: str | None) -> None:
        """Draw a column under load: points where it was computed, and the curve through three or
        more."""
        curves = self._result.curves()
        if name not in curves.values:  # a result of another version
            return
        points: dict[str, Any] = {"ls": "none", "marker": "o", "ms": 3}
        if len(curves.angle) < FEWEST:
            axes.plot(curves.angle, curves.values[name], label=label, **points)
            return
        (line,) = axes.plot(curves.fine_angle, curves.fine[name], label=label)
        axes.plot(curves.angle, curves.values[name], color=line.get_color(), **points)

    @property
    def _angle(self) -> str:
        """Title of the axis with the column `wg_angle_deg`."""
        fixed = self._kinematics.wave_generator_is_fixed
        return ANGLE_AGAINST_RING if fixed else ANGLE

    def _over_angle(self, *draw: Callable[[Axes], None]) -> Figure:
        """Panels above one another, over the angle of the wave generator."""
        count = len(draw)
        figure, rows = panels(count, 7.0, 4.2 if count == 1 else 3.0 * count, shared=True)
        for axes, draw_row in zip(rows, draw):
            draw_row(axes)
        rows[-1].set_xlabel(self._angle)
        return figure

    def _over_period(self) -> str:
        return ", over one period" if self._result.summary.design.steps.samples else ""

    def ball_loads(self) -> Figure:
        """Loads of a bearing's balls (N) over the angle from the major axis, and the largest during
        the rotation."""
        balls = _needed(self._result.balls, "balls", "wave_generator.bearing")
        return draw_ball_loads(balls, self._result.summary.bearing, self._angle)

    def contact_pattern(self, step: int | None = None) -> Figure:
        """Pressure (MPa) on all loaded flanks, over arc length and face width.

        In the plane model over arc length. step : of the history; None for that with the largest
        pressure
        """
        result = self._result
        return draw_contact_pattern(self._pairs(), result.contact_lines, step, result.is_plane)

    def deformed(self, increment: int = -1, magnification: float = 1.0) -> Figure:
        """The deformed drive, coloured by von Mises stress: seen from its open end, a plane model
        along its axis.

        increment : as in `DriveData.field`;  magnification : of the displacements; above 1 bodies
        may seem to cross
        """
        when = self._when(increment)
        if self._result.is_plane:
            bodies = self._plane_bodies(increment, magnification)
            return draw_plane_deformed(bodies, magnification, when)
        return draw_deformed(self._grids(increment), magnification, when)

    def loaded_teeth(self, increment: int = -1) -> Figure:
        """Close-up of the pair of flanks with the largest force and the cam below it, by von Mises
        stress.

        A cup drive is cut across its axis where the pressure of this pair is the largest. Without a
        pair in contact the teeth at the major axis are shown. increment : as in `DriveData.field`
        """
        row, pairs = self._row(increment), self._result.pairs
        cam_angle = angle = self._result.cam_angle(row + 1)
        z = 0.0
        here = np.flatnonzero(pairs["increment"] == row + 1) if pairs else ()
        if len(here):
            largest = here[np.argmax(pairs["force_N"][here])]
            angle = cam_angle + float(np.radians(pairs["angle_deg"][largest]))
            z = float(np.nan_to_num(pairs["z_mm"][largest]))
        summary = self._result.summary
        cam = summary.design.cam_surface() if summary.bearing is None else None
        when, plane = self._when(increment), self._result.is_plane
        bodies = self._plane_bodies(increment) if plane else self._grids(increment)
        return draw_loaded_teeth(bodies, self._geometry, cam, cam_angle, angle, z, when)

    def cup_section(self, increment: int = -1) -> Figure:
        """Sections of the deformed cup along its axis, through the major and the minor axis, by von
        Mises stress.

        increment : as in `DriveData.field`
        """
        if not self._has_cup:
            raise InputError(
                f'drive.model = "{self._geometry.model}" has no cup: allowed with "cup"'
            )
        when, lobes = self._when(increment), self._kinematics.lobes
        angle = self._result.cam_angle(self._row(increment) + 1)
        grids = self._grids(increment)
        return draw_cup_section(grids, self._geometry, lobes, angle, when)

    def stress_around(self, increment: int = -1) -> Figure:
        """Largest s1 and von Mises stress (MPa) of every tooth's sector of the flexible spline,
        around it.

        increment : as in `DriveData.field`
        """
        result, row = self._result, self._row(increment)
        return draw_circumference(
            self._geometry,
            result.mesh(SPLINE).points,
            {name: result.field(name, increment, SPLINE) for name in FIELDS},
            self._kinematics.teeth_fs // result.summary.copies,
            float(np.radians(result.history["wg_angle_deg"][row])),
            self._when(increment),
        )

    @property
    def _has_cup(self) -> bool:
        return self._geometry.cup is not None

    @property
    def _kinematics(self) -> Kinematics:
        return self._result.summary.design.kinematics

    @cached_property
    def _geometry(self) -> DriveGeometry:
        return self._result.summary.design.geometry

    def _grids(self, increment: int) -> list[pyvista.UnstructuredGrid]:
        """Both whole bodies with their fields, kept for the next figure; collective where these are
        gathered. What follows is not."""
        if increment not in self._drawn:
            bodies = self._result.gears
            grids = [self._result.grid(increment, body, whole=True) for body in bodies]
            self._drawn = {increment: grids}
        return self._drawn[increment]

    def _plane_bodies(self, increment: int, factor: float = 1.0) -> list[PlaneBody]:
        """The same of a plane drive, deformed. factor : magnification of the displacements"""
        result, bodies = self._result, []
        for body in result.gears:
            points, cells = result.mesh(body)
            moved = points + factor * result.field("displacement", increment, body)
            mises = result.field("vm", increment, body)
            bodies.append(PlaneBody.of(moved, cells, mises, result.summary.copies))
        return bodies

    def _row(self, increment: int) -> int:
        """Row of the history, from 0, of an increment with fields."""
        return chosen_increment(self._result.field_increments, increment) - 1

    def _when(self, increment: int) -> str:
        row = self._row(increment)
        angle = self._result.history["wg_angle_deg"][row]
        return f"increment {row + 1}, wave generator at {angle:.3g} degrees"


def _needed(data: T | None, what: str, allowed: str) -> T:
    """Data of a result; raises InputError where it has none."""
    if not data:
        raise InputError(f"this run has no {what}: allowed with {allowed}")
    return data


def _as_figure(picture: np.ndarray) -> Figure:
    """A figure that shows a picture (height, width, 3) pixel by pixel."""
    height, width = picture.shape[:2]
    figure = new_figure(figsize=(width / 100.0, height / 100.0), dpi=100)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.imshow(picture)
    axes.set_axis_off()
    return figure
