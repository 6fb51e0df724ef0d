"""Laws of materials: matrices, contact of two materials, rings of two materials, and a law added as
documented."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from support.element_mesh import ElementMesh
from support.element_problems import arc, solve
from support.line_contact import line_contact
from support.markdown import examples
from support.own_law import check_patch
from support.page_steps import copied_package, require_count
from support.paths import DESIGN, ROOT
from swgpar import load_design
from swgpar.checks.remarks import remarks
from swgpar.errors import InputError
from swgpar.fem.element_matrices import element_matrices
from swgpar.materials import (
    LIBRARY,
    Isotropic,
    Material,
    TransverselyIsotropic,
    contact_modulus,
)

STEEL, ALUMINIUM = Isotropic(E=210e3, nu=0.29), Isotropic(E=70e3, nu=0.33)

PAGE = ROOT / "docs" / "howto" / "own_material.md"


@pytest.mark.parametrize("nu", [0.0, 0.29, 0.49])
def test_closed_forms_of_the_isotropic_law(nu: float) -> None:
    law = Isotropic(E=210e3, nu=nu)
    assert law.elasticity() == pytest.approx(Material.elasticity(law), rel=1e-12, abs=1e-6)
    shares = np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])
    plane_stress = 210e3 / (1.0 - nu**2) * shares
    assert law.plane_stress() == pytest.approx(plane_stress, rel=1e-12, abs=1e-6)
    assert (law.modulus, law.poisson) == pytest.approx((210e3, nu), rel=1e-14)


@pytest.mark.parametrize("plane_stress", [False, True])
def test_two_cylinders_of_two_materials(plane_stress: bool) -> None:
    """Johnson, Contact Mechanics, 4.2: p0 = sqrt(P E* / (pi R)), 1 / E* = sum of (1 - nu²) / E, and
    1 / R of 1 / Ri."""
    radii, load = (2.0, 5.0), 40.0
    radius = 1.0 / sum(1.0 / r for r in radii)
    shares = (
        (1.0 / 210e3, 1.0 / 70e3)
        if plane_stress
        else ((1.0 - 0.29**2) / 210e3, (1.0 - 0.33**2) / 70e3)
    )
    modulus = contact_modulus(STEEL, ALUMINIUM, plane_stress=plane_stress)
    assert modulus == pytest.approx(1.0 / sum(shares), rel=1e-14)
    found = line_contact(lambda x: sum(0.5 * x**2 / r for r in radii), 0.0, 0.05, load, modulus)
    assert found.peak == pytest.approx(np.sqrt(load / sum(shares) / (np.pi * radius)), rel=2e-3)
    assert found.half_width == pytest.approx(
        np.sqrt(4.0 * load * radius * sum(shares) / np.pi), rel=0.01
    )


def test_two_rings_of_two_materials() -> None:
    """A steel ring in one of aluminium under inner pressure, in plane stress: displacements by
    Lamé's equations.

    The radial displacement is A r + B / r in each ring, with the stress E / (1 - nu²) ((1 + nu) A -
    (1 - nu) B / r²).
    """
    a = 3.0
    b = 5.0
    c = 9.0
    n = 40
    radii = np.concatenate([np.linspace(a, b, n + 1), np.linspace(b, c, n + 1)[1:]])
    points, quads, fixed, flat = arc(np.linspace(0.0, 0.5 * np.pi, 2 * n + 1), radii, True)
    mesh = ElementMesh(points, quads, STEEL)
    outer = np.hypot(*points[quads].mean(axis=1)[:, :2].T) > b
    for matrices, other in zip(
        mesh.reference, element_matrices(points[quads[outer]], ALUMINIUM, 1.0)
    ):
        matrices[outer] = other
    fixed[:, 2] = True
    inner = flat[:, 1] < a + 1e-9
    angle = flat[inner, 0]
    share = np.where((angle < 1e-9) | (angle > 0.5 * np.pi - 1e-9), 0.5, 1.0)
    load = np.zeros_like(points)
    normal = np.column_stack([np.sin(angle), np.cos(angle)])
    load[inner, :2] = 2.0 * a * np.sin(0.125 * np.pi / n) * share[:, None] * normal
    load[fixed] = 0.0
    u = solve(mesh, fixed, load, "direct")

    def rows(material: Isotropic, r: float) -> tuple[list[float], list[float]]:
        stiff = material.E / (1.0 - material.nu**2)
        return [r, 1.0 / r], [stiff * (1.0 + material.nu), -stiff * (1.0 - material.nu) / r**2]

    (moved, pressed), (moved_outside, pressed_outside) = rows(STEEL, b), rows(ALUMINIUM, b)
    system = [
        [*rows(STEEL, a)[1], 0.0, 0.0],
        [*moved, *(-value for value in moved_outside)],
        [*pressed, *(-value for value in pressed_outside)],
        [0.0, 0.0, *rows(ALUMINIUM, c)[1]],
    ]
    steel, aluminium = np.linalg.solve(system, [-1.0, 0.0, 0.0, 0.0]).reshape(2, 2)
    for radius, (linear, inverse) in ((a, steel), (b, steel), (b, aluminium), (c, aluminium)):
        at = np.abs(flat[:, 1] - radius) < 1e-9
        directions = np.column_stack([np.sin(flat[at, 0]), np.cos(flat[at, 0])])
        found = (u[at, :2] * directions).sum(axis=1).mean()
        assert found == pytest.approx(linear * radius + inverse / radius, rel=1e-3)


def test_bodies_fall_back_on_the_material_of_the_drive() -> None:
    sections = ("ring_gear.housing.thickness=3", "ring_gear.material={E=70e3, nu=0.33}")
    design = load_design(DESIGN, sections)
    assert design.materials["ring_gear"] == ALUMINIUM
    assert design.materials["flexible_spline"] is design.materials["housing"] is design.material
    assert design.modulus_of("flexible_spline", "ring_gear") == 70e3


def test_a_name_gives_what_is_missing() -> None:
    sections = ('ring_gear.material={name="7075-T6", nu=0.34}', "ring_gear.material.density=2800.0")
    material = load_design(DESIGN, sections).materials["ring_gear"]
    assert (material.modulus, material.poisson) == pytest.approx((71e3, 0.34))
    assert material.density == 2800.0
    with pytest.raises(InputError, match='ring_gear.material.name = "wood" is not available'):
        load_design(DESIGN, ['ring_gear.material={name="wood"}'])


def test_plastics_are_known_to_creep() -> None:
    design = load_design(DESIGN, ['flexible_spline.material={name="PLA"}'])
    assert any(
        "creep" in sentence and "flexible_spline" in sentence for sentence in remarks(design)
    )
    assert not any("creep" in sentence for sentence in remarks(load_design(DESIGN)))


def test_the_page_has_the_library() -> None:
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    first = (
        lines.index(
            "| name | material | E (MPa) | nu | density (kg/m³) | expansion (1/K) | source |"
        )
        + 2
    )
    assert lines[first : first + len(LIBRARY) + 1] == [
        *(
            f"| `{name}` | {m.text} | {m.E:g} | {m.nu:g} | {m.density:g} | "
            f"{m.expansion:g} | {m.source} |"
            for name, m in LIBRARY.items()
        ),
        "",
    ]


LAYERS = TransverselyIsotropic(E=3000.0, nu=0.35, E_z=2400.0, nu_z=0.3, G_z=900.0)


def test_layers_pass_the_patch_test() -> None:
    check_patch(LAYERS)


def test_layers_that_are_alike_in_all_directions_are_isotropic() -> None:
    alike = TransverselyIsotropic(E=3000.0, nu=0.35, E_z=3000.0, nu_z=0.35, G_z=3000.0 / 2.7)
    assert alike.elasticity() == pytest.approx(Isotropic(E=3000.0, nu=0.35).elasticity(), rel=1e-12)
    assert alike.contact_compliance() == pytest.approx((1.0 - 0.35**2) / 3000.0, rel=1e-14)


def test_layers_do_not_depend_on_the_angle_about_the_axis() -> None:
    """Lekhnitskii: a rotation about z leaves the law as it is."""
    c, s = np.cos(0.7), np.sin(0.7)
    stresses = np.array(  # xx, yy, zz, xy, yz, zx in axes rotated by 0.7 about z
        [
            [c * c, s * s, 0.0, 2.0 * c * s, 0.0, 0.0],
            [s * s, c * c, 0.0, -2.0 * c * s, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
            [-c * s, c * s, 0.0, c * c - s * s, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, c, -s],
            [0.0, 0.0, 0.0, 0.0, s, c],
        ]
    )
    compliance = LAYERS.compliance()
    assert stresses.T @ compliance @ stresses == pytest.approx(compliance, rel=1e-12, abs=1e-18)


def test_layers_that_yield_energy_are_refused() -> None:
    section = (
        'ring_gear.material={type="transversely_isotropic", E=3e3, nu=0.3, E_z=2e3, G_z=900.0,'
    )
    with pytest.raises(InputError, match="ring_gear.material is a material that yields energy"):
        load_design(DESIGN, [section + " nu_z=0.99}"])


def test_a_law_is_added_as_the_page_says(tmp_path: Path) -> None:
    """The file and the registry of the page, in a copy of the package: a patch test and a design
    with that law."""
    law, registry = examples(PAGE, "python")
    package = copied_package(tmp_path)
    (package / "materials" / "bulk_and_shear.py").write_text(law, encoding="utf-8")
    added, chosen = registry.strip().split("\n\n")
    laws = (package / "materials" / "laws.py").read_text(encoding="utf-8")
    extended = rf"{added}\n\nLaw = \1 | {chosen.rpartition(' | ')[2]}\n"
    laws, count = re.subn(r'^Law = (.+?)\n(?=""")', extended, laws, flags=re.MULTILINE | re.DOTALL)
    assert count == 1
    (package / "materials" / "laws.py").write_text(laws, encoding="utf-8")
    require_count(PAGE, package)
    section = examples(PAGE, "toml")[-1]
    text = DESIGN.read_text(encoding="utf-8") + "\n" + section
    (tmp_path / "design.toml").write_text(text, encoding="utf-8")
    paths = os.pathsep.join([str(tmp_path), str(ROOT / "tests")])
    check = [
        sys.executable,
        str(ROOT / "tests" / "support" / "own_law.py"),
        str(tmp_path / "design.toml"),
    ]
    environment = os.environ | {"PYTHONPATH": paths}
    done = subprocess.run(
        check, env=environment, cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
