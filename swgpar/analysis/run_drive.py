"""One design from file to results: what `swgpar run` does."""

from __future__ import annotations

import hashlib
import platform
import resource
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from swgpar import log
from swgpar.analysis.coarse_start import Level, levels, start_loaded
from swgpar.analysis.contact_pressure import nodal_pressure
from swgpar.analysis.drive_model import DriveModel, build_drive_model
from swgpar.analysis.error_estimate import estimate
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.mesh_refinement import choose, with_accuracy
from swgpar.analysis.period import continued, of_period, sampling_error
from swgpar.contact import friction
from swgpar.design.drive_design import DriveDesign
from swgpar.design.load_states import LoadState, from_loaded, load_sequence
from swgpar.errors import ConvergenceError, InputError, SwgparError
from swgpar.fem.body_layout import FLEXIBLE_SPLINE
from swgpar.fem.vectors import write_field
from swgpar.log import IncrementProgress, logger
from swgpar.meshing import MeshRecipe, load_recipe, require_sections
from swgpar.meshing.recipe import to_toml
from swgpar.results import checkpoint, history
from swgpar.results.atomic import agreed, on_all, to_json, write_from_root
from swgpar.results.fields import FieldWriter
from swgpar.results.folder import RECIPE, prepare
from swgpar.results.parallel_hdf5 import require_parallel
from swgpar.version import __version__

FIRST_ROTATION = 4
"""Step number of the first rotation increment: means are taken from there on."""

MEANS = ("fs_s1", "fs_s3", "fs_vm", "rg_s1", "rg_s3", "rg_vm", "wg_torque_Nmm")
"""Columns of the history whose means over the rotation are taken."""


@dataclass(frozen=True)
class Accuracy:
    """Of the largest tensile stress under load, relative: asked for, estimated, and whether that suffices.

    mesh_error : estimated errors of all largest stresses, MPa
    """

    asked: float
    estimated: float
    reached: bool
    mesh_error: dict[str, float]


@dataclass(frozen=True)
class RunSummary:
    """rows : history;  means : over the rotation (MPa), fs and rg s1, s3, vm;  summary : content of summary.json"""

    rows: list[dict[str, Any]]
    means: dict[str, float]
    summary: dict[str, Any]


def identity(design: DriveDesign, recipe: MeshRecipe, accuracy: float | None) -> str:
    """What is computed, for restarts: all but the output, the rotation and how systems are solved."""
    how = {"linear", "keep_factor", "far_teeth"}
    content = design.model_dump(exclude={"output": True, "steps": {"rotation"}, "solver": how})
    content = {"design": content, "recipe": recipe.model_dump(), "accuracy": accuracy}
    return hashlib.sha256(to_json(content)).hexdigest()


class Recorder:
    """Keeps a run's results on disk, complete after every increment."""

    def __init__(self, out: Path, model: DriveModel, identity: str) -> None:
        self.out, self.model, self.comm = out, model, model.comm
        self.identity = identity
        self.rows: list[dict[str, Any]] = []
        self.done = 0
        self.names: dict[str, dict[str, int]] = {}
        self.coarser: Level | None = None
        self.accuracy: Accuracy | None = None
        self.writer = FieldWriter(out, self.comm) if model.design.output.fields else None

    def mesh(self) -> None:
        """Write the undeformed mesh and the flanks' grids."""
        if self.writer is None:
            return
        bodies, extra = {}, {}
        for k, body in enumerate(self.model.elements.bodies):
            first, _ = self.model.partition.owned_sectors(k)
            mesh = body.layout.mesh
            bodies[mesh.body] = (body.positions()[body.owned], mesh.hexes.astype(np.int64), first, body.layout.count)
            extra[f"{mesh.body}/flank_nodes"] = np.array([g.nodes for g in mesh.flanks])
            extra[f"{mesh.body}/flank_s"], extra[f"{mesh.body}/flank_z"] = mesh.flanks[0].s, mesh.flanks[0].z
        self.writer.write_mesh(bodies, extra)

    def record(self, runner: LoadStepper, seconds: float, elapsed: float) -> None:
        """Store the state after an increment: fields, then history, then the checkpoint that vouches for them.

        seconds : wall time of the increment;  elapsed : of the whole run, restarts included
        """
        model, problem = self.model, self.model.problem
        with model.phases("stress"):
            values, fields = model.stresses()
        row = {**runner.row(), **values, "wall_s": seconds}
        self.rows.append(history.plain_row(row))
        self.done += 1
        with model.phases("output"):
            ranges = [
                (body.layout.name, *model.partition.owned_sectors(k), body.layout.count)
                for k, body in enumerate(model.elements.bodies)
            ]
            if self.writer is not None:
                fields[0]["pressure"] = nodal_pressure(
                    problem, runner.load_state, model.elements.bodies[FLEXIBLE_SPLINE]
                )
                self.names = {
                    name: {f: a.shape[2] if a.ndim == 3 else 1 for f, a in field.items()}
                    for (name, *_), field in zip(ranges, fields)
                }
                self.writer.write_increment(
                    self.done, {name: (field, first, total) for (name, first, _, total), field in zip(ranges, fields)}
                )
                self._index()
            write_from_root(self.comm, self.out / history.NAME, history.format_rows(self.rows))
            blocks = {
                name: (np.ascontiguousarray(field["displacement"]), first, total)
                for (name, first, _, total), field in zip(ranges, fields)
            }
            if model.design.contact.friction:
                first, end = model.partition.owned_sectors(FLEXIBLE_SPLINE)
                for name, values in problem.flanks.traction_rows(first, end).items():
                    blocks[name] = values, first, model.partition.layouts[0].count
            state = {
                "identity": self.identity,
                "done": self.done,
                "rows": self.rows,
                "names": self.names,
                "load_state": runner.load_state.to_dict(),
                "multipliers": problem.multipliers().tolist(),
                "wall_s": elapsed,
                "phases_s": model.phases.slowest(self.comm),
                "coarser": self.coarser and asdict(self.coarser),
                "accuracy": self.accuracy and asdict(self.accuracy),
            }
            checkpoint.write_checkpoint(self.out, self.comm, blocks, state)

    def _index(self) -> None:
        # a run that was started without fields has none of its first increments
        there = [(i + 1, row["wg_angle_deg"]) for i, row in enumerate(self.rows) if self.writer.has(i + 1)]
        self.writer.write_index(self.comm.bcast(there), self.names)

    def resume(self, runner: LoadStepper, items: list[LoadState]) -> tuple[list[LoadState], float]:
        """Bring back the state of the checkpoint, on any number of ranks.

        items : the sequence that is to be continued. Returns those of it that the run consists of, without the first
        steps where other meshes did them, and the wall seconds spent on it.
        """
        model = self.model
        ranges = {
            body.layout.name: (model.partition.owned_sectors(k)[0], int(np.diff(model.partition.owned_sectors(k))[0]))
            for k, body in enumerate(model.elements.bodies)
        }
        path = self.out / checkpoint.NAME
        _, state = checkpoint.read_checkpoint(path, self.comm)
        if state.get("identity") != self.identity:
            raise InputError(
                f"--restart: {path} belongs to another design, recipe, --accuracy or solver setting; allowed are the "
                "same ones, only steps.rotation, the output, solver.linear, keep_factor and far_teeth may differ"
            )
        last = LoadState.from_dict(state["load_state"])
        if state["coarser"] or state["accuracy"]:
            items = from_loaded(items)
        if state["done"] > len(items) or items[state["done"] - 1] != last:
            raise InputError(
                f"--restart: steps.rotation = {self.model.design.steps.rotation:g} does not continue {path}, which "
                f"ends at {np.degrees(last.angle):g} degrees; allowed are values with this angle among their increments"
            )
        arrays, _ = checkpoint.read_checkpoint(path, self.comm, ranges)
        x = model.problem.x
        for k, body in enumerate(model.elements.bodies):
            first, end = model.partition.owned_sectors(k)
            write_field(model.partition, k, np.arange(first, end), arrays[body.layout.name], x)
        if self.comm.rank == self.comm.size - 1:
            x.array[-model.partition.n_multipliers :] = state["multipliers"]
        if model.design.contact.friction:
            # a rank needs the flanks that its ring teeth face too
            every = (0, model.partition.layouts[0].count)
            rows, _ = checkpoint.read_checkpoint(path, self.comm, dict.fromkeys(friction.ROWS, every))
            model.problem.resume(friction.from_rows(rows))
        self.rows, self.done, self.names = state["rows"], state["done"], state["names"]
        self.coarser = state["coarser"] and Level(**state["coarser"])
        self.accuracy = state["accuracy"] and Accuracy(**state["accuracy"])
        runner.resume_at(last)
        for name, value in state["phases_s"].items():
            model.phases.seconds[name] += value
        if self.writer is not None:
            self._index()
        write_from_root(self.comm, self.out / history.NAME, history.format_rows(self.rows))
        return items, float(state["wall_s"])


def mesh_error(rows: list[dict[str, Any]], elements: int, coarser: Level, dimensions: int) -> dict[str, float]:
    """Estimated errors of the loaded state's largest stresses by the mesh, MPa: from this mesh and the next coarser."""
    found = {
        name: estimate(value, rows[0][name], coarser.elements, elements, dimensions)
        for name, value in coarser.stresses.items()
    }
    return {name: value.error for name, value in found.items() if value is not None}


def summarise(
    model: DriveModel,
    rows: list[dict[str, Any]],
    coarser: Level | None,
    recipe_name: str,
    accuracy: Accuracy | None,
    seconds: float,
) -> dict[str, Any]:
    """Content of summary.json.

    rows : of the increments that were computed;  coarser : level that the run started from
    accuracy : what was asked for and reached
    """
    comm, design = model.comm, model.design
    turning = [r for r in rows if int(r["step"]) >= FIRST_ROTATION]
    sampled = of_period(design, rows) if design.steps.samples else turning
    means = {k: float(np.mean([r[k] for r in sampled])) for k in MEANS} if sampled else {}
    counts = model.counts()
    memory = comm.allgather(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
    elements = model.n_elements()
    by_mesh = mesh_error(rows, elements, coarser, model.partition.dims) if coarser else None
    expected = 1000.0 * design.load.torque / abs(design.ratio)
    return {
        "recipe": recipe_name,
        "bodies": counts,
        "nodes": sum(b["nodes_whole"] for b in counts.values()),
        "elements": elements,
        "dofs": sum(b["dofs"] for b in counts.values()),
        "twofold_symmetry": model.copies == 2,
        "increments": len(rows),
        "ranks": comm.size,
        "versions": {
            "swgpar": __version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
        },
        "wall_s": seconds,
        "phases_s": {k: round(v, 3) for k, v in model.phases.slowest(comm).items()},
        "peak_memory_MB_per_rank": [round(m, 1) for m in memory],
        "means": means,
        "accuracy": accuracy and {key: value for key, value in asdict(accuracy).items() if key != "mesh_error"},
        "mesh_error": accuracy.mesh_error if accuracy else by_mesh,
        "condensed_MPa": model.omitted_bending_stress() if design.solver.condensed_sectors else None,
        "sampling_error": sampling_error(design, rows, MEANS) if design.steps.samples and means else None,
        "newton_iterations_mean": float(np.mean([r["newton_iterations"] for r in turning])) if turning else None,
        "balance_error_Nmm": max((r["torque_balance_Nmm"] for r in rows), default=0.0),
        "wg_torque_expected_Nmm": expected,
        "ratio": design.ratio,
        "design": design.model_dump(),
    }


def run_drive(
    design: DriveDesign,
    recipe: MeshRecipe,
    out_dir: str | Path,
    *,
    restart: bool = False,
    overwrite: bool = False,
    comm: MPI.Comm = MPI.COMM_WORLD,
    recipe_name: str = "",
    accuracy: float | None = None,
    on_increment: Callable[[], None] | None = None,
) -> RunSummary:
    """Run a design and write its results to `out_dir`; collective.

    accuracy : estimated relative error of the largest tensile stress up to which `recipe` is refined (`choose`)
    on_increment : called after every increment, instead of a report on the terminal

    Raises InputError, OutputError or ConvergenceError on all ranks. After a ConvergenceError everything up to the
    last converged increment is on disk and can be continued with `restart`.
    """
    out, begin = Path(out_dir), time.perf_counter()
    require_parallel(comm)
    require_sections(design, recipe)
    if accuracy is not None:
        design = with_accuracy(design, accuracy)
    resumed = prepare(out, comm, restart, overwrite)
    log.start(comm, terminal=on_increment is None)
    with agreed(comm, out / "run.log"):
        log.to_file(out / "run.log", comm)
    chosen = None
    if accuracy is not None and not resumed:
        chosen = choose(design, recipe, list(load_sequence(design)), accuracy, comm)
        recipe = chosen.recipe
    elif accuracy is not None:
        recipe = on_all(comm, lambda: load_recipe(out / RECIPE))
    model = build_drive_model(design, recipe, comm=comm) if chosen is None else chosen.model
    recorder = Recorder(out, model, identity(design, recipe, accuracy))
    try:
        if chosen is not None:
            write_from_root(comm, out / RECIPE, to_toml(recipe).encode())
            recorder.accuracy = Accuracy(accuracy, chosen.error, chosen.error <= accuracy, chosen.stresses)
        result = _compute(model, recipe, recorder, resumed, restart, begin, recipe_name, on_increment)
    except SwgparError as error:
        model.destroy()  # collective: not after an error that perhaps this rank alone has met
        if isinstance(error, ConvergenceError) and recorder.done:
            raise ConvergenceError(f"{error}; {recorder.done} increments are saved in {out}") from None
        raise
    model.destroy()
    return result


def _start_on_coarser(runner: LoadStepper, recipe: MeshRecipe, items: list[LoadState]) -> Level | None:
    """Reach the loaded state by way of coarser meshes; None where the design does without, or where that fails."""
    recipes = levels(runner.design, recipe)
    if not recipes:
        return None
    try:
        return start_loaded(runner, recipes, items)
    except (ConvergenceError, InputError) as error:
        logger.info("no start on coarser meshes: %s", error)
        runner.reset()
        return None


def _compute(
    model: DriveModel,
    recipe: MeshRecipe,
    recorder: Recorder,
    resumed: bool,
    restart: bool,
    begin: float,
    recipe_name: str,
    on_increment: Callable[[], None] | None,
) -> RunSummary:
    comm, out, runner = model.comm, recorder.out, LoadStepper(model)
    counts = model.counts()
    logger.info(
        "%d elements, %d nodes in the whole drive; %d unknowns modelled%s; %d ranks",
        model.n_elements(),
        sum(b["nodes_whole"] for b in counts.values()),
        sum(b["dofs"] for b in counts.values()),
        " (half of it, by symmetry)" if model.copies == 2 else "",
        comm.size,
    )
    recorder.mesh()
    items, before = list(load_sequence(model.design)), 0.0
    if resumed:
        items, before = recorder.resume(runner, items)
        logger.info("restarted after increment %d", recorder.done)
    elif restart:
        logger.info("no increment was saved: starting from the beginning")
    if recorder.accuracy is not None and not resumed:  # the model has been loaded on the way to its mesh
        runner.resume_at(from_loaded(items)[0])
    elif not resumed:
        recorder.coarser = _start_on_coarser(runner, recipe, items)
    if not resumed and (recorder.coarser or recorder.accuracy):
        items = from_loaded(items)
    with IncrementProgress(comm, len(items), done=recorder.done, terminal=on_increment is None) as progress:
        model.solver.monitor = lambda state, its, ratio: progress.newton(
            state.stage.label, np.degrees(state.angle), its, ratio
        )
        for item in items[recorder.done :]:
            start = time.perf_counter()
            if item != runner.load_state:  # a start on coarser meshes ends with the first one
                runner.advance(item)
            seconds = time.perf_counter() - start
            recorder.record(runner, seconds, before + time.perf_counter() - begin)
            progress.increment(
                item.stage.label, float(np.degrees(item.angle)), runner.iterations, runner.residual, seconds
            )
            if on_increment is not None:
                on_increment()
    rows, seconds = recorder.rows, before + time.perf_counter() - begin
    summary = summarise(model, rows, recorder.coarser, recipe_name, recorder.accuracy, seconds)
    if model.design.steps.samples and summary["means"]:
        rows = continued(model.design, rows)
        write_from_root(comm, out / history.NAME, history.format_rows(rows))
    write_from_root(comm, out / "summary.json", to_json(summary))
    return RunSummary(rows, summary["means"], summary)
