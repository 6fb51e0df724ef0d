"""A few documented materials: elastic constants, density and expansion at room temperature."""

from __future__ import annotations

from dataclasses import dataclass

HANDBOOK = "MIL-HDBK-5J (2003), as commonly quoted"
SHEETS = "typical values of makers' data sheets (ISO 527, ISO 1183); nu is an assumption"
PRINTED = "typical values of solid printed parts in the plane of the layers; nu is an assumption"


@dataclass(frozen=True)
class NamedMaterial:
    """What a name of the library stands for.

    E : modulus of elasticity, MPa;  nu : Poisson's ratio;  density : kg/m³
    expansion : mean coefficient of thermal expansion between 20 and 100 °C, 1/K; its sources are in
    docs/howto/own_material.md
    text : what it is;  source : where the numbers come from
    creeps : whether it is a plastic, which creeps under a constant load
    """

    E: float
    nu: float
    density: float
    expansion: float
    text: str
    source: str
    creeps: bool = False


LIBRARY = {
    "steel": NamedMaterial(
        210e3, 0.30, 7850.0, 12.0e-6, "unalloyed and low-alloy steel", "EN 1993-1-1, 3.2.6"
    ),
    "4340": NamedMaterial(
        199.9e3, 0.32, 7833.0, 12.3e-6, "AISI 4340, near to 34CrNiMo6 and 40CrNiMoA", HANDBOOK
    ),
    "17-4PH": NamedMaterial(
        196.5e3,
        0.27,
        7806.0,
        11.2e-6,
        "precipitation-hardening steel 17-4PH, H1025, 1.4542",
        HANDBOOK,
    ),
    "15-5PH": NamedMaterial(
        196.5e3,
        0.27,
        7833.0,
        11.2e-6,
        "precipitation-hardening steel 15-5PH, H1025, 1.4545",
        HANDBOOK,
    ),
    "7075-T6": NamedMaterial(71.0e3, 0.33, 2796.0, 23.4e-6, "aluminium 7075-T6", HANDBOOK),
    "6061-T6": NamedMaterial(68.3e3, 0.33, 2713.0, 23.6e-6, "aluminium 6061-T6", HANDBOOK),
    "Ti-6Al-4V": NamedMaterial(
        110.3e3, 0.31, 4429.0, 8.6e-6, "titanium Ti-6Al-4V, annealed", HANDBOOK
    ),
    "PEEK": NamedMaterial(4.0e3, 0.38, 1300.0, 47e-6, "PEEK, not filled", SHEETS, creeps=True),
    "PA66": NamedMaterial(3.1e3, 0.40, 1140.0, 80e-6, "polyamide 66, dry", SHEETS, creeps=True),
    "POM": NamedMaterial(
        2.8e3, 0.40, 1410.0, 110e-6, "polyoxymethylene, copolymer", SHEETS, creeps=True
    ),
    "PLA": NamedMaterial(3.0e3, 0.35, 1240.0, 68e-6, "polylactide, printed", PRINTED, creeps=True),
    "PETG": NamedMaterial(2.0e3, 0.38, 1270.0, 60e-6, "PETG, printed", PRINTED, creeps=True),
}
"""Materials by the name that a design gives."""
