"""Stress of every point of a sector of the flexible spline over a turn of the wave generator, or a
load program.

After one pitch of the fixed gear the drive is in the same state with its teeth renumbered by one.
So tooth k at the angle phi + m pitch has the stress that tooth k - m has at phi. In a sampled
period every modelled tooth is at another phase: it holds the whole cycle of one sector
(docs/theory/fatigue.md). With bolts a period has several pitches, and as many teeth have cycles of
their own. In a load program every modelled sector has a history of its own, one
value at each point.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.evaluation.period import sample_of
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.body_layout import BodyLayout
from swgpar.fem.elements import BodyElements
from swgpar.fem.partition import split
from swgpar.fem.stress import rotated_tensor
from swgpar.geometry.rotation import rotation_between
from swgpar.largest_stress.places import pressed_nodes
from swgpar.load.load_sequence import LoadSequence
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel

PREFIX = "cycle/stress_"
"""Names of the rows in a checkpoint, with the number of the sample."""


class StressCycle:
    """Collects the stress at the nodes of all modelled sectors, in the frame of each sector.

    Parameters
    ----------
    model : the drive
    sequence : its load states, with a sampled period or a load program

    Attributes
    ----------
    nodes : (n,) nodes of a sector, in the plane those of the lower layer
    samples : by number of the sample, (n_owned, n, 6) MPa of the owned sectors, xx yy zz xy yz zx
    touched : (n,) bool, nodes that a contact pressed in an owned sector
    """

    def __init__(self, model: DriveModel, sequence: LoadSequence) -> None:
        self.model, self.sequence = model, sequence
        self.body = model.elements.bodies[FLEXIBLE_SPLINE]
        mesh = self.body.layout.mesh
        lower = mesh.lower_nodes
        self.nodes = np.arange(len(mesh.coords)) if lower is None else np.unique(lower)
        self.samples: dict[int, np.ndarray] = {}
        self.touched = np.zeros(len(self.nodes), dtype=bool)

    def keep(self, state: LoadState, fields: Mapping[str, np.ndarray]) -> None:
        """Keep the stress of a load state, if it is one of the repeated period; collective.

        fields : nodal fields of the flexible spline, of `DriveModel.stresses`
        """
        number = sample_of(self.sequence, state)
        if number is None:
            return
        self.samples[number] = sector_stress(self.body, fields)[:, self.nodes]
        self.touched |= pressed_nodes(self.model, state)[:, self.nodes].any(axis=0)

    @property
    def complete(self) -> bool:
        """Whether all samples of the period, or of the program, are there."""
        return len(self.samples) == (len(self.sequence.points) or self.sequence.samples)

    @property
    def angle(self) -> float:
        """Rotation of the wave generator (rad) after which the cycle of a sector repeats."""
        return self.sequence.kinematics.pitch_angle * self.body.layout.count

    def rows(self) -> dict[str, np.ndarray]:
        """The samples as rows of a checkpoint, by sector."""
        return {f"{PREFIX}{number:04d}": values for number, values in self.samples.items()}

    def state(self) -> dict[str, Any]:
        """What else a checkpoint needs; collective."""
        touched = self.model.comm.allreduce(self.touched.astype(int), op=MPI.SUM)
        return {"samples": sorted(self.samples), "touched": np.flatnonzero(touched).tolist()}

    @staticmethod
    def names(state: Mapping[str, Any]) -> list[str]:
        """Names of the rows in a checkpoint with this `state`."""
        return [f"{PREFIX}{number:04d}" for number in state["samples"]]

    def resume(self, state: Mapping[str, Any], rows: Mapping[str, np.ndarray]) -> None:
        """Take the samples of a checkpoint: `rows` by name, of the owned sectors."""
        self.samples = {number: rows[f"{PREFIX}{number:04d}"] for number in state["samples"]}
        self.touched[state["touched"]] = True

    def history(self) -> tuple[np.ndarray, np.ndarray]:
        """Stress over the cycle; collective.

        Returns what `history_by_renaming` does. With a load program it is the stress (n_points, n,
        6) of the owned sectors, at whose nodes `mine` (n,) repeats.
        """
        samples = [self.samples[number] for number in sorted(self.samples)]
        if self.sequence.points:
            mine = np.tile(np.arange(len(self.nodes)), len(samples[0]))
            return mine, np.stack([values.reshape(-1, 6) for values in samples])
        pitches = self.sequence.kinematics.pitches
        return history_by_renaming(self.model.comm, self.body.layout, self.nodes, samples, pitches)


def elements_of_rank(comm: MPI.Comm, layout: BodyLayout) -> np.ndarray:
    """Elements (m,) of a sector that belong to this rank where ranks share the work on one
    sector."""
    start = split(len(layout.mesh.elements), comm.size)
    return np.arange(start[comm.rank], start[comm.rank + 1])


def history_by_renaming(
    comm: MPI.Comm,
    layout: BodyLayout,
    nodes: np.ndarray,
    samples: Sequence[np.ndarray],
    pitches: int = 1,
) -> tuple[np.ndarray, np.ndarray]:
    """Stress over a cycle at the nodes of this rank's elements of one sector, or of so many sectors
    that are not alike, one after another; collective.

    Parameters
    ----------
    nodes : (n,) of a sector
    samples : of one period, in time, each (n_owned, n, 6) MPa of the owned sectors in their own
    frames
    pitches : in a period, which is the number of sectors that are not alike

    Returns
    -------
    mine : (n_mine,) indices in `nodes`, of the elements `elements_of_rank`, of one sector after
    another
    stress : (n_phases, n_mine, 6) MPa; the phases are evenly spaced in time, as many as sectors
    times samples over pitches
    """
    index = np.full(len(layout.mesh.coords), -1)
    index[nodes] = np.arange(len(nodes))
    mine = np.unique(index[layout.mesh.elements[elements_of_rank(comm, layout)]])
    wanted = comm.allgather(mine)
    period = [
        np.concatenate(comm.alltoall([np.ascontiguousarray(values[:, part]) for part in wanted]))
        for values in samples
    ]
    stress = np.stack(period, axis=1)  # sector, sample, node, component
    first, passed = np.arange(pitches), pitches * np.arange(layout.count // pitches)[:, None]
    in_time = np.swapaxes(stress[(first - passed) % layout.count], 1, 2)
    return np.tile(mine, pitches), in_time.reshape(-1, pitches * len(mine), 6)


def sector_stress(body: BodyElements, fields: Mapping[str, np.ndarray]) -> np.ndarray:
    """Nodal stress (n_owned, n_node, 6) MPa of the owned sectors, each in the frame that rotates
    with the sector.

    fields : nodal fields of the body, of `DriveModel.stresses`
    """
    before, layout = body.positions()[body.owned][..., :2], body.layout
    angle = layout.chain_angle(body.sectors[body.owned])
    angle = angle + rotation_between(before, before + fields["displacement"][..., :2])
    return rotated_tensor(fields["stress"], -angle[:, None])
