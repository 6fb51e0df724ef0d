"""What surrounds the ring gear: an elastic housing, and a rigid frame."""

from __future__ import annotations

from typing import Any, Literal

from swgpar.input.quantities import Section, not_negative, positive, quantity
from swgpar.materials import OptionalMaterial
from swgpar.materials.temperature import temperature


def _interference(within: str) -> Any:
    return not_negative(f"by how much the outer diameter of {within}, before the fit", "mm", 0.0)


class Housing(Section):
    """Section [ring_gear.housing]: an elastic ring around the ring gear and bonded to it, as wide
    as the gear."""

    thickness: float = positive("radial thickness", "mm")
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
    expansion: float | None = not_negative(
        "coefficient of thermal expansion of the frame, needed with its temperature",
        "1/K",
        None,
        le=1e-3,
    )
