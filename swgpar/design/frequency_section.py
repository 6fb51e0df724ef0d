"""Section [frequencies] of the drive's design file."""

from __future__ import annotations

from swgpar.input.quantities import Section, not_negative, quantity


class Frequencies(Section):
    """Section [frequencies]: present to compute natural frequencies of the loaded drive."""

    number: int = quantity(6, text="natural frequencies, from the lowest on", ge=1, le=50)
    output_inertia: float = not_negative(
        "moment of inertia of what rotates with the output, besides the gear", "kg·m²", 0.0
    )
