"""A factor that serves later systems: GMRES on the present one, preconditioned by the old factor.

One factorisation costs as much as some 4 solves with it in the plane, 5 (coarse) to 15 (full) in
the cup drive, the analysis of another pattern once or twice that, and from one Newton iteration to
the next, or one increment to the next, the tangent changes by rotations and some contact points.
"""

from __future__ import annotations

from collections.abc import Callable

from swgpar.petsc import PETSc, accepted_options

RTOL = 1e-2
"""Relative tolerance of GMRES. While contacts switch, a Newton step reduces the residual tenfold at
best; the last steps are solved as exactly as the end of Newton's iteration needs."""

GOAL_SHARE, LOOSEST = 0.2, 0.1
"""Share of the residual at which Newton's iteration ends that GMRES leaves, and of the present one
at most: more exactness is of no use to the last step."""

MAX_ITERATIONS = 40
"""Iterations of GMRES after which a factor is made at once."""

Operation = Callable[[PETSc.Vec, PETSc.Vec], None]
"""Computes its second argument from the first."""


class ReusedFactor:
    """Decides whether a factor is reused, and solves by GMRES with it.

    like : vector of the system;  multiply, solve : with the present system; with the factor

    `goal` is the residual's norm that ends Newton's iteration at the latest; `fresh` says that the
    factor is that of the present system, `discarded` that it is to be renewed before its next use;
    `iterations` are those of all solves.
    """

    def __init__(self, like: PETSc.Vec, multiply: Operation, solve: Operation) -> None:
        self.fresh, self.discarded = False, True
        self.layout: tuple[int, ...] = ()
        self.iterations: list[int] = []
        self.goal = 0.0
        self.fewest = MAX_ITERATIONS
        self.surplus = 0
        self.last = 0
        operator = PETSc.Mat().createPython(
            [like.getSizes()] * 2, PythonContext(multiply), comm=like.comm
        )
        operator.setUp()
        self.ksp = PETSc.KSP().create(comm=like.comm)
        self.ksp.setOptionsPrefix("reuse_")
        self.ksp.setOperators(operator)
        # it keeps the preconditioned vectors, which saves the last solve with the factor
        self.ksp.setType(PETSc.KSP.Type.FGMRES)
        self.ksp.setGMRESRestart(MAX_ITERATIONS)
        pc = self.ksp.getPC()
        pc.setType(PETSc.PC.Type.PYTHON)
        pc.setPythonContext(PythonContext(solve))
        with accepted_options(self.ksp.comm.tompi4py()):
            self.ksp.setFromOptions()

    def destroy(self) -> None:
        """Release GMRES, which refers to the system; collective."""
        self.ksp.destroy()

    def renew(self, layout: tuple[int, ...]) -> None:
        """The factor is that of the present system now. layout : what a later one must share"""
        self.fresh, self.discarded, self.layout = True, False, layout
        self.fewest, self.surplus, self.last = MAX_ITERATIONS, 0, 0

    def is_good_for(self, layout: tuple[int, ...], price: float) -> bool:
        """Whether the factor is to be reused for a new system.

        price : of a factor of that system, in iterations. It is due when the iterations beyond
        those of the old one's best solve have cost its price, which takes at most twice the time of
        the best choice, or when one solve has cost more than that.
        """
        self.fresh = False
        return (
            not self.discarded and self.layout == layout and max(self.surplus, self.last) <= price
        )

    def set_tolerance(self, right: PETSc.Vec) -> None:
        """Set the tolerance by Newton's residual, the right-hand side of the present system."""
        norm = right.norm()
        enough = min(GOAL_SHARE * self.goal / norm, LOOSEST) if norm > 0.0 else LOOSEST
        self.ksp.setTolerances(rtol=max(RTOL, enough), max_it=MAX_ITERATIONS)

    def solve(self, right: PETSc.Vec, x: PETSc.Vec) -> bool:
        """Solve the present system to the tolerance; returns whether GMRES converged."""
        self.ksp.solve(right, x)
        self.last = self.ksp.getIterationNumber()
        self.iterations.append(self.last)
        self.fewest = min(self.fewest, self.last)
        self.surplus += self.last - self.fewest
        return self.ksp.getConvergedReason() > 0


class PythonContext:
    """What a PETSc `Mat` or `PC` of type python computes."""

    def __init__(self, compute: Operation) -> None:
        self.compute = compute

    def mult(self, mat: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        self.compute(x, y)

    def apply(self, pc: PETSc.PC, x: PETSc.Vec, y: PETSc.Vec) -> None:
        self.compute(x, y)
