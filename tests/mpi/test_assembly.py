"""The assembled tangent against differences of the residual, with all contacts on; on any number of ranks."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from support.stiffness import without_grounding
from swgpar.analysis.drive_model import DriveModel
from swgpar.design.design_file import load_design
from swgpar.design.load_states import LoadState
from swgpar.fem.vectors import create_vector
from swgpar.meshing import load_recipe

CONDENSED = (*PLANE, "solver.condensed_sectors=true")


@pytest.mark.parametrize(
    "overrides",
    [
        (),
        ("solver.twofold_symmetry=false",),
        ("drive.layout=spline_fixed",),
        PLANE,
        (*PLANE, "solver.twofold_symmetry=false"),
        (*PLANE, "drive.layout=spline_fixed"),
        ("contact.friction=0.2",),
        CONDENSED,
        (*CONDENSED, "drive.layout=spline_fixed"),
        (*PLANE, "contact.friction=0.2"),
        (*CONDENSED, "contact.friction=0.2"),
    ],
)
@pytest.mark.parallel([1, 2, 3])
def test_tangent_is_the_derivative_of_the_residual(overrides: tuple[str, ...], monkeypatch) -> None:
    monkeypatch.setattr("swgpar.design.fit_checks.OMITTED_BENDING", 1.0)  # 40 teeth: of no account here
    design = load_design(DESIGN, overrides)
    model = DriveModel(design, load_recipe(RECIPE), MPI.COMM_WORLD)
    equilibrium, partition, dims = model.equilibrium, model.partition, model.partition.dims
    # undeformed, the cam overlaps at the major axis; shrunk teeth overlap slightly at the minor axis
    equilibrium.scene = LoadState(4, "rotate", angle=0.01, cam=-0.001, teeth=-0.02, control="torque", torque=2000.0)
    rng = np.random.default_rng(3)
    own = slice(partition.row_start, partition.row_start + partition.n_own)
    # with friction: points of the flanks have come from here, most of them slip
    before = 1e-2 * rng.standard_normal((partition.n_global, 3))
    before[:, dims:] = 0.0
    equilibrium.accepted.array[:] = before[own].ravel()
    equilibrium.search()
    # the overlaps here are far beyond any real pressure: the bound of the geometric terms must not act
    equilibrium.rigid.pressure_limit = equilibrium.teeth.pressure_limit = np.inf
    every = 1e-5 * rng.standard_normal((partition.n_global, 3))
    way = rng.standard_normal((partition.n_global, 3))
    for vectors in (way, every):
        vectors[partition.multiplier_nodes] = vectors[:, dims:] = 0.0
    x, d = equilibrium.x, create_vector(partition)
    x.array[:], d.array[:] = every[own].ravel(), way[own].ravel()
    equilibrium._function(None, x, create_vector(partition))
    equilibrium.teeth.hold()  # the tangent does not know how the segments' edges move
    equilibrium._jacobian(None, x, None, equilibrium.matrix)
    assert not equilibrium.stale
    product = without_grounding(equilibrium, d)
    step, sides = 1e-8, []
    for sign in (1.0, -1.0):
        trial, force = x.copy(), create_vector(partition)
        trial.axpy(sign * step, d)
        equilibrium._function(None, trial, force)
        sides.append(force)
    sides[0].axpy(-1.0, sides[1])
    sides[0].scale(0.5 / step)
    difference = sides[0].copy()
    difference.axpy(-1.0, product)
    if partition.comm.rank == partition.comm.size - 1:
        difference.array[-partition.n_multipliers :] = 0.0  # the couplings' rows are in the border, not in the matrix
    assert equilibrium.penetration() > 0.0
    if design.contact.friction:
        law = equilibrium.teeth.friction
        slipping = 0 if law is None else np.count_nonzero(np.linalg.norm(law.now, axis=2))
        assert partition.comm.allreduce(slipping) > 0
    print(f"relative difference {difference.norm() / sides[0].norm():.1e}")
    # left out of the tangent: the second derivative of the coupling's rotation, and that flanks turn with a ring gear
    # that is the output, their height over the chord (0.01 of the radius here) times the slope of normals to it
    tolerance = 1e-6 if design.drive.layout == "ring_fixed" else 1e-5
    assert difference.norm() < tolerance * sides[0].norm()
