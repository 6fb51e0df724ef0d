"""Natural frequencies are the same on any number of ranks."""

from __future__ import annotations

import pytest
from mpi4py import MPI

import swgpar
from support.paths import DESIGN, RECIPE

pytest.importorskip("slepc4py")

ASKED = (
    "frequencies.number=3",
    "frequencies.output_inertia=1e-3",
    "material.density=7850.0",
    "steps.rotation=0",
    "output.figures=false",
)


@pytest.mark.parallel([2, 3])
def test_ranks_agree() -> None:
    design = swgpar.load_design(DESIGN, ASKED)
    together, alone = (
        swgpar.run(design, RECIPE, comm=comm).summary.frequencies.modes
        for comm in (MPI.COMM_WORLD, MPI.COMM_SELF)
    )
    for mode, other in zip(together, alone, strict=True):
        assert mode.frequency == pytest.approx(other.frequency, rel=1e-8)
        assert mode.energy == pytest.approx(other.energy, rel=1e-5, abs=1e-9)
        assert mode.waves == other.waves
