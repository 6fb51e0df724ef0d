"""Factors: of MUMPS, and of any other package that PETSc offers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.errors import OutOfMemoryError
from swgpar.log import logger
from swgpar.petsc import PETSc
from swgpar.solve.linear_solver import LinearSolver, MatrixKind

FACTORISATIONS = ("lu", "cholesky")
"""PETSc's preconditioners that are factors."""

USUAL_PRICE = 10.0
"""Solves as long as a factorisation, where the package does not count: 4 to 15 with MUMPS."""

MINIMUM_DEGREE, NESTED_DISSECTION = 6, 4
"""Orderings of the unknowns for MUMPS (its ICNTL(7)): in the plane and on coarse meshes of drives,
and of other solids. On a fine mesh of the reference drive a factorisation takes a fifth less time
with nested dissection (PORD) and a solve a quarter; its analysis takes longer."""

FEW_UNKNOWNS = 300_000
"""Of a drive on a coarse mesh, with few layers across the rim, those included that are out of reach
of contacts. In matrices of 66,000, 111,000 and 143,000 a factorisation by minimum degree takes 0 to
7 % longer, a solve 0 to 8 %, and the analysis half as long."""

MORE_MEMORY, OUT_OF_ESTIMATE = (120, 240, 480), (-8, -9)
"""Per cent above MUMPS' estimate that are tried after these errors of its INFOG(1)."""

NO_MEMORY = (-5, -7, -13)
"""Errors of MUMPS' INFOG(1) for allocations that failed."""

INTENSITY = 40.0
"""Operations on an entry of the factor, of a factorisation that takes as long as a solve with it:
22 to 54 on meshes of 60,000 to 920,000 unknowns (docs/verification/data/scaling.csv), the most on
large ones."""

ANALYSIS = 1.0
"""Factorisations that cost as much as the analysis of a pattern: 0.8 to 1.4 on full and forces."""


class Factor(LinearSolver):
    """A factor of any package: PETSc's own, SuperLU_DIST and others. LU unless options say."""

    is_factor = True
    ksp_type = "preonly"

    def set_preconditioner(self, pc: PETSc.PC) -> None:
        """LU."""
        pc.setType(PETSc.PC.Type.LU)

    def defaults(self, ksp_type: str) -> dict[str, object]:
        """None."""
        return {}

    def price(self, matrix: PETSc.Mat) -> float:
        """The usual price."""
        return 0.0 if self.matrix is None or self.failure else USUAL_PRICE

    def solve_many(self, rights: np.ndarray, guesses: np.ndarray) -> np.ndarray:
        """Solutions (n, m) for right sides (n, m) at once: reading the factor limits a solve."""
        solutions = np.zeros_like(rights)
        if self.failure or not rights.shape[1]:
            return solutions
        n, rows = self.matrix.getSizes()[0]
        into = PETSc.Mat().createDense([[n, rows], [None, rights.shape[1]]], comm=self.kind.comm)
        into.setUp()
        into.getDenseArray()[:] = rights
        into.assemble()
        out = into.duplicate()
        self.ksp.getPC().getFactorMatrix().matSolve(into, out)
        solutions[:] = out.getDenseArray()
        into.destroy()
        out.destroy()
        return solutions


@dataclass(frozen=True)
class FactorCounts:
    """What MUMPS counts: entries of the factor, operations, estimated memory of all ranks (GB)."""

    entries: float
    operations: float
    memory: float


class MumpsFactor(Factor):
    """A factor of MUMPS, Cholesky's of symmetric matrices; made again where memory ran out."""

    def __init__(self, kind: MatrixKind, options_prefix: str) -> None:
        self._memory_share = 60  # per cent above MUMPS' estimate
        super().__init__(kind, options_prefix)

    @classmethod
    def takes(cls, pc_type: str, package: str) -> bool:
        """Factors of MUMPS, or of no package that is named."""
        return pc_type in (*FACTORISATIONS, "") and package in ("mumps", "")

    def set_preconditioner(self, pc: PETSc.PC) -> None:
        """Cholesky's or LU."""
        usual = PETSc.PC.Type.CHOLESKY if self.kind.symmetric else PETSc.PC.Type.LU
        # another type forgets the package
        pc.setType(PETSc.Options(self.options_prefix).getString("pc_type", usual))
        pc.setFactorSolverType("mumps")

    def defaults(self, ksp_type: str) -> dict[str, object]:
        """Ordering and memory; collective."""
        kind = self.kind
        few = kind.comm.allreduce(kind.positions.size, op=MPI.SUM) < FEW_UNKNOWNS
        by_degree = kind.unknowns_per_node == 2 or (kind.thin and few)
        return {
            "mat_mumps_icntl_7": MINIMUM_DEGREE if by_degree else NESTED_DISSECTION,
            # no ScaLAPACK root: its Cholesky refuses the indefinite tangents of first steps
            "mat_mumps_icntl_13": 1,
            "mat_mumps_icntl_14": self._memory_share,
        }

    def reads(self, storage: str) -> bool:
        """Blocked storage too: triangular for Cholesky's factor, of all blocks for LU."""
        blocked = "sbaij" if self.ksp.getPC().getType() == PETSc.PC.Type.CHOLESKY else "baij"
        return storage.replace("seq", "").replace("mpi", "") in (blocked, "aij")

    def set_up(self) -> None:
        """Factorise; with more memory where the estimate was too low (users' guide, section 8).

        Raises OutOfMemoryError.
        """
        self.ksp.setUp()
        pc, options = self.ksp.getPC(), PETSc.Options(self.options_prefix)
        operator, _ = self.ksp.getOperators()
        for more in MORE_MEMORY:
            if pc.getFactorMatrix().getMumpsInfog(1) not in OUT_OF_ESTIMATE:
                break
            logger.info("   MUMPS needs more memory than it had estimated: %d %% above it", more)
            options["mat_mumps_icntl_14"] = self._memory_share = more
            pc.reset()
            self.ksp.setOperators(operator)
            self.ksp.setUp()
        factor = pc.getFactorMatrix()
        error, detail = (factor.getMumpsInfog(k) for k in (1, 2))
        if error in NO_MEMORY:
            memory = self.counts().memory
            needed = f"about {memory:.3g} GB" if memory > 0 else "more"
            raise OutOfMemoryError(
                f"not enough memory: the factor of {operator.getSize()[0]:,} unknowns needs "
                f"{needed} on all ranks: "
                'take a coarser mesh, more memory, or solver.linear = "iterative"'
            )
        if error < 0:
            logger.warning("   MUMPS cannot factorise: INFOG(1) = %d, INFOG(2) = %d", error, detail)

    def counts(self) -> FactorCounts:
        """Counts of the last factor."""
        factor = self.ksp.getPC().getFactorMatrix()
        entries = factor.getMumpsInfog(29)  # in millions where it is negative
        return FactorCounts(
            entries=entries if entries >= 0 else -1e6 * entries,
            operations=factor.getMumpsRinfog(3),
            memory=1e-3 * factor.getMumpsInfog(17),
        )

    def price(self, matrix: PETSc.Mat) -> float:
        """From counts, not from measured seconds, so that runs repeat the same decisions."""
        counts = None if self.matrix is None else self.counts()
        if counts is None or not counts.entries:
            return 0.0
        analysis = 0.0 if matrix is self.matrix else ANALYSIS
        return counts.operations / (INTENSITY * counts.entries) * (1.0 + analysis)
