"""State of one Newton solve: its phase, counters, and the states that it can go back to."""

from __future__ import annotations

import enum
from dataclasses import dataclass, field

import numpy as np

from swgpar.contact.active_cells import ActiveCells
from swgpar.load.load_states import LoadState
from swgpar.petsc import PETSc
from swgpar.solve.active_set_cycles import VisitedSets

SOFT_PENALTIES = (1e-3, 3e-2, 0.3)
"""Shares of the contacts' stiffness in the first rough runs, while contact is established."""

SPREADING_PENALTIES = SOFT_PENALTIES[1:]
"""The same where contact is there but spreads slowly: over stiff contacts by one face in an
iteration, over soft ones by many."""


class Phase(enum.Enum):
    """What one run of Newton's iteration is for."""

    SOFTENED = enum.auto()
    FULL = enum.auto()
    FROZEN = enum.auto()
    AUGMENTED = enum.auto()


class IterationStatus(enum.Enum):
    """How one run of Newton's iteration ended."""

    CONVERGED = enum.auto()
    INTERRUPTED = enum.auto()
    SLOW = enum.auto()
    FAILED = enum.auto()


@dataclass(frozen=True)
class SolveResult:
    """Result of a solve: Newton iterations, last residual over the contact force, reason."""

    converged: bool
    iterations: int
    residual: float
    reason: str


@dataclass(frozen=True)
class NewtonSettings:
    """Settings of the solver.

    rtol : residual over contact force at convergence
    max_iterations : before a solve fails, unless the residual still decreases
    max_augmentations : in one solve;  penetration_tolerance : mm
    linear : name of the linear solver;  reuse_factor : for later tangents, if it is direct
    """

    rtol: float
    max_iterations: int
    max_augmentations: int
    penetration_tolerance: float
    linear: str = "direct"
    reuse_factor: bool = False


@dataclass
class CycleBreaker:
    """State of the cycle breaker in one solve; see `swgpar.solve.active_set_cycles`.

    active : cells and friction bounds are frozen, and the line search is descending
    started : it is or was active; afterwards the iteration starts close to the solution
    rounds : problems with given friction bounds that were solved
    solution : found with frozen cells, until the iteration with cells placed anew converges
    """

    active: bool = False
    started: bool = False
    rounds: int = 0
    solution: tuple[PETSc.Vec, list[ActiveCells | None]] | None = None


@dataclass
class AcceptableState:
    """State before an augmentation that may fail. multipliers : of all penalty contacts, MPa"""

    residual: float
    x: PETSc.Vec
    multipliers: list[np.ndarray]


@dataclass
class SolveState:
    """State of one solve.

    load_state : what is solved for
    softenings : shares of the penalty of the runs that follow before the full penalty
    penalty_share : of the present run
    max_iterations : of the whole solve
    iterations, searches, repeated_searches, augmentations : so far
    residuals : over the contact force, of the present run
    pattern_misses : keys of contact blocks on this rank that the tangent's pattern lacks
    incomplete_pattern : whether any rank misses blocks
    outdated_search : whether the nodes have moved far since the last contact search
    slow : whether contact spreads slowly;  softened : whether contacts are or were softened
    renewed : whether cells were placed anew since the last augmentation
    visited : active sets of the present run;  ending : why the run ends now
    """

    load_state: LoadState
    softenings: list[float]
    max_iterations: int
    penalty_share: float = 1.0
    iterations: int = 0
    searches: int = 0
    repeated_searches: int = 0
    augmentations: int = 0
    residuals: list[float] = field(default_factory=list)
    pattern_misses: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    incomplete_pattern: bool = False
    outdated_search: bool = False
    slow: bool = False
    softened: bool = False
    renewed: bool = False
    visited: VisitedSets = field(default_factory=VisitedSets)
    breaker: CycleBreaker = field(default_factory=CycleBreaker)
    before_augmentation: AcceptableState | None = None
    result: SolveResult | None = None
    ending: str = ""

    @property
    def cells_may_be_stale(self) -> bool:
        """Whether the frozen cells are those of the state before an augmentation. Those that slide
        past the end of a flank lose their forces, so that there may be no solution."""
        augmented = self.phase is Phase.AUGMENTED
        return augmented and not self.renewed and not self.breaker.started

    @property
    def phase(self) -> Phase:
        """Phase of the present run, from its penalty, the cycle breaker and the augmentations."""
        if self.penalty_share != 1.0:
            return Phase.SOFTENED
        if self.breaker.active:
            return Phase.FROZEN
        return Phase.AUGMENTED if self.augmentations else Phase.FULL

    @property
    def residual(self) -> float:
        """Last residual over the contact force."""
        return self.residuals[-1] if self.residuals else np.inf

    def words(self, nodes: int, iteration: int) -> str:
        """What is being solved, for a run that is silent for long. nodes : of the model"""
        here = self.load_state
        return (
            f"{here.stage.label} {np.degrees(here.angle):.2f} degrees, {nodes} nodes, "
            f"Newton iteration {iteration}, residual {self.residual:.1e}"
        )

    def ending_text(self) -> str:
        """The sentence for a run that ends here."""
        here = self.load_state
        return (
            f"{self.ending} in step {here.step} ({here.stage.label}) at a wave-generator angle of "
            f"{np.degrees(here.angle):.4g} degrees, after {self.iterations} Newton iterations, "
            f"residual {self.residual:.1e} of the contact force"
        )
