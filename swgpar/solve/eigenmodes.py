"""Natural modes of the linearised problem, by SLEPc.

With the tangent K, the constraints C x = 0 of the couplings and the mass M, modes are K x + C^T l =
omega^2 M x. The inverse of the bordered K is what Newton's method uses; SLEPc's Krylov-Schur method
with the shift 0 asks for nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np

from swgpar.errors import ConvergenceError, InputError
from swgpar.petsc import PETSc
from swgpar.solve.factor_reuse import Operation, PythonContext

TOLERANCE = 1e-8
"""Relative error of an eigenvalue at which the iteration ends."""


@dataclass(frozen=True)
class Eigenmodes:
    """frequency : (n,) rad per unit of time, rising;  shape : of unit modal mass"""

    frequency: np.ndarray
    shape: list[PETSc.Vec]


def require_slepc() -> None:
    """Raise InputError where slepc4py cannot be imported."""
    if find_spec("slepc4py") is None:
        raise InputError(
            "[frequencies] needs slepc4py, which is not installed: pip install "
            "swgpar[frequencies], or python3-slepc4py-real of Debian"
        )


def lowest_modes(
    template: PETSc.Vec, stiffness: Operation, inverse: Operation, mass: Operation, number: int
) -> Eigenmodes:
    """The modes with the lowest frequencies; collective.

    template : a vector of unknowns;  stiffness, inverse : symmetric, of the bordered tangent
    mass : symmetric, semi-definite

    Raises ConvergenceError where too few modes are found, or one that grows in place of
    oscillating.
    """
    from slepc4py import SLEPc

    comm, sizes = template.comm, template.getSizes()
    matrices = []
    for function in (stiffness, mass):
        matrix = PETSc.Mat().createPython((sizes, sizes), PythonContext(function), comm=comm)
        matrix.setUp()
        matrices.append(matrix)
    eps = SLEPc.EPS().create(comm)
    eps.setOperators(*matrices)
    eps.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    eps.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
    eps.setTarget(0.0)
    eps.setDimensions(number)
    eps.setTolerances(TOLERANCE)
    transform = eps.getST()
    transform.setType("sinvert")
    transform.setMatMode(SLEPc.ST.MatMode.SHELL)
    ksp = transform.getKSP()
    ksp.setType("preonly")
    ksp.getPC().setType("python")
    ksp.getPC().setPythonContext(PythonContext(inverse))
    eps.solve()
    found = min(number, eps.getConverged())
    squares = np.array([eps.getEigenvalue(k).real for k in range(found)])
    shapes = [template.duplicate() for _ in range(found)]
    for k, shape in enumerate(shapes):
        eps.getEigenvector(k, shape)
    for owned in (eps, *matrices):
        owned.destroy()
    if found < number:
        raise ConvergenceError(f"{found} of {number} natural frequencies were found")
    if squares.min() <= 0.0:
        raise ConvergenceError("the state is not stable: a mode grows in place of oscillating")
    order = np.argsort(squares)
    return Eigenmodes(np.sqrt(squares[order]), [shapes[k] for k in order])
