"""Data of a run of a drive: history, summary, mesh and fields, in memory or from the files of a
run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields as fields_of
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import numpy as np
from mpi4py import MPI

from swgpar.design.sections import GearName
from swgpar.drive_results.drive_tables import DriveTables, read_tables, table_files
from swgpar.drive_results.summary import DriveSummary
from swgpar.drive_results.summary_file import summary_from
from swgpar.errors import InputError
from swgpar.geometry.rotation import SIXTHS, sixths_of_turn
from swgpar.results import history
from swgpar.results.atomic import agreed
from swgpar.results.field_sources import BodyMesh, FieldFiles, FieldSource, chosen_increment
from swgpar.results.folder import FIELD_INDEX, SUMMARY, read_summary
from swgpar.results.history import Curves, Row

if TYPE_CHECKING:
    import pyvista

UPPER = np.triu_indices(3)
"""Rows and columns of the components of a tensor, xx xy xz yy yz zz."""

SPLINE: GearName = "flexible_spline"


class FlankPressure(NamedTuple):
    """Contact pressure on the flanks of the flexible spline.

    s : (n_s,) mm, arc length from the tip;  z : (n_z,) mm, along the face width
    pressure : (teeth, 2, n_s, n_z) MPa, nodal means; the clockwise flank of every tooth first
    """

    s: np.ndarray
    z: np.ndarray
    pressure: np.ndarray


class DriveData(DriveTables):
    """What a run of a drive gives, without figures; the same on every rank.

    Every rank calls the methods together: fields that are in memory are gathered.

    Attributes
    ----------
    history : dict of (n,) arrays
        Columns of history.csv, a value for every increment, for example ``history["fs_s1"]`` in
        MPa.
        ``pandas.DataFrame(result.history)`` makes a table of it.
    summary : DriveSummary
        A mapping of all answers by name: ``summary["mean.fs_s1"].value``, with their units, errors
        and places. Its attributes are what the answers are made of: ``summary.root_stress``,
        ``summary.stiffness``, ``summary.fatigue``, ``summary.design`` and so on; None for what the
        run does not have.
    pairs : dict of (n,) arrays
        Columns of pairs.csv, a value for every pair of flanks in contact at every computed
        increment under load.
    contact_lines : dict of (n,) arrays
        Columns of contact_lines.csv, a value for every station along the face width of these
        contacts.
    fatigue : SectorFields or None
        With [fatigue]: safety factors, amplitude and mean at the nodes of one sector;
        ``fatigue.fields["amplitude"]``.
    fatigue_cycle : dict of (n,) arrays
        Columns of fatigue_cycle.csv: stress over a cycle where the safety is the least.
    losses : dict of (n,) arrays
        Columns of losses.csv: losses at the angles of the sampled period.
    program : dict of (n,) arrays
        Columns of program.csv, a value for every point of a load program: torque and rotation of
        the output.
    transmission_error : dict of (n,) arrays
        Columns of transmission_error.csv: angles of input and output, transmission error and input
        torque over the sampled period, or with ``[deviations]`` over whole turns.
        ``summary.transmission_error`` has what follows.
    balls : dict of (n,) arrays
        Columns of balls.csv, a value for every ball of a bearing at every computed increment; empty
        without a bearing.
    bolts : dict of (n,) arrays
        Columns of bolts.csv, a value for every bolt at every computed increment; empty without
        bolts.
    folder : Path or None
        The results folder; None when the run was in memory.
    """

    def __init__(
        self,
        rows: Sequence[Row],
        summary: DriveSummary,
        tables: DriveTables,
        fields: FieldSource | None,
        comm: MPI.Comm,
        folder: Path | None = None,
    ) -> None:
        super().__init__(*(getattr(tables, one.name) for one in fields_of(DriveTables)))
        self.rows, self.summary, self.folder = rows, summary, folder
        self.history: dict[str, np.ndarray] = history.columns(rows)
        self.fields, self.comm = fields, comm

    def __repr__(self) -> str:
        where = f" in {self.folder}" if self.folder else ""
        return (
            f"<{type(self).__name__} of {len(self.history['step'])} increments, {self.increments} "
            f"with fields{where}>"
        )

    @property
    def increments(self) -> int:
        """Number of increments with fields; 0 with ``output.fields = false``."""
        return len(self.fields.increments) if self.fields is not None else 0

    @property
    def field_increments(self) -> tuple[int, ...]:
        """Numbers of the increments with fields: their rows in the history, from 1."""
        return tuple(self.fields.increments) if self.fields is not None else ()

    @property
    def design_table(self) -> dict[str, Any]:
        """The whole design, defaults included."""
        return self.summary.design.model_dump()

    @property
    def is_plane(self) -> bool:
        """Whether the drive is a plane model."""
        return self.summary.design.drive.model == "plane"

    @property
    def gears(self) -> tuple[GearName, ...]:
        """The gears, flexible spline first."""
        return tuple(name for name in get_args(GearName) if name in self.summary.bodies)

    def curves(self) -> Curves:
        """Columns of the history under load, over one period where the rotation was sampled."""
        kinematics = self.summary.design.kinematics
        return history.curves(
            self.history,
            self.summary.design.steps.samples,
            self.summary.increments,
            float(np.degrees(kinematics.period_angle)),
            kinematics.shown_ratio,
        )

    def cam_angle(self, number: int) -> float:
        """Angle (rad) of the cam in the fields of an increment by its number, from 1; 0 where the
        wave generator is fixed."""
        angle = float(np.radians(self.history["wg_angle_deg"][number - 1]))
        return self.summary.design.kinematics.in_frame_of_result(angle, angle)

    def mesh(self, body: GearName = SPLINE) -> BodyMesh:
        """Undeformed mesh of the modelled part of a body.

        A drive that equals itself after a turn by one lobe is modelled by a half, or a third with
        three lobes. Nodes are numbered sector by sector, so that those between two sectors appear
        twice. A plane model is one layer of elements.

        Parameters
        ----------
        body : "flexible_spline", "ring_gear", or in a pancake drive "dynamic_spline"

        Returns
        -------
        points : (n, 3) float64, mm
        cells : (m, 8) int64, hexahedra in the order of VTK

        Raises
        ------
        InputError
            The run kept no fields, or there is no such body.
        """
        return self._source(body).mesh(body)

    def names(self, body: GearName = SPLINE, increment: int = -1) -> tuple[str, ...]:
        """Names of the fields of a body at an increment."""
        source = self._source(body)
        return source.names(body, chosen_increment(source.increments, increment))

    def field(self, name: str, increment: int = -1, body: GearName = SPLINE) -> np.ndarray:
        """A nodal field.

        Parameters
        ----------
        name : str
            "displacement" (mm), "stress" (MPa; components xx xy xz yy yz zz), "s1", "s3", "vm"
            (MPa; largest and smallest principal stress, von Mises stress), on the flexible spline
            also "pressure" (MPa; contact).
        increment : int
            Number of the increment among those with fields, from 0; negative ones count from the
            end.
        body : "flexible_spline", "ring_gear", or in a pancake drive "dynamic_spline"

        Returns
        -------
        (n,) or (n, components) array
            A value for every node of ``mesh(body)``, the same on every rank.

        Raises
        ------
        InputError
            There is no such field, increment or body.
        """
        source = self._source(body)
        number = chosen_increment(source.increments, increment)
        known = source.names(body, number)
        if name not in known:
            raise InputError(
                f"field {name!r} is not available on {body}: allowed {', '.join(known)}"
            )
        return source.read(body, name, number)

    def flank_pressure(self, increment: int = -1) -> FlankPressure:
        """Contact pressure on the flanks of the modelled teeth of the flexible spline.

        increment : as in `field`
        """
        pressure = self.field("pressure", increment)
        grids = self._source(SPLINE).flanks(SPLINE)
        teeth = self.summary.design.drive.teeth_fs // self.summary.copies
        return FlankPressure(grids.s, grids.z, pressure.reshape(teeth, -1)[:, grids.nodes])

    def grid(
        self, increment: int = -1, body: GearName | None = None, *, whole: bool = False
    ) -> pyvista.UnstructuredGrid:
        """Undeformed mesh with all fields of an increment as point data.

        ``grid.warp_by_vector("displacement")`` is the deformed drive.

        Parameters
        ----------
        increment : as in `field`
        body : "flexible_spline", "ring_gear", or None for all gears
            With all, the cell data "body" is 0 for the flexible spline, 1 for the ring gear and 2
            for the dynamic spline of a pancake drive; a field that a body does not have is NaN
            there.
        whole : bool
            Add what symmetry left out, if the model is a half or a third of the drive.
        """
        import pyvista

        bodies = self.gears if body is None else (body,)
        parts = [self._part(name, increment) for name in bodies]
        if whole:
            copies = self.summary.copies
            turns = SIXTHS[sixths_of_turn(copies, np.arange(1, copies))]
            parts += [_rotated(*part, turn) for turn in turns for part in parts]
            bodies = bodies * copies
        first = np.cumsum([0, *(len(points) for points, _, _ in parts)])
        cells = np.concatenate(
            [cells + start for start, (_, cells, _) in zip(first, parts, strict=False)]
        )
        points = np.concatenate([part[0] for part in parts])
        grid = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: cells}, points)
        known = {name: values for *_, fields in parts for name, values in fields.items()}
        for name, example in known.items():
            values = [
                fields.get(name, np.full((len(points), *example.shape[1:]), np.nan, example.dtype))
                for points, _, fields in parts
            ]
            grid.point_data[name] = np.concatenate(values)
        numbers = np.repeat(list(map(self.gears.index, bodies)), [len(part[1]) for part in parts])
        grid.cell_data["body"] = numbers
        return grid

    def _part(
        self, body: GearName, increment: int
    ) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
        names = self.names(body, increment)
        return *self.mesh(body), {name: self.field(name, increment, body) for name in names}

    def _source(self, body: GearName) -> FieldSource:
        bodies = list(self.summary.bodies)
        if body not in bodies:
            raise InputError(f"body {body!r} is not available: allowed {' or '.join(bodies)}")
        if self.fields is None or not self.fields.increments:
            raise InputError("this run kept no fields: allowed with output.fields = true")
        return self.fields


def _rotated(
    points: np.ndarray, cells: np.ndarray, fields: dict[str, np.ndarray], rotation: np.ndarray
) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """A part of the drive after a rotation (3, 3)."""
    out = dict(fields)
    if "displacement" in fields:
        values = fields["displacement"]
        out["displacement"] = values @ rotation.T.astype(values.dtype)
    if "stress" in fields:
        values = fields["stress"]
        tensor = np.empty((len(values), 3, 3), values.dtype)
        tensor[:, UPPER[0], UPPER[1]] = tensor[:, UPPER[1], UPPER[0]] = values
        turned = rotation.astype(values.dtype)
        out["stress"] = (turned @ tensor @ turned.T)[:, UPPER[0], UPPER[1]]
    return points @ rotation.T, cells, out


def open_data(folder: Path, comm: MPI.Comm) -> DriveData:
    """Data of a finished run from its folder; collective, every rank reads the files."""
    folder = folder.absolute()  # the fields are read later
    with agreed(comm, folder, "read"):
        stored, rows = read_summary(folder), history.read_history(folder / history.NAME)
        tables = read_tables(folder)
        found = {file: getattr(tables, name) for file, name in table_files().items()}
        stored.require_whole(folder, {**found, history.NAME: history.columns(rows)})
        summary = summary_from(stored, rows, tables.pairs, folder / SUMMARY)
    return DriveData(rows, summary, tables, open_fields(folder, comm), comm, folder)


def open_fields(folder: Path, comm: MPI.Comm) -> FieldFiles | None:
    """Fields in a results folder, None without any; collective."""
    present = comm.bcast((folder / FIELD_INDEX).exists() if comm.rank == 0 else None)
    with agreed(comm, folder / FIELD_INDEX, "read"):
        return FieldFiles(folder) if present else None
