"""The Python API on several ranks: results are the same on all of them, and those of one."""

from __future__ import annotations

import gc
import logging
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from mpi4py import MPI

import swgpar
from support.paths import DESIGN, DRIVERS, RECIPE
from support.small_drive import NO_SHORTCUTS, PLANE
from swgpar.model.drive_model import DriveModel
from swgpar.presentation.figures import DriveFigures

SMALL = [*PLANE, *NO_SHORTCUTS, "steps.rotation=2.0", "steps.increment=2.0", "output.fields=true"]


def numbers(result: swgpar.DriveResult) -> list[np.ndarray]:
    """History without times and iterations, means, mesh and fields."""
    columns = [
        v
        for k, v in result.history.items()
        if k not in ("wall_s", "newton_iterations", "torque_balance_Nmm")
    ]
    fields = [result.field(name) for name in ("displacement", "vm", "pressure")]
    means = np.array(list(result.summary.rotation.means.values()))
    return [
        *columns,
        means,
        *result.mesh("flexible_spline"),
        *fields,
        result.field("s1", 0, "ring_gear"),
    ]


@pytest.mark.parallel([1, 2])
def test_a_run_leaves_no_model_behind() -> None:
    """Models and their parts refer to one another: each run in a loop kept 150 MB."""
    threshold = gc.get_threshold()
    gc.collect()
    before = sum(isinstance(one, DriveModel) for one in gc.get_objects())
    gc.set_threshold(0)  # Python does not look by itself
    try:
        swgpar.run(swgpar.load_design(DESIGN, SMALL), RECIPE)
        left = sum(isinstance(one, DriveModel) for one in gc.get_objects())
    finally:
        gc.set_threshold(*threshold)
    assert left == before


@pytest.mark.parallel([1, 2])
def test_every_rank_has_the_result_of_one() -> None:
    comm = MPI.COMM_WORLD
    design = swgpar.load_design(DESIGN, SMALL)
    together = swgpar.run(design, RECIPE)
    alone = swgpar.run(design, RECIPE, comm=MPI.COMM_SELF)
    assert together.increments == alone.increments == 4
    found, expected = numbers(together), numbers(alone)
    for mine, first in zip(found, comm.bcast(found), strict=True):
        np.testing.assert_array_equal(mine, first)
    for value, reference in zip(found, expected, strict=True):
        np.testing.assert_allclose(value, reference, rtol=1e-5, atol=1e-6 * np.abs(reference).max())
    summaries = comm.allgather(together.summary)
    assert (
        all(summary == summaries[0] for summary in summaries)
        and together.summary.ranks == comm.size
    )


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """One folder for all ranks."""
    return MPI.COMM_WORLD.bcast(tmp_path)


@pytest.mark.parallel([1, 2])
def test_figures_of_fields_in_memory_are_saved_by_all_ranks(folder: Path) -> None:
    comm = MPI.COMM_WORLD
    result = swgpar.run(swgpar.load_design(DESIGN, SMALL), RECIPE)
    files = result.plot.save(folder)
    assert files == [folder / "figures" / f"{name}.png" for name in result.plot.names]
    assert {"pairs", "contact_pattern", "deformed_drive", "loaded_teeth", "stress_around"} < set(
        result.plot.names
    )
    assert all(path.stat().st_size > 0 for path in files)
    comm.Barrier()
    if comm.rank == 0:
        (folder / "file").write_text("no folder")
    comm.Barrier()
    with pytest.raises(swgpar.OutputError, match="cannot write .*file"):
        result.plot.save(folder / "file")


@pytest.mark.parallel([2])
def test_a_figure_that_fails_on_one_rank(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result = swgpar.run(swgpar.load_design(DESIGN, SMALL), RECIPE)
    draw = DriveFigures.deformed

    def deformed(self: DriveFigures) -> Figure:
        figure = draw(self)
        if MPI.COMM_WORLD.rank == 1:
            raise RuntimeError("no display")
        return figure

    monkeypatch.setattr(DriveFigures, "deformed", deformed)
    with pytest.raises(swgpar.OutputError, match="no display"):
        result.plot.save(folder)


@pytest.mark.parallel([1, 2])
def test_a_run_in_a_folder_is_the_same_on_all_ranks(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At its end no rank reads history and summary back: those of rank 0 are the result."""
    comm = MPI.COMM_WORLD
    with monkeypatch.context() as patch:
        for name in ("results.folder.read_summary", "results.history.read_history"):
            patch.setattr(f"swgpar.{name}", None)
        result = swgpar.run(
            swgpar.load_design(DESIGN, [*SMALL, "output.figures=false"]), RECIPE, folder / "run"
        )
    opened = swgpar.open_result(folder / "run")
    for mine, other in zip(numbers(result), numbers(opened), strict=True):
        np.testing.assert_array_equal(mine, other)
    assert result.summary == opened.summary and result.folder == opened.folder
    comm.Barrier()
    if comm.rank == 0:
        (folder / "run" / "fields.h5").write_bytes(b"no HDF5")
    comm.Barrier()
    with pytest.raises(swgpar.OutputError, match="cannot read .*fields.h5"):
        swgpar.open_result(folder / "run")


@pytest.mark.parallel([1, 2])
def test_a_mesh_that_cannot_be_written_is_refused_on_all_ranks(folder: Path) -> None:
    comm = MPI.COMM_WORLD
    if comm.rank == 0:
        (folder / "file").write_text("no folder")
    comm.Barrier()
    with pytest.raises(swgpar.OutputError):
        swgpar.mesh(DESIGN, RECIPE, folder / "file")
    swgpar.mesh(DESIGN, RECIPE, folder / "mesh")
    assert [path.name for path in (folder / "mesh").iterdir()] == ["drive_40_42.vtu"]


@pytest.mark.parallel([2])
def test_the_logger_is_restored_on_all_ranks() -> None:
    logger = logging.getLogger("swgpar")
    before = logger.level, logger.propagate, list(logger.handlers)
    swgpar.run(DRIVERS / "ring_supported.toml")
    assert (logger.level, logger.propagate, logger.handlers) == before
