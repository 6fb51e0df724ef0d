"""A ring between two supports: any number of ranks gives what a single one does."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from plain_ring import PlainRingDesign, RingCounts, RingModel
from swgpar.geometry.cams.simplified import simplified
from swgpar.materials import Isotropic


@pytest.mark.parametrize("plane", [True, False])
@pytest.mark.parallel([2, 3])
def test_ranks_do_not_matter(plane: bool) -> None:
    design = PlainRingDesign(136.0, 4.5, 10.0, plane, Isotropic(E=206e3, nu=0.29))
    readings = []
    for comm in (MPI.COMM_WORLD, MPI.COMM_SELF):
        model = RingModel(
            design,
            RingCounts(40, 1, 2),
            simplified(design.inner_radius, 32.5),
            np.radians(20.0),
            comm,
        )
        model.spread(0.5)
        readings.append([model.dial(angle, 0.1) for angle in (0.0, 0.25 * np.pi, 0.5 * np.pi)])
        model.destroy()
    parallel_assert(readings[0] == pytest.approx(readings[1], abs=1e-8), str(readings))
