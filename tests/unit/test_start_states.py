"""Loaded states on the meshes of a start survive a run that ends before its first checkpoint."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from mpi4py import MPI

from support.messages import Messages
from support.paths import DESIGN
from support.small_drive import PLANE
from swgpar import load_design
from swgpar.analysis.coarse_start import MeshedDrive
from swgpar.analysis.saved_state import StartStates
from swgpar.meshing import load_recipe
from swgpar.results import made_files
from swgpar.results.folder import START_STATES

TAKEN_OVER = "is taken over"


def test_a_loaded_state_is_taken_over(tmp_path: Path) -> None:
    # with a factor for every tangent the residual ends far below the tolerance: a further search
    # changes nothing
    values = [*PLANE, "steps.rotation=0", "steps.bent_start=true", "solver.keep_factor=false"]
    design = load_design(DESIGN, values)
    recipe, comm = load_recipe("plane_coarse"), MPI.COMM_SELF
    kept = StartStates(tmp_path)

    def solve() -> tuple[np.ndarray, str]:
        with Messages() as messages:
            model = MeshedDrive(design, comm).load(recipe, kept=kept)
        x = model.problem.x.array_r.copy()
        model.destroy()
        return x, "\n".join(messages.texts)

    made_files.begin(tmp_path)
    assert not kept.found(comm)
    first, words = solve()
    assert TAKEN_OVER not in words and kept.found(comm)
    again, words = solve()
    assert TAKEN_OVER in words and "Newton iterations 0" in words
    assert np.array_equal(first, again)
    # a damaged file costs the time of another solve
    (path,) = tmp_path.glob(START_STATES)
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    other, words = solve()
    assert TAKEN_OVER not in words and "computed again" in words
    assert np.array_equal(first, other)
    kept.remove(comm)
    assert not kept.found(comm)
    assert [path.name for path in tmp_path.iterdir()] == [made_files.LIST]
