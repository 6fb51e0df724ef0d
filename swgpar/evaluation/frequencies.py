"""Natural frequencies of the drive in its loaded state.

The wave generator and the fixed member do not move, contacts stay as they are, and friction, the
rotation of bodies and damping are left out (docs/theory/frequencies.md).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.answers.answer import (
    NO_ESTIMATE,
    Answer,
    AnswerGroup,
    AnswerKind,
    evaluation,
    part_answers,
)
from swgpar.design.drive_design import DriveDesign
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.masses import sector_masses
from swgpar.fem.vectors import create_vector, sum_at_owners
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel
from swgpar.petsc import PETSc
from swgpar.solve.discrete_problem import DiscreteProblem
from swgpar.solve.eigenmodes import Eigenmodes, lowest_modes
from swgpar.solve.newton import NewtonSolver

TONNES_MM2 = 1e3
"""One kg·m² in t·mm²."""

MOST_WAVES = 12
"""Largest number of waves around the flexible spline that is looked for."""


@dataclass(frozen=True)
class NaturalMode:
    """frequency : Hz

    energy : shares of the kinetic energy, by body; "output" is what rotates with it
    waves : around the flexible spline, of the largest part of its displacement
    """

    frequency: float
    energy: dict[str, float]
    waves: int

    @property
    def text(self) -> str:
        """Where the mode moves: shares of the kinetic energy above one per cent."""
        shares = sorted(self.energy.items(), key=lambda item: -item[1])
        moving = [f"{name.replace('_', ' ')} {share:.0%}" for name, share in shares if share > 0.01]
        text = f"kinetic energy: {', '.join(moving)}"
        if self.energy[FLEXIBLE_SPLINE] < 0.5:
            return text
        return f"{text}; {self.waves or 'no'} wave{'' if self.waves == 1 else 's'} around"


FREQUENCY = AnswerKind("frequency.NUMBER", "natural frequency NUMBER of the loaded drive", "Hz")
LOWEST = FREQUENCY.of("NUMBER", "1")


@evaluation
class NaturalFrequencies(AnswerGroup):
    """Modes of the loaded state, from the lowest on."""

    modes: list[NaturalMode] = part_answers(FREQUENCY)

    TITLE = "natural frequencies under load"
    ASKED_BY = "[frequencies]"
    SECTION = "frequencies"
    IN_PROGRAMS = False

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        return cls._numbered(0 if design.frequencies is None else design.frequencies.number)

    @classmethod
    def _numbered(cls, number: int) -> tuple[AnswerKind, ...]:
        return cls.kinds_with("NUMBER", map(str, range(1, number + 1)))

    def answers(self) -> Iterator[Answer]:
        for kind, mode in zip(self._numbered(len(self.modes)), self.modes, strict=True):
            yield kind.answer(mode.frequency, no_error=NO_ESTIMATE, remark=mode.text)


class LumpedMass:
    """Masses (t) at the nodes, and the inertia of what rotates with the output.

    bodies : nodal masses (vectors of unknowns) by body
    gradient : of the output's rotation by the unknowns, rad/mm;  inertia : t mm²
    """

    def __init__(
        self, problem: DiscreteProblem, gradient: PETSc.Vec | None = None, inertia: float = 0.0
    ) -> None:
        partition = problem.partition
        self.gradient, self.inertia = gradient, inertia
        self.bodies: dict[str, PETSc.Vec] = {}
        self.total = create_vector(partition)
        for name, body in problem.elements.bodies.items():
            masses = np.zeros(len(problem.elements.local))
            local = body.local[body.owned]
            of_sector = np.broadcast_to(sector_masses(body.layout.body), local.shape)
            np.add.at(masses, local[local >= 0], of_sector[local >= 0])
            values = np.repeat(masses[:, None], 3, axis=1)
            vector = sum_at_owners(partition, problem.elements.local.number, values)
            self.bodies[name] = vector
            self.total.axpy(1.0, vector)

    def apply(self, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """y = M x."""
        y.pointwiseMult(self.total, x)
        if self.gradient is not None:
            y.axpy(self.inertia * self.gradient.dot(x), self.gradient)

    def shares(self, shape: PETSc.Vec) -> dict[str, float]:
        """Shares of the kinetic energy of a mode, by body."""
        work = shape.duplicate()
        energy = {}
        for name, masses in self.bodies.items():
            work.pointwiseMult(masses, shape)
            energy[name] = float(work.dot(shape))
        if self.gradient is not None:
            energy["output"] = self.inertia * float(self.gradient.dot(shape)) ** 2
        work.destroy()
        return {name: value / sum(energy.values()) for name, value in energy.items()}

    def destroy(self) -> None:
        """Release the vectors."""
        for vector in (self.total, *self.bodies.values()):
            vector.destroy()


def modes_of(solver: NewtonSolver, state: LoadState, number: int, mass: LumpedMass) -> Eigenmodes:
    """Lowest modes of a body or drive in its equilibrium x; collective."""
    system = solver.system
    solver.factorise_tangent(state)
    try:
        return lowest_modes(
            solver.problem.x, system.multiply, system.solve_with_factor, mass.apply, number
        )
    finally:
        system.discard_factor()


def natural_modes(model: DriveModel, state: LoadState) -> list[NaturalMode]:
    """Modes of the drive in its equilibrium under that load state; collective.

    Raises ConvergenceError where there are too few.
    """
    wanted, problem = model.design.frequencies, model.problem
    gradient = None
    if wanted.output_inertia and state.control == "torque":
        border, _ = problem.supports.border(problem.displacement(), state)
        gradient = border[-1]
        gradient.scale(1.0 / problem.scale)
    mass = LumpedMass(problem, gradient, TONNES_MM2 * wanted.output_inertia)
    modes = modes_of(model.solver, state, wanted.number, mass)
    found = [
        NaturalMode(float(frequency / (2.0 * np.pi)), mass.shares(shape), _waves(problem, shape))
        for frequency, shape in zip(modes.frequency, modes.shape, strict=True)
    ]
    for owned in (*modes.shape, mass):
        owned.destroy()
    return found


def _waves(problem: DiscreteProblem, shape: PETSc.Vec) -> int:
    """Waves around the flexible spline of the largest part of its displacement."""
    body = problem.elements.bodies[FLEXIBLE_SPLINE]
    x, u = problem.positions(), problem.displacement(shape)
    owned = body.local[body.owned]
    nodes = owned[owned >= 0]
    outwards = x[nodes, :2] / np.linalg.norm(x[nodes, :2], axis=1)[:, None]
    around = np.column_stack([-outwards[:, 1], outwards[:, 0]])
    moved = u[nodes]
    parts = [(moved[:, :2] * along).sum(axis=1) for along in (outwards, around)]
    waves = np.exp(1j * np.arange(MOST_WAVES + 1) * np.arctan2(*x[nodes, 1::-1].T)[:, None])
    here = np.array([*parts, moved[:, 2]]) @ waves
    total = problem.partition.comm.allreduce(here, op=MPI.SUM)
    return int((np.abs(total) ** 2).sum(axis=0).argmax())
