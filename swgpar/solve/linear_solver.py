"""What solves with the matrices of Newton's iteration: the interface, and what all kinds share.

`swgpar.solve.linear_solvers` chooses the kind.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.log import logger
from swgpar.petsc import PETSc, accepted_options


class OptionDefaults:
    """PETSc options that the program sets unless the user has set them.

    PETSc keeps options for all solvers of a prefix and reads some of them late, so that one table
    serves a process: it distinguishes the program's own options from the user's.
    """

    def __init__(self) -> None:
        self._own: dict[str, set[str]] = {}

    def set(self, prefix: str, defaults: Mapping[str, object]) -> None:
        """Set options that the user has not set; remove those of other solvers of the prefix."""
        options, own = PETSc.Options(prefix), self._own.setdefault(prefix, set())
        for name in own - set(defaults):
            options.delValue(name)
            own.remove(name)
        for name, value in defaults.items():
            if name in own or not options.hasName(name):
                options[name] = value
                own.add(name)


option_defaults = OptionDefaults()
"""The table of this process."""


@dataclass(frozen=True)
class MatrixKind:
    """What the matrices of a linear solver have in common.

    comm : communicator
    positions : (n_own, 2 or 3) mm, of this rank's nodes; a matrix has as many unknowns per node
    symmetric : whether the matrices are; `DiscreteProblem.tangent` says what else they are
    thin : whether they are those of a whole drive, thin all around, and not of a part cut out of it
    """

    comm: MPI.Comm
    positions: np.ndarray
    symmetric: bool
    thin: bool = False

    @property
    def unknowns_per_node(self) -> int:
        """2 or 3."""
        return self.positions.shape[1]


def reason_names(reasons: type) -> dict[int, str]:
    """Names of the reasons for which a solver of PETSc ends, of its class `ConvergedReason`."""
    return {value: name for name, value in vars(reasons).items() if isinstance(value, int)}


REASONS = reason_names(PETSc.KSP.ConvergedReason)


class LinearSolver(ABC):
    """Solves with one matrix after the other, by PETSc's `KSP` with the options of a prefix.

    All methods are collective. After a failure answers are of no use, `failure` says why.

    kind : of the matrices;  options_prefix : of PETSc's options

    Attributes:
    is_factor : whether what is made of a matrix solves exactly, with many right sides at once, and
    may serve later matrices as a preconditioner
    matrix : that of the last `prepare`, None before it
    failure : why the last `prepare` or `solve` failed; empty where it has not
    """

    is_factor = False
    ksp_type = "gmres"
    """PETSc's type of the Krylov method, where the options name no other."""

    def __init__(self, kind: MatrixKind, options_prefix: str) -> None:
        self.kind, self.options_prefix = kind, options_prefix
        self.matrix: PETSc.Mat | None = None
        self.failure = ""
        self._converted: PETSc.Mat | None = None
        self._into: PETSc.Vec | None = None
        self._out: PETSc.Vec | None = None
        self.ksp = self._create_ksp()

    # -- of each kind ------------------------------------------------------------------------------

    @classmethod
    def takes(cls, pc_type: str, package: str) -> bool:
        """Whether this kind, of the registry, handles the preconditioner and the package of a
        factor that options name; what no kind takes is left to `Factor` and `KrylovSolver`."""
        return False

    @abstractmethod
    def set_preconditioner(self, pc: PETSc.PC) -> None:
        """Choose the preconditioner for options that name none."""

    @abstractmethod
    def defaults(self, ksp_type: str) -> dict[str, object]:
        """PETSc options for a Krylov method, by their names without the prefix."""

    def reads(self, storage: str) -> bool:
        """Whether the preconditioner reads PETSc's type `storage`; others are converted to AIJ."""
        return storage.endswith("aij") and not storage.endswith("baij")

    def price(self, matrix: PETSc.Mat) -> float:
        """Solves as long as the next `prepare` with this matrix; 0: nothing is to be reused."""
        return 0.0

    # -- of all kinds ------------------------------------------------------------------------------

    def _create_ksp(self) -> PETSc.KSP:
        ksp = PETSc.KSP().create(comm=self.kind.comm)
        ksp.setOptionsPrefix(self.options_prefix)
        ksp.setType(self.ksp_type)
        self.set_preconditioner(ksp.getPC())
        self._set_defaults()
        with accepted_options(self.kind.comm):
            ksp.setFromOptions()
        return ksp

    def _set_defaults(self) -> None:
        ksp_type = PETSc.Options(self.options_prefix).getString("ksp_type", self.ksp_type)
        option_defaults.set(self.options_prefix, self.defaults(ksp_type))

    @property
    def name(self) -> str:
        """Krylov method and preconditioner, by PETSc's names."""
        return f"{self.ksp.getType()} with {self.ksp.getPC().getType()}"

    def destroy(self) -> None:
        """Release PETSc's objects."""
        for owned in (self.ksp, self._converted, self._into, self._out):
            if owned is not None:
                owned.destroy()

    def renew(self) -> None:
        """Forget the last matrix: the next one may have other rows."""
        self.destroy()
        self.matrix = self._converted = self._into = self._out = None
        self.ksp = self._create_ksp()

    def prepare(self, matrix: PETSc.Mat, active: np.ndarray, *, keep: bool = False) -> None:
        """Make the factor, or set up the preconditioner.

        active : (n,) own nodes that the matrix has rows of
        keep : the Mat is filled with other values later, and what is made of it now is kept
        """
        if self.failure:
            self.renew()  # MUMPS does not try again by itself, and then solves without a factor
        if self._into is None:
            self._into, self._out = matrix.createVecs()
        self.matrix = None
        self._set_defaults()  # another model may have set its own since
        pc = self.ksp.getPC()
        self.ksp.setOperators(self.operator(matrix, self.kind.positions[active]))
        pc.setReusePreconditioner(False)
        with accepted_options(self.kind.comm, all_errors=True):
            self.set_up()
        pc.setReusePreconditioner(keep)
        self._note_failure()
        self.matrix = matrix

    def set_up(self) -> None:
        """Make the factor, or set up the preconditioner, of the operator that `ksp` has."""
        self.ksp.setUp()

    def operator(self, matrix: PETSc.Mat, positions: np.ndarray) -> PETSc.Mat:
        """The matrix as the preconditioner reads it. positions : (n, 2 or 3) mm, of its nodes"""
        if self.reads(matrix.getType()):
            return matrix
        if self._converted is not None:
            self._converted.destroy()
        self._converted = matrix.convert("aij", out=PETSc.Mat())
        return self._converted

    def _note_failure(self) -> None:
        reason = self.ksp.getConvergedReason()
        self.failure = (
            "" if reason >= 0 else f"linear solver ({self.name}): {REASONS.get(reason, reason)}"
        )

    def solve(self, right: np.ndarray, guess: np.ndarray | None = None) -> np.ndarray:
        """Solution (n,) for a right side (n,), of this rank's rows. guess : (n,); None: zero"""
        self._into.array[:] = right
        iterates = guess is not None and self.ksp.getType() != PETSc.KSP.Type.PREONLY
        if iterates:
            self._out.array[:] = guess
        self.ksp.setInitialGuessNonzero(iterates)
        with accepted_options(self.kind.comm, all_errors=True):
            self.ksp.solve(self._into, self._out)
        self._note_failure()
        if self.failure:
            logger.info("   %s after %d iterations", self.failure, self.ksp.getIterationNumber())
        return self._out.array_r.copy()

    def solve_many(self, rights: np.ndarray, guesses: np.ndarray) -> np.ndarray:
        """Solutions for right sides and from guesses, (n, m); zero from the first failure on."""
        solutions = np.zeros_like(rights)
        for k in range(rights.shape[1]):
            solution = self.solve(rights[:, k], guesses[:, k])
            if self.failure:
                break
            solutions[:, k] = solution
        return solutions
