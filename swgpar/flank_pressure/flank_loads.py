"""Forces of the ring gear on the flanks of the flexible spline: as line loads, and on the flanks of
another mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from swgpar.contact.flanks import FlankContact
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.vectors import read_field, sum_at_owners
from swgpar.load.load_states import LoadState
from swgpar.meshing.sector import FlankGrid, SectorMesh
from swgpar.model.drive_model import DriveModel
from swgpar.petsc import PETSc

POINTS = 4
"""Gauss points along z on each piece between the stations of both meshes."""


@dataclass(frozen=True)
class LineLoad:
    """Line load of a flank along the face width.

    z : (n,) mm, ascending;  load : (n, 3) N/mm on the flexible spline, linear between;  s : (n,)
    mm, arc length of its middle on the tooth profile
    """

    z: np.ndarray
    load: np.ndarray
    s: np.ndarray

    @property
    def direction(self) -> np.ndarray:
        """Unit vector (3,) of the sum of the loads of all stations."""
        total = self.load.sum(axis=0)
        return total / np.linalg.norm(total)

    def projected(self) -> LineLoad:
        """The line load with the same nodal forces: what the elements see, without a share of the
        stations beside a short contact. It may be negative there."""
        force = self.load * tributary(self.z)[:, None]
        return replace(self, load=np.linalg.solve(overlaps(self.z), force))


def tributary(z: np.ndarray) -> np.ndarray:
    """Lengths (n_z,) mm of the stations: half of the distances to those beside them."""
    steps = np.diff(z)
    return 0.5 * (np.r_[0.0, steps] + np.r_[steps, 0.0])


def overlaps(z: np.ndarray) -> np.ndarray:
    """M (n_z, n_z) mm, integrals of the products of the hat functions."""
    out, step = np.zeros((len(z), len(z))), np.diff(z)
    for k, length in enumerate(step):
        out[k : k + 2, k : k + 2] += length / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
    return out


def nodal_flank_forces(
    model: DriveModel, state: LoadState, flanks: FlankContact, *, friction: bool = True
) -> PETSc.Vec:
    """Nodal contact forces (N) of the flanks by their last evaluation; collective. Each pair counts
    on one rank.

    friction : with it, or those of the pressures alone
    """
    problem = model.problem
    local = np.zeros((len(problem.local_nodes), 3))
    flanks.add_owned_forces(problem.displacement(), state, local, friction=friction)
    return sum_at_owners(model.partition, problem.local_nodes.number, -local)


def flank_forces(
    model: DriveModel,
    state: LoadState,
    teeth: np.ndarray,
    flanks: FlankContact,
    gear: str = FLEXIBLE_SPLINE,
) -> np.ndarray:
    """Contact forces (n, n_node, 3) N of `flanks` on the nodes of the `teeth` (n,) of a gear;
    collective."""
    vector = nodal_flank_forces(model, state, flanks)
    forces = forces_on_teeth(model, teeth, vector, gear)
    vector.destroy()
    return forces


def forces_on_teeth(
    model: DriveModel, teeth: np.ndarray, vector: PETSc.Vec, gear: str = FLEXIBLE_SPLINE
) -> np.ndarray:
    """Nodal forces (n, n_node, 3) N of the `teeth` (n,) of a gear out of those of all nodes;
    collective."""
    layout = model.partition.layouts[gear]
    forces = read_field(model.partition, gear, teeth - layout.first_tooth, vector)
    # in the plane both layers have the force of the lower one
    return 0.5 * forces if layout.mesh.plane else forces


def line_loads(mesh: SectorMesh, forces: np.ndarray) -> dict[tuple[int, int], LineLoad]:
    """Line loads of the flanks of teeth by (index of the tooth, side) from nodal forces (n, n_node,
    3) N.

    Flanks without load have none.
    """
    found = {}
    for k in range(len(forces)):
        for grid in mesh.flanks:
            load = line_load(grid, forces[k])
            if load is not None:
                found[k, grid.side] = load
    return found


def line_load(grid: FlankGrid, forces: np.ndarray) -> LineLoad | None:
    """The line load with the resultant and the place of nodal forces (n_node, 3) N on a flank; None
    without forces."""
    rows = forces[grid.nodes]
    total = rows.sum(axis=0)
    size = np.linalg.norm(total, axis=1)
    if not size.max() > 0.0:
        return None
    direction = total.sum(axis=0)
    direction /= np.linalg.norm(direction)
    along = rows @ direction
    share = np.clip(along.sum(axis=0), 1e-12 * size.max(), None)
    middle = (along * grid.s[:, None]).sum(axis=0) / share
    loaded = size > 1e-6 * size.max()
    s = np.interp(grid.z, grid.z[loaded], np.clip(middle[loaded], grid.s[0], grid.s[-1]))
    return LineLoad(grid.z, total / tributary(grid.z)[:, None], s)


def nodal_forces(load: LineLoad, grid: FlankGrid, half_width: float) -> np.ndarray:
    """Nodal forces (n_s + 1, n_z + 1, 3) N of a line load on another flank grid of the same tooth.

    Along the profile the load is a parabola over `half_width` (mm) on either side of its middle.
    """

    def share(z: float) -> np.ndarray:
        return parabola(grid.s, float(np.interp(z, load.z, load.s)), half_width)

    return _spread(load, grid, share)


def spread_forces(load: LineLoad, grid: FlankGrid, share: np.ndarray) -> np.ndarray:
    """Nodal forces (n_s + 1, n_z + 1, 3) N of a line load on another flank grid of the same tooth.
    share : (n_s + 1,) of the nodes along the profile"""
    return _spread(load, grid, lambda _: share)


def _spread(load: LineLoad, grid: FlankGrid, shares: Callable[[float], np.ndarray]) -> np.ndarray:
    """Nodal forces (n_s + 1, n_z + 1, 3) N. shares : of the nodes along the profile, by z (mm)"""
    out = np.zeros((len(grid.s), len(grid.z), 3))
    point, weight = np.polynomial.legendre.leggauss(POINTS)
    for j in range(len(grid.z) - 1):
        # pieces between the stations of both
        inside = load.z[(load.z > grid.z[j]) & (load.z < grid.z[j + 1])]
        ends = np.r_[grid.z[j], inside, grid.z[j + 1]]
        for low, high in zip(ends[:-1], ends[1:]):
            z = 0.5 * (low + high) + 0.5 * (high - low) * point
            t = (z - grid.z[j]) / (grid.z[j + 1] - grid.z[j])
            for k, value in enumerate(z):
                force = np.array([np.interp(value, load.z, load.load[:, c]) for c in range(3)])
                force = force * weight[k] * 0.5 * (high - low)
                share = shares(float(value))
                out[:, j] += (1.0 - t[k]) * share[:, None] * force
                out[:, j + 1] += t[k] * share[:, None] * force
    return out


def parabola(s: np.ndarray, middle: float, half_width: float) -> np.ndarray:
    """Shares (n,) of the nodes at `s` (n,) mm in a load of 1 whose density is 1 - ((s - middle) /
    half_width)^2."""
    middle = float(np.clip(middle, s[0], s[-1]))
    x = np.linspace(-1.0, 1.0, 41)
    return nodal_shares(s, middle + half_width * x, 1.0 - x**2)


def nodal_shares(s: np.ndarray, place: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Shares (n,) of the nodes at `s` (n,) mm in point forces (m,) at places (m,) mm on linear
    elements. Forces beyond the ends act at them."""
    place = np.clip(place, s[0], s[-1])
    k = np.clip(np.searchsorted(s, place) - 1, 0, len(s) - 2)
    t = (place - s[k]) / (s[k + 1] - s[k])
    share = np.bincount(k, force * (1.0 - t), minlength=len(s)) + np.bincount(
        k + 1, force * t, minlength=len(s)
    )
    return share / share.sum()
