"""What surrounds the ring gear: an elastic housing, and a rigid frame."""

from __future__ import annotations

from typing import Any, Literal

from swgpar.input.quantities import Section, quantity
from swgpar.materials import OptionalMaterial
from swgpar.materials.temperature import temperature


def _interference(within: str) -> Any:
    return quantity(
        0.0,
        unit="mm",
        text=f"by how much the outer diameter of {within}, before the fit",
        ge=0.0,
    )


class Housing(Section):
    """Section [ring_gear.housing]: an elastic ring around the ring gear and bonded to it, as wide
    as the gear."""

    thickness: float = quantity(unit="mm", text="radial thickness", gt=0.0)
    outside: Literal["free", "held"] = quantity(
        "free", text="outer surface: free, with its mean motion held, or held by a rigid frame"
    )
    interference: float = _interference("the ring gear exceeds the bore of the housing")
    temperature: float | None = temperature("the housing")
    material: OptionalMaterial = None


class Frame(Section):
    """Section [ring_gear.frame]: the rigid frame around the ring gear, or around its housing."""

    interference: float = _interference("what it holds exceeds the bore of the frame")
    temperature: float | None = temperature("the frame")
    expansion: float | None = quantity(
        None,
        unit="1/K",
        text="coefficient of thermal expansion of the frame, needed with its temperature",
        ge=0.0,
        le=1e-3,
    )
