"""The rating sheet of a drive."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from mpi4py import MPI

from swgpar.analysis.accuracy import require_accuracy
from swgpar.api.runs import DesignLike, MeshLike, with_mesh
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.input.design import Design
from swgpar.input.toml_file import Overrides, apply_overrides, read_toml, require_source
from swgpar.rating.planned_runs import make_rated_drive
from swgpar.results.atomic import on_all
from swgpar.run_options import RunOptions
from swgpar.systems import system_of_table

if TYPE_CHECKING:
    from swgpar.rating.sheet import RatingSheet


def load_rated_design(design: DesignLike, overrides: Overrides = ()) -> DriveDesign:
    """Read and check a design with [rating], as `load_design` does. Sections that one run cannot
    have together may stand beside each other.

    Raises
    ------
    InputError
        Also for a gear train, and where [rating] or a torque is missing.
    """
    if isinstance(design, Design):
        table = design.model_dump(exclude_unset=True)
    else:
        require_source("design", design)
        table = dict(design) if isinstance(design, Mapping) else read_toml(design)
    if system_of_table(table).noun != "a drive":
        raise InputError("rate is available for drives: a gear train has no rating")
    return make_rated_drive(apply_overrides(table, overrides))


def rate(
    design: DesignLike,
    out: str | Path,
    *,
    mesh: MeshLike | None = None,
    accuracy: float | None = None,
    restart: bool = False,
    overwrite: bool = False,
    progress: bool | None = None,
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> RatingSheet:
    """Rate a drive: all answers beside requirements and limits; collective.

    The runs that are needed follow each other, each on all ranks. Loads of one torque share a run.

    Parameters
    ----------
    design : design, path or mapping
        Of a drive, with the section [rating].
    out : path
        Folder: rating.json, rating.csv, rating.html, and the results of the runs in runs/. The
        sheet is written after every run.
    mesh : recipe, name, path or mapping
        As `load_mesh` takes it.
    accuracy : float
        Relative, of the largest tensile stress at the teeth (0.001 to 0.2): meshes of the runs
        whose stresses the sheet has are refined for it, as `run` does. In load programs and in runs
        without windows the mesh is that of the recipe.
    restart : bool
        Keep what is finished in `out`, continue what was interrupted, try again what failed.
    overwrite : bool
        Replace a rating that `out` already holds.
    progress : bool
        Report every run on the terminal. Default: only on a terminal.

    Returns
    -------
    RatingSheet
        The same on every rank. A run that fails leaves its rows without a verdict.

    Raises
    ------
    InputError
        A design without [rating] or without a torque, a gear train, an accuracy out of range.
    OutputError
        The folder cannot be written, or holds another rating.

    Examples
    --------
    >>> sheet = swgpar.rate("drive.toml", "results/rating")
    >>> sheet.headline, {one.name: one.judgement for one in sheet.verdicts}
    """
    from swgpar.rating.rate_drive import rate_drive  # what runs is imported where it is used

    given = RunOptions.given(
        out, progress, accuracy=accuracy, restart=restart, overwrite=overwrite, comm=comm
    )

    def checked() -> tuple[DriveDesign, RunOptions]:
        if accuracy is not None:
            require_accuracy(accuracy)
        return load_rated_design(design), with_mesh(given, mesh)

    return rate_drive(*on_all(comm, checked))
