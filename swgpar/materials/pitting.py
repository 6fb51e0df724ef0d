"""Pressures that flanks of steels bear in the long run, by their treatment and hardness."""

from __future__ import annotations

from dataclasses import dataclass

SOURCE = "ISO 6336-5:2016, table 1, quality MQ"

STEEL_MODULUS = (185e3, 220e3)
"""Moduli of elasticity (MPa) of steels."""


@dataclass(frozen=True)
class PittingLimit:
    """Allowable stress number for contact: slope times hardness and base.

    slope : MPa / HV;  base : MPa;  softest, hardest : HV, between which it holds
    text : the steels
    """

    slope: float
    base: float
    softest: float
    hardest: float
    text: str

    def pressure(self, hardness: float) -> float:
        """Pressure (MPa) at a hardness (HV)."""
        return self.slope * hardness + self.base


PITTING_LIMITS = {
    "through_hardened": PittingLimit(1.313, 373.0, 200.0, 360.0, "through-hardened alloy steels"),
    "induction_hardened": PittingLimit(0.541, 882.0, 500.0, 615.0, "induction-hardened steels"),
    "nitrided": PittingLimit(0.0, 998.0, 450.0, 650.0, "nitrided through-hardening steels"),
    "case_hardened": PittingLimit(0.0, 1500.0, 660.0, 800.0, "case-hardened steels"),
}
"""Limits by `rating.flank_treatment` [ISO 6336-5:2016, table 1, quality MQ]."""
