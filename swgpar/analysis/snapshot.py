"""A converged state to which the load stepping can go back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from swgpar.analysis.predictor import KnownState
from swgpar.contact.friction import CellTractions, PairKey
from swgpar.load.load_states import LoadState
from swgpar.petsc import PETSc

ProgramState = tuple[LoadState, PETSc.Vec] | None
"""A state of a load program that predictions start from."""


@dataclass(frozen=True)
class Snapshot:
    """A converged state, with what friction and predictions know of the path to it.

    x, accepted : of the discrete problem;  tractions : of every ring gear's flanks, MPa
    known_states, last, before : of the stepper
    """

    load_state: LoadState
    residual: float
    x: PETSc.Vec
    accepted: PETSc.Vec
    tractions: tuple[Mapping[PairKey, CellTractions], ...]
    known_states: tuple[KnownState, ...]
    last: ProgramState
    before: ProgramState
