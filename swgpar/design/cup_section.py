"""Section [cup] of the drive's design file: the wall of the flexible spline behind its teeth."""

from __future__ import annotations

from typing import Literal

from swgpar.input.quantities import Section, quantity


class ContourPoint(Section):
    """One table [[cup.contour]]: a point of the wall's section. Between points its surfaces are straight."""

    distance: float = quantity(unit="mm", text="from the back of the teeth along the axis", gt=0.0)
    thickness: float = quantity(unit="mm", text="thickness of the wall, across the axis", gt=0.0)
    radius: float | None = quantity(
        None, unit="mm", text="inner radius of the wall; default that below the teeth", gt=0.0
    )
    rounding: float = quantity(0.0, unit="mm", text="radius that rounds the corners at this point", ge=0.0)


class Cup(Section):
    """Section [cup]: the wall of the flexible spline behind its teeth."""

    shape: Literal["cup", "hat"] = quantity(
        "cup", text="the wall ends in a closed end with a bore, or in a flange outwards (silk hat)"
    )
    length: float = quantity(
        unit="mm", text="from the back of the teeth to the far face of closed end or flange", gt=0.0
    )
    thickness_coef: float = quantity(
        0.8, text="thickness of the wall at the back of the teeth over rim thickness", ge=0.1, le=0.95
    )
    contour: list[ContourPoint] = quantity(
        [], text="points of a wall that is not straight, from the teeth on; behind the last one it is straight"
    )
    end_thickness: float | None = quantity(
        None, unit="mm", text="thickness of closed end or flange; default that of the wall", gt=0.0
    )
    fillet_radius: float = quantity(
        unit="mm", text="fillet radius of a closed end on its outer side, of a flange on its inner side", gt=0.0
    )
    inner_radius: float | None = quantity(
        None, unit="mm", text='bore radius of the closed end, needed with shape "cup"', gt=0.0
    )
    flange_radius: float | None = quantity(
        None, unit="mm", text='outer radius of the flange, needed with shape "hat"', gt=0.0
    )
    back_fillet: float = quantity(0.0, unit="mm", text="fillet radius between back of teeth and wall", ge=0.0)

    @property
    def edge(self) -> float:
        """Radius (mm) of the bore, or of the rim of the flange."""
        return self.flange_radius if self.shape == "hat" else self.inner_radius
