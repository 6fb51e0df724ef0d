"""Elements at large strains against exact solutions of their own law, and that law against others
with the same E and nu: the tables of docs/verification/strains.md."""

from __future__ import annotations

from pathlib import Path

from page import markdown, put

from support.large_strains import (
    LAWS,
    PlaneLaw,
    bent_beam,
    biot,
    least_stiffness,
    pressed_ring,
    stretched_bar,
)

PAGE = Path("docs/verification/strains.md")
STRAINS = (0.01, 0.02, 0.05, 0.1)
POISSON = 0.48
DEEP = 2
"""Elements over the depth of beam and ring: rims of drives have two and more."""

RADII = (10.0, 11.0)


def percent(found: float, exact: float, digits: int = 2) -> str:
    """A difference, in % of the exact value."""
    return f"{100.0 * (found / exact - 1.0):.{digits}f}"


def elements() -> str:
    """Errors of both elements against the exact solutions of their law."""
    rows = [["strain", "elements", "bar", "ring", "beam: moment", "beam: outer fibre"]]
    law = PlaneLaw(biot, POISSON)
    for strain in STRAINS:
        moment, fibre = law.bending(2.0 * strain)
        for name, plane in (("quadrilaterals", True), ("hexahedra", False)):
            beam = bent_beam(strain, POISSON, DEEP, plane)
            bar = stretched_bar(strain, POISSON, plane)
            ring = pressed_ring(strain, POISSON, DEEP, plane)
            rows.append(
                [
                    f"{100 * strain:g} %",
                    name,
                    percent(bar, law.uniaxial(strain)),
                    percent(ring, law.expansion(*RADII, strain)),
                    percent(beam[0], moment),
                    percent(beam[1], fibre),
                ]
            )
    return markdown(rows)


def laws() -> str:
    """Other laws against that of the elements."""
    rows = [["strain", "law", "bar", "bar, compressed", "ring", "beam: moment", "beam: fibre"]]
    linear = PlaneLaw(biot, POISSON)
    for strain in STRAINS:
        moment, fibre = linear.bending(2.0 * strain)
        for name, function in LAWS.items():
            law = PlaneLaw(function, POISSON)
            bent = law.bending(2.0 * strain)
            rows.append(
                [
                    f"{100 * strain:g} %",
                    name,
                    percent(law.uniaxial(strain), linear.uniaxial(strain), 1),
                    percent(law.uniaxial(-strain), linear.uniaxial(-strain), 1),
                    percent(law.expansion(*RADII, strain), linear.expansion(*RADII, strain), 1),
                    percent(bent[0], moment, 1),
                    percent(bent[1], fibre, 1),
                ]
            )
    return markdown(rows)


def stability() -> str:
    """Least eigenvalues of stretched blocks."""
    rows = [["strain", "quadrilaterals", "hexahedra"]]
    for strain in (-0.4, -0.3, -0.2, -0.1, 0.1, 0.3):
        values = [f"{least_stiffness(strain, POISSON, plane):.2f}" for plane in (True, False)]
        rows.append([f"{100 * strain:g} %", *values])
    return markdown(rows)


def main() -> None:
    for name, table in (("elements", elements()), ("laws", laws()), ("stability", stability())):
        put(PAGE, name, table)


if __name__ == "__main__":
    main()
