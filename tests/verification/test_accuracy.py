"""What the benchmark of accuracy rests on: plain elements, rates on coarse meshes, closed forms,
limits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from support.cam_ring import INNER, THICKNESS, closed_form, ring_on_cam
from support.convergence import limit, rates
from support.element_problems import ELEMENTS, PROBLEMS
from support.recipes import refined
from swgpar.fem.element_matrices import element_matrices
from swgpar.materials import Isotropic
from swgpar.meshing import load_recipe

SHAPES = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


def test_recipes_of_the_drives(tmp_path: Path) -> None:
    mesh = "plane"
    plane = load_recipe(mesh)
    every = load_recipe(refined(mesh, tmp_path / "every.toml", 1.5))
    assert every.flexible_spline.flank == -(-3 * plane.flexible_spline.flank // 2)
    root = load_recipe(refined(mesh, tmp_path / "root.toml", 2, ["flexible_spline.root"]))
    assert root.flexible_spline.root == 2 * plane.flexible_spline.root
    assert (
        root.flexible_spline.flank == plane.flexible_spline.flank
        and root.ring_gear == plane.ring_gear
    )


@pytest.mark.parametrize("aspect", [0.5, 1.0, 4.0])
@pytest.mark.parametrize("poisson", [0.0, 0.3])
def test_bending_of_a_rectangle(aspect: float, poisson: float) -> None:
    """Bent by u = x y, a bilinear rectangle is too stiff by (1 / (1 - nu) + (a / b)^2 / 2) / (1 +
    nu).

    That is Cook's closed form (Concepts and Applications of Finite Element Analysis), the parasitic
    shear; with the incompatible modes the energy is that of a beam, E I / 2 times the curvature
    squared and the length.
    """
    young, height = 210e3, 0.3
    length = aspect * height
    points = np.column_stack(
        [0.5 * length * SHAPES[:, 0], 0.5 * height * SHAPES[:, 1], np.zeros(4)]
    )
    bent = np.zeros((4, 3))
    bent[:, 0] = points[:, 0] * points[:, 1]  # the curvature is 1
    exact = 0.5 * young * height**3 / 12.0 * length
    for incompatible, ratio in (
        (True, 1.0),
        (False, (1.0 / (1.0 - poisson) + 0.5 * aspect**2) / (1.0 + poisson)),
    ):
        stiffness = element_matrices(
            points[None], Isotropic(E=young, nu=poisson), 1.0, incompatible
        ).stiffness[0]
        assert 0.5 * bent.ravel() @ stiffness @ bent.ravel() == pytest.approx(
            ratio * exact, rel=1e-12
        )
        if poisson == 0.0:
            box = np.vstack([points - [0.0, 0.0, 0.5], points + [0.0, 0.0, 0.5]])
            stiffness = element_matrices(
                box[None], Isotropic(E=young, nu=poisson), incompatible=incompatible
            ).stiffness[0]
            twice = np.vstack([bent, bent]).ravel()
            assert 0.5 * twice @ stiffness @ twice == pytest.approx(ratio * exact, rel=1e-12)


POSED = [
    (name, element)
    for name, problem in PROBLEMS.items()
    for element, (plane, _) in ELEMENTS.items()
    if problem.rates and (problem.plane if plane else problem.solid)
]


@pytest.mark.parametrize(("name", "element"), POSED)
def test_rates_on_coarse_meshes(name: str, element: str) -> None:
    """Displacements converge with the square of the element size; plain elements do where they do
    not lock."""
    problem, (plane, incompatible) = PROBLEMS[name], ELEMENTS[element]
    errors = []
    for level in (2, 3):
        made = problem.make(level, plane)
        errors.append(
            abs(made.solve(incompatible)["displacement"] / made.exact["displacement"] - 1.0)
        )
    rate = rates(errors)[1]
    print(f"{name}, {element}: errors {errors[0]:.1e}, {errors[1]:.1e}, rate {rate:.2f}")
    if incompatible or name == "thick cylinder, nu = 0.3":
        assert errors[1] < 1e-3 and rate > 1.9
    else:  # thin, or nearly incompressible
        assert errors[1] > 0.05


def test_ring_on_an_elliptical_cam() -> None:
    """Second order to the closed form, up to the shear that it leaves out, of the order of (t /
    R)^2."""
    solved = [ring_on_cam(level, True, True, 3, "direct", MPI.COMM_SELF)[1] for level in range(4)]
    exact = closed_form()
    for quantity, wanted in exact.items():
        values = [s[quantity] for s in solved]
        found, order = limit(values)
        print(
            f"{quantity}: {values}, limit {found:.4f}, order {order:.2f}, closed form {wanted:.4f}"
        )
        assert order == pytest.approx(2.0, abs=0.1)
        assert found == pytest.approx(wanted, rel=(THICKNESS / INNER) ** 2)


def test_limit() -> None:
    """Exact for any single order, also on meshes that are no halvings; without an order the last
    value."""
    for order in (0.7, 1.0, 2.0, 3.3):
        for sizes in (None, [3.0, 2.0, 1.0]):
            h = np.array(sizes or [4.0, 2.0, 1.0])
            found = limit([9.0, *(5.0 - 0.3 * h**order)], sizes and [7.0, *sizes])
            assert found == pytest.approx((5.0, order), rel=1e-9)
    assert limit([1.0, 2.0, 1.5]) == (1.5, None)
    assert limit([1.0, 2.0, 4.0]) == (4.0, None)
    assert limit([1.0, 2.0, 2.0]) == (2.0, None)
