"""Mesh cycles of a stage from its helical or straight teeth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from swgpar.gear_trains.planetary_parts.sections import MeshCycle
from swgpar.gear_trains.planetary_stage.tooth_meshes.iso_6336 import (
    SECOND_PAIR,
    mesh_stiffness,
    single_stiffness,
)
from swgpar.gear_trains.planetary_stage.tooth_meshes.pairs import ToothedGear, ToothedStage
from swgpar.gear_trains.planetary_stage.tooth_meshes.plane_pair import (
    PairStiffness,
    TipRelief,
    pair_stiffness,
)

Method = Literal["iso_6336", "plane"]


@dataclass(frozen=True)
class HelicalTeeth:
    """teeth : of sun, planet and ring;  module : transverse, mm
    angle : transverse pressure angle, rad;  helix : rad
    basic_rack : addendum, dedendum and profile shift of the sun, in normal modules
    face_width : mm;  material : modulus of elasticity in MPa, Poisson's ratio
    relief : of the tips, which only plane elements know
    """

    teeth: tuple[int, int, int]
    module: float
    angle: float
    helix: float
    basic_rack: tuple[float, float, float]
    face_width: float
    material: tuple[float, float]
    relief: TipRelief = TipRelief()

    @property
    def overlap(self) -> float:
        """Overlap ratio."""
        return self.face_width * float(np.tan(self.helix)) / (np.pi * self.module)

    @property
    def transverse(self) -> ToothedStage:
        """The gears in the transverse section. Adjacent gears have opposite shifts."""
        sun, planet, ring = self.teeth
        normal = self.module * float(np.cos(self.helix))
        addendum, dedendum, shift = (normal * one for one in self.basic_rack)

        def gear(teeth: int, own_shift: float) -> ToothedGear:
            return ToothedGear(teeth, self.module, self.angle, own_shift, addendum, dedendum)

        return ToothedStage(gear(sun, shift), gear(planet, -shift), gear(-ring, shift))


def stiffnesses(
    teeth: HelicalTeeth, load: float, method: Method
) -> tuple[PairStiffness, PairStiffness]:
    """Of sun and ring meshes. load : N/mm of face width along the line of action"""
    sun, planet, _ = teeth.teeth
    _, dedendum, shift = teeth.basic_rack
    found = []
    for mesh, numbers, shifts in zip(
        teeth.transverse.meshes,
        ((float(sun), float(planet)), (float(planet), np.inf)),
        ((shift, -shift), (-shift, shift)),
        strict=True,
    ):
        if method == "plane":
            found.append(pair_stiffness(mesh, load, *teeth.material, teeth.relief))
            continue
        angle = float(np.arctan(np.tan(teeth.angle) * np.cos(teeth.helix)))
        rack = {"dedendum": dedendum, "angle": angle, "helix": teeth.helix}
        steel = {"modulus": 1e-3 * teeth.material[0], "load": load}
        single = single_stiffness(numbers, shifts, **rack, **steel)
        mean = mesh_stiffness(single, mesh.contact_ratio)
        found.append(PairStiffness(1e3 * single, 1e3 * mean, 0.5 * SECOND_PAIR * single / mean))
    return found[0], found[1]


def mesh_cycle(teeth: HelicalTeeth, load: float, method: Method) -> MeshCycle:
    """Stiffness over the tooth cycle, contact ratios and phase; load as in `stiffnesses`."""
    sun, ring = stiffnesses(teeth, load, method)
    stage = teeth.transverse
    ratios = [mesh.contact_ratio for mesh in stage.meshes]
    width = 1e3 * teeth.face_width  # MPa times mm, in N/m
    return MeshCycle(
        (width * sun.mean, width * ring.mean),
        (sun.variation, ring.variation),
        (ratios[0], ratios[1]),
        stage.phase,
        teeth.overlap,
    )
