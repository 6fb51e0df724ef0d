"""Patch test of the law of the flexible spline of a design file, for a package to which that law
has been added.

python own_law.py DESIGN
"""

from __future__ import annotations

import sys

import numpy as np

from support.element_limits import distorted_grid
from support.element_mesh import ElementMesh
from swgpar import load_design
from swgpar.errors import InputError
from swgpar.materials import Isotropic, Material

STRAIN = np.array([2.0, -1.0, 3.0, 0.5, 1.5, -2.0]) * 1e-6
"""xx, yy, zz, xy, yz, zx; engineering shear strains."""


def main(path: str) -> None:
    """The law passes the patch test; a wrong section is refused."""
    design = load_design(path)
    material = design.materials["flexible_spline"]
    assert not isinstance(material, Isotropic)
    check_patch(material)
    try:
        design.with_values({"flexible_spline.material.K": -1.0})
    except InputError as error:
        assert "flexible_spline.material.K = -1 is out of range" in str(error)
    else:
        raise AssertionError("a law that yields energy is accepted")


def check_patch(material: Material) -> None:
    """Assert that distorted hexahedra under a constant strain have the stresses of a law."""
    points, hexes, inner = distorted_grid(3, 0.25, np.random.default_rng(0))
    mesh = ElementMesh(points, hexes, material)
    xx, yy, zz, xy, yz, zx = STRAIN
    gradient = np.array(
        [[xx, 0.5 * xy, 0.5 * zx], [0.5 * xy, yy, 0.5 * yz], [0.5 * zx, 0.5 * yz, zz]]
    )
    u = points @ gradient
    fixed = np.repeat(~inner[:, None], 3, axis=1)
    stress = mesh.stress(mesh.solve(fixed, np.where(fixed, u, 0.0), np.zeros_like(u)))
    exact = np.linalg.solve(material.compliance(), STRAIN)
    assert (
        np.abs(stress - exact).max() < 1e-4 * np.abs(exact).max()
    )  # the rotation is of second order


if __name__ == "__main__":
    main(sys.argv[1])
