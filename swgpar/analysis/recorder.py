"""What a run keeps of its increments: on disk in a results folder, or in memory."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from swgpar.analysis.identity import RunContent
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.mesh_refinement import ChosenMesh
from swgpar.analysis.restart import resume_run, save_run
from swgpar.analysis.run_record import RunRecord
from swgpar.drive_results.drive_data import DriveData, open_fields
from swgpar.drive_results.drive_tables import DriveTables, table_files, write_tables
from swgpar.drive_results.summary import DriveSummary
from swgpar.drive_results.summary_file import summary_from, summary_to_json
from swgpar.evaluation.bearing_loads import ball_rows
from swgpar.evaluation.bolt_loads import bolt_rows
from swgpar.evaluation.compliance import bearing_shares
from swgpar.evaluation.frequencies import natural_modes
from swgpar.evaluation.housing_values import housing_values, keep_largest
from swgpar.evaluation.losses import cam_force
from swgpar.evaluation.program_results import PointRow, point_rows
from swgpar.evaluation.result_frame import history_rows, nodal_fields
from swgpar.evaluation.stiffness import loop_rows
from swgpar.evaluation.stress_cycle import StressCycle
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.flank_pressure.pair_contact import PairContact, pair_contacts, touches_edges
from swgpar.input.toml_file import to_toml
from swgpar.largest_stress.accuracy import Accuracy
from swgpar.largest_stress.places import Place, find_places
from swgpar.largest_stress.resolved_places import with_windows
from swgpar.load.load_states import LoadState, Stage
from swgpar.meshing import SectorMesh
from swgpar.model.drive_model import DriveModel
from swgpar.model.nodal_pressure import nodal_pressure
from swgpar.results import history
from swgpar.results.atomic import agreed, on_root, write_from_root
from swgpar.results.field_sources import FieldParts
from swgpar.results.fields import BodyPart, FieldWriter, FlankGrids
from swgpar.results.folder import RECIPE, SUMMARY, StoredSummary, table_facts
from swgpar.results.history import Row
from swgpar.results.table import as_columns, as_rows, format_csv, read_columns

TURNS = "transmission_error.csv"

NodalFields = dict[str, dict[str, np.ndarray]]
"""Body -> name of the field -> values (n_sectors, n_local[, n_components]) of the owned sectors."""


class Recorder(ABC):
    """Keeps rows of the history and how the mesh was chosen; the two kinds keep fields and files.

    Every call is collective.

    Attributes
    ----------
    stepper : whose states are kept;  model, sequence : of it
    record : beside the fields
    cycle : stresses of the sampled period, with [fatigue] or [losses]
    """

    def __init__(self, stepper: LoadStepper) -> None:
        self.stepper, self.model, self.sequence = stepper, stepper.model, stepper.sequence
        self.comm, self.record = self.model.comm, RunRecord()
        self._contacts: list[PairContact] | None = None
        needed = self.model.design.fatigue or self.model.design.losses
        self.cycle = StressCycle(self.model, self.sequence) if needed else None

    def keep_choice(self, chosen: ChosenMesh, accuracy: float) -> None:
        """Keep the stress that the windows of a mesh chosen for an accuracy gave."""
        self.record.accuracy = Accuracy(
            asked=accuracy,
            estimated=chosen.error if np.isfinite(chosen.error) else None,
            reached=chosen.error <= accuracy,
        )
        self.record.root_stress = chosen.root_stress
        self.record.coarse_wall = chosen.coarse_wall
        self.record.contact_errors = chosen.contact_errors
        self.record.bearing_errors = chosen.bearing_errors

    def contacts(self) -> list[PairContact]:
        """Contacts of all touching pairs of the present state, which are computed once before it is
        kept; collective."""
        if self._contacts is None:
            self._contacts = pair_contacts(self.model, self.stepper.load_state)
        return self._contacts

    def keep(self, seconds: float, elapsed: float) -> None:
        """Keep the state after an increment.

        seconds : wall time of the increment;  elapsed : of the whole run, restarts included
        """
        model, state = self.model, self.stepper.load_state
        with model.phases("stress"):
            values, body_fields = model.stresses()
        race, housing = (
            {name: values.pop(name) for name in list(values) if name.startswith(part)}
            for part in ("race_", "housing_")
        )
        row = {**self.stepper.row(), **values, "wall_s": seconds}
        self.record.rows.append(history.plain_row(row))
        with model.phases("stress"):
            on_edge, self._contacts = self._keep_pairs(state), None
            self._keep_places(state, body_fields, on_edge)
            self._keep_balls(state, race)
            if model.design.is_bolted:
                number, step = len(self.record.rows), self.record.rows[-1]["step"]
                self.record.bolts += bolt_rows(model, state, number, step)
            if model.design.housing is not None and state.is_periodic:
                keep_largest(self.record.housing, housing_values(model, housing))
        with model.phases("fatigue and losses"):
            if self.cycle is not None:
                self.cycle.keep(state, body_fields[FLEXIBLE_SPLINE])
            if model.design.losses:
                self.record.cam_forces.append(cam_force(model))
        if model.design.frequencies is not None and state == self.sequence.loaded:
            with model.phases("frequencies"):
                self.record.modes = natural_modes(model, state)
        with model.phases("output"):
            fields = dict(body_fields)
            if model.design.output.fields:
                spline = model.elements.bodies[FLEXIBLE_SPLINE]
                pressure = nodal_pressure(model.problem, state, spline)
                fields[FLEXIBLE_SPLINE]["pressure"] = pressure
            self._keep(fields, elapsed)

    def _in_frame(self, fields: NodalFields) -> NodalFields:
        """The fields as they are shown: in the frame of the fixed member."""
        return nodal_fields(self.model, self.stepper.load_state.angle, fields)

    def _keep_places(self, state: LoadState, fields: NodalFields, on_edge: bool) -> None:
        """Find the places of stresses that are the largest under load so far."""
        if state.is_periodic:
            found = find_places(self.model, state, fields, on_edge=on_edge)
            if state == self.sequence.loaded:
                self.record.loaded = {name: place.value for name, place in found.items()}
            for name, place in found.items():
                if name not in self.record.places or place.value > self.record.places[name].value:
                    self.record.places[name] = place

    def resolved_places(self) -> dict[str, Place]:
        """The places with the stresses of windows, and with errors where they are known."""
        record = self.record
        return with_windows(record.places, record.loaded, record.root_stress, record.wall_stress)

    def _keep_pairs(self, state: LoadState) -> bool:
        """Keep the contacts of flanks under load; returns whether one lies on the edge of a
        tooth."""
        if not state.is_periodic or self.model.design.stiffness:
            return False
        record, row = self.record, self.record.rows[-1]
        when = {"increment": len(record.rows), **{n: row[n] for n in ("step", "wg_angle_deg")}}
        contacts = self.contacts()
        for contact in contacts:
            record.pairs.append({**when, **contact.row()})
            record.contact_lines += [{**when, **station} for station in contact.station_rows()]
        return touches_edges(contacts)

    def _keep_balls(self, state: LoadState, race: Mapping[str, float]) -> None:
        if self.model.design.bearing is not None:
            rows = self.record.rows
            self.record.balls += ball_rows(self.model, state, len(rows), rows[-1]["step"])
            if state.is_periodic:
                keep_largest(self.record.race_stress, race)
            asked = self.model.design.output.bearing_shares
            if asked and (state.stage == Stage.LOAD or self._has_largest_torque(state)):
                self.record.bearing_shares = bearing_shares(self.model, state)

    def _has_largest_torque(self, state: LoadState) -> bool:
        """Whether a point of the load program is the first one with its largest torque."""
        if state.stage != Stage.PROGRAM or state.control != "torque" or self.record.bearing_shares:
            return False
        torques = [abs(point.value) for point in self.sequence.points if point.control == "torque"]
        return abs(state.torque) >= 1000.0 * max(torques) * (1.0 - 1e-9)

    def keep_turns(self, rows: list[Row]) -> None:
        """Keep rows of transmission_error.csv in place of those before."""
        self.record.turns = rows

    def known_turns(self) -> list[Row]:
        """Rows of transmission_error.csv that the run which is continued has left."""
        return []

    def _shared(
        self, rows: list[Row], summary: DriveSummary, tables: DriveTables
    ) -> tuple[list[Row], DriveSummary, DriveTables]:
        """History, summary and tables of rank 0 on every rank, as files hold them; collective."""
        if self.comm.rank == 0:
            tables = replace(
                tables,
                pairs=as_columns(self.record.pairs),
                contact_lines=as_columns(self.record.contact_lines),
                program=as_columns(self.program_rows()),
                transmission_error=as_columns(self.record.turns),
                balls=as_columns(self.record.balls),
                bolts=as_columns(self.record.bolts),
            )
            stored = StoredSummary.model_validate_json(summary_to_json(summary))
            summary = summary_from(stored, rows, tables.pairs)
        return self.comm.bcast((rows, summary, tables) if self.comm.rank == 0 else None)

    def program_rows(self) -> list[PointRow]:
        """Rows of program.csv."""
        return point_rows(self.sequence, self.record.rows)

    @abstractmethod
    def begin(self) -> None:
        """Keep what does not change: the undeformed mesh, if the design asks for fields."""

    @abstractmethod
    def _keep(self, fields: NodalFields, elapsed: float) -> None:
        """Keep the last of `rows`, and the fields if the design asks for them."""

    @abstractmethod
    def finish(self, rows: list[Row], summary: DriveSummary, tables: DriveTables) -> DriveData:
        """The result. rows : all of history.csv;  summary, tables : evaluated at the end"""


class MemoryRecorder(Recorder):
    """Keeps everything in memory: each rank the fields of the sectors that it owns."""

    _parts: FieldParts | None = None

    def begin(self) -> None:
        if self.model.design.output.fields:
            self._parts = FieldParts(self.comm, _body_parts(self.model))

    def _keep(self, fields: NodalFields, elapsed: float) -> None:
        if self._parts is not None:
            self._parts.keep(len(self.record.rows), self._in_frame(fields))

    def finish(self, rows: list[Row], summary: DriveSummary, tables: DriveTables) -> DriveData:
        return DriveData(*self._shared(rows, summary, tables), self._parts, self.comm)


class FolderRecorder(Recorder):
    """Keeps everything on disk, complete after every increment.

    out : results folder;  computed : what the run computes, for restarts
    """

    def __init__(self, stepper: LoadStepper, out: Path, computed: RunContent) -> None:
        super().__init__(stepper)
        self.out, self.computed = out, computed
        self._writer = FieldWriter(out, self.comm) if self.model.design.output.fields else None

    def resume(self) -> tuple[tuple[LoadState, ...], float]:
        """Bring back the state of the checkpoint; returns the states of the run, and its seconds
        so far."""
        saved, states = resume_run(self.out, self.computed, self.stepper, self.cycle)
        self.record = saved.record
        self._write_tables()
        return states, saved.wall_s

    def keep_choice(self, chosen: ChosenMesh, accuracy: float) -> None:
        super().keep_choice(chosen, accuracy)
        write_from_root(
            self.comm, self.out / RECIPE, to_toml(self.model.recipe.model_dump()).encode()
        )

    def begin(self) -> None:
        write_from_root(self.comm, self.out / history.DESCRIPTION, history.format_description())
        if self._writer is not None:
            self._writer.write_mesh(_body_parts(self.model))

    def _keep(self, fields: NodalFields, elapsed: float) -> None:
        """Write fields, history, and then the checkpoint, which marks all as complete."""
        if self._writer is not None:
            self.record.components = {
                body: {name: a.shape[2] if a.ndim == 3 else 1 for name, a in values.items()}
                for body, values in fields.items()
            }
            self._writer.write_increment(len(self.record.rows), self._in_frame(fields))
        self._write_tables()
        displacement = {name: values["displacement"] for name, values in fields.items()}
        kept = self.record, self.cycle, displacement, elapsed
        save_run(self.out, self.computed, self.stepper, *kept)

    def keep_turns(self, rows: list[Row]) -> None:
        super().keep_turns(rows)
        if rows:
            write_from_root(self.comm, self.out / TURNS, format_csv(rows))

    def known_turns(self) -> list[Row]:
        path = self.out / TURNS
        present = on_root(self.comm, path.exists)
        with agreed(self.comm, path, "read"):
            columns = read_columns(path) if present else {}
        return [
            {**row, **{name: int(row[name]) for name in ("newton_iterations", "by_linear_model")}}
            for row in as_rows(columns)
        ]

    def _write_tables(self) -> None:
        """Write the index of the fields, the history and the other tables that grow with it."""
        record = self.record
        if self._writer is not None:
            # a restart may ask for fields where the run before did not
            numbered = enumerate(record.rows, start=1)
            written = [(i, row["wg_angle_deg"]) for i, row in numbered if self._writer.has(i)]
            self._writer.write_index(self.comm.bcast(written), record.components)
        shown = history_rows(self.sequence.kinematics, record.rows)
        write_from_root(self.comm, self.out / history.NAME, history.format_rows(shown))
        program = self.program_rows()
        tables = {
            "pairs": record.pairs,
            "contact_lines": record.contact_lines,  # none where all contacts lie on edges
            "program": program,
            "stiffness": loop_rows(program) if self.model.design.stiffness else [],
            "balls": record.balls,
            "bolts": record.bolts,
        }
        for name, rows in tables.items():
            if rows:
                write_from_root(self.comm, self.out / f"{name}.csv", format_csv(rows))

    def finish(self, rows: list[Row], summary: DriveSummary, tables: DriveTables) -> DriveData:
        if len(rows) > len(self.record.rows):
            write_from_root(self.comm, self.out / history.NAME, history.format_rows(rows))
        write_tables(self.out, self.comm, tables)
        names = [history.NAME, *table_files()]
        written = on_root(self.comm, lambda: table_facts(self.out, names))
        write_from_root(self.comm, self.out / SUMMARY, summary_to_json(summary, written))
        folder = self.out.absolute()  # the fields are read later
        fields = open_fields(folder, self.comm)
        return DriveData(*self._shared(rows, summary, tables), fields, self.comm, folder)


def _body_parts(model: DriveModel) -> dict[str, BodyPart]:
    """The undeformed bodies on this rank, by name."""
    parts = {}
    for name, body in model.elements.bodies.items():
        mesh, (first, _) = body.layout.mesh, model.partition.owned_sectors(name)
        points, cells = body.positions()[body.owned], mesh.hexes.astype(np.int64)
        parts[name] = BodyPart(points, cells, first, body.layout.count, _flank_grids(mesh))
    return parts


def _flank_grids(mesh: SectorMesh) -> FlankGrids | None:
    if not mesh.flanks:
        return None
    return FlankGrids(
        np.array([grid.nodes for grid in mesh.flanks]), mesh.flanks[0].s, mesh.flanks[0].z
    )
