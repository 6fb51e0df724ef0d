"""The Python API on several ranks: results are the same on all of them, and those of one."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE


def numbers(result: swgpar.DriveResult) -> list[np.ndarray]:
    """History without times and iterations, means, mesh and fields."""
    columns = [v for k, v in result.history.items() if k not in ("wall_s", "newton_iterations", "torque_balance_Nmm")]
    fields = [result.field(name) for name in ("displacement", "vm", "pressure")]
    means = np.array(list(result.summary["means"].values()))
    return [*columns, means, *result.mesh("flexible_spline"), *fields, result.field("s1", 0, "ring_gear")]


@pytest.mark.parallel([1, 2])
def test_every_rank_has_the_result_of_one() -> None:
    comm = MPI.COMM_WORLD
    design = swgpar.load_design(DESIGN, [*PLANE, "steps.rotation=2.0", "steps.increment=2.0", "output.fields=true"])
    together = swgpar.run(design, RECIPE)
    alone = swgpar.run(design, RECIPE, comm=MPI.COMM_SELF)
    assert together.increments == alone.increments == 4
    found, expected = numbers(together), numbers(alone)
    for mine, first in zip(found, comm.bcast(found), strict=True):
        np.testing.assert_array_equal(mine, first)
    for value, reference in zip(found, expected, strict=True):
        np.testing.assert_allclose(value, reference, rtol=1e-5, atol=1e-6 * np.abs(reference).max())
    summaries = comm.allgather(together.summary)
    assert all(summary == summaries[0] for summary in summaries) and together.summary["ranks"] == comm.size
