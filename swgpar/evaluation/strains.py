"""Largest strains under load, and what the linear law leaves open there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from swgpar.answers.answer import AnswerGroup, AnswerKind, answer, evaluation
from swgpar.checks.strain_checks import LARGEST_STRAIN, SAID, spread_text
from swgpar.design.drive_design import DriveDesign
from swgpar.largest_stress.places import APART, BODIES, Place, of_its_bodies
from swgpar.materials import Material

TEXT = "largest strain apart from the contact, of a bar with this von Mises stress"


@evaluation
class LargestStrains(AnswerGroup):
    """Largest von Mises stresses apart from the contact of flanks, over E, in %.

    The errors are those of the stresses.
    """

    fs: float | None = answer(
        "strain.fs", f"flexible spline, {TEXT}", "%", error="fs_error", limit="limit"
    )
    rg: float | None = answer(
        "strain.rg", f"ring gear, {TEXT}", "%", error="rg_error", limit="limit"
    )
    ds: float | None = answer(
        "strain.ds", f"dynamic spline, {TEXT}", "%", error="ds_error", limit="limit", default=None
    )
    fs_error: float | None = None
    rg_error: float | None = None
    ds_error: float | None = None

    TITLE = "strains under load"

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        return of_its_bodies(super().kinds(design), design)

    @property
    def limit(self) -> float:
        """Largest strain at which the law holds, %."""
        return 100.0 * LARGEST_STRAIN

    @property
    def of_bodies(self) -> dict[str, float]:
        """The strains (%) that are known, by the keys of `BODIES`."""
        every = {body: getattr(self, body) for body in BODIES}
        return {body: percent for body, percent in every.items() if percent is not None}

    def remarks(self) -> Iterator[str]:
        for body, percent in self.of_bodies.items():
            if percent < 100.0 * SAID:
                continue
            strained = f"the {BODIES[body]} is strained by {percent:.2g} %"
            yield (
                f"{strained}: {spread_text(0.01 * percent)}, in the bending moment of a rim by "
                "less than 1 %"
                if percent <= self.limit
                else f"{strained}, more than the {self.limit:g} % up to which the linear law "
                "holds: these stresses and forces are no results of a material"
            )


def largest_strains(
    places: Mapping[str, Place], materials: Mapping[str, Material]
) -> LargestStrains:
    """places : by the names of `find_places`;  materials : by body"""
    found: dict[str, float | None] = dict.fromkeys(("fs", "rg"))
    for body in BODIES:
        place = places.get(f"{body}_vm{APART}")
        if place is None:
            continue
        per_stress = 100.0 / materials[place.body].modulus
        found[body] = place.value * per_stress
        if place.error is not None and not place.warning:
            found[f"{body}_error"] = place.error * per_stress
    return LargestStrains(**found)
