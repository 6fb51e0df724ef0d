"""The sections of a drive's design file, and what follows from their keys alone: which parts the
drive has, what of it is computed, materials."""

from __future__ import annotations

from typing import Any, ClassVar

from swgpar.design.cup_section import Cup
from swgpar.design.deviations import Deviations
from swgpar.design.frequency_section import Frequencies
from swgpar.design.input_coupling import InputCoupling
from swgpar.design.kinematics import Kinematics
from swgpar.design.losses_section import Losses
from swgpar.design.output_bearing import OutputBearing
from swgpar.design.program_sections import Ratcheting, Stiffness
from swgpar.design.rating_section import RatingSection
from swgpar.design.sections import (
    GEARS,
    ContactSection,
    DesignBody,
    Drive,
    DynamicSpline,
    ExternalGear,
    Fatigue,
    Gear,
    GearName,
    InternalGear,
    Load,
    MicroGeometry,
    Output,
    Solver,
    Steps,
)
from swgpar.design.surroundings import Housing
from swgpar.geometry.cams import Bearing, WaveGenerator
from swgpar.input.design import Design
from swgpar.materials import ChosenMaterial, Material
from swgpar.profiles import Teeth


class DriveSections(Design):
    """What a design file of a drive gives. Attributes are its sections."""

    system: ClassVar[str] = "drive"

    drive: Drive
    flexible_spline: ExternalGear
    ring_gear: InternalGear
    dynamic_spline: DynamicSpline | None = None
    wave_generator: WaveGenerator
    cup: Cup | None = None
    micro_geometry: MicroGeometry = MicroGeometry()
    material: ChosenMaterial
    load: Load = Load()
    stiffness: Stiffness | None = None
    ratcheting: Ratcheting | None = None
    contact: ContactSection = ContactSection()
    steps: Steps = Steps()
    solver: Solver = Solver()
    output: Output = Output()
    fatigue: Fatigue | None = None
    losses: Losses | None = None
    deviations: Deviations | None = None
    frequencies: Frequencies | None = None
    output_bearing: OutputBearing | None = None
    input_coupling: InputCoupling | None = None
    rating: RatingSection | None = None

    @property
    def gears(self) -> tuple[GearName, ...]:
        """The gears in the order of the bodies; a dynamic spline is the third one."""
        return GEARS if self.dynamic_spline is None else (*GEARS, "dynamic_spline")

    def axial_range(self, gear: GearName) -> tuple[float, float]:
        """Ends (mm) of the teeth of a gear along z."""
        half, second = 0.5 * self.drive.face_width, self.dynamic_spline
        if second is None or gear == "flexible_spline":
            return -half, half
        begin = half - (second.face_width or half - 0.5 * second.gap)
        return (begin, half) if gear == "dynamic_spline" else (-half, begin - second.gap)

    @property
    def kinematics(self) -> Kinematics:
        """Speeds and angles. In a pancake drive the dynamic spline is the output or stands where
        the flexible spline does in others."""
        drive, bearing = self.drive, self.bearing
        output: GearName = "flexible_spline" if self.dynamic_spline is None else "dynamic_spline"
        standing: GearName = "ring_gear"
        if drive.layout == "spline_fixed":
            output, standing = standing, output
        return Kinematics(
            teeth_fs=drive.teeth_fs,
            teeth_rg=drive.teeth_rg,
            lobes=self.wave_generator.lobes,
            lobes_are_alike=self.wave_generator.lobes_are_alike,
            output_gear=output,
            standing_gear=standing,
            wave_generator_is_fixed=drive.layout == "wave_generator_fixed",
            bolts=self.cup.bolts if self.is_bolted else 0,
            balls=0 if bearing is None else bearing.balls,
            balls_pass=bearing is not None and bearing.cage_speed != 1.0,
        )

    @property
    def lobes_are_alike(self) -> bool:
        """Whether a rotation by one lobe leaves the wave generator as it is, and puts balls on
        balls."""
        bearing, wave = self.bearing, self.wave_generator
        return wave.lobes_are_alike and (bearing is None or bearing.balls % wave.lobes == 0)

    @property
    def has_program(self) -> bool:
        """Whether the output follows a load program, in place of one torque and a rotation."""
        return bool(self.load.program or self.stiffness or self.ratcheting)

    @property
    def is_mirror_symmetric(self) -> bool:
        """Whether the undeformed drive is its own image in the plane through the axis and the major
        axis, at any angle of the wave generator. Balls leave the plane when it turns. With bolts,
        or a load from one side, no other state mirrors it."""
        return self.bearing is None and self.starts_mirror_symmetric

    @property
    def starts_mirror_symmetric(self) -> bool:
        """Whether it is so before the wave generator turns: a ball, or the middle between two, is
        on the major axis then."""
        alone = self.repeats and not self.is_bolted
        in_plane = self.bearing is None or self.bearing.starts_mirror_symmetric
        return self.wave_generator.is_mirror_symmetric and alone and in_plane

    @property
    def has_cup(self) -> bool:
        """Whether the flexible spline has a wall and an end; the plane model leaves them out."""
        return self.drive.model == "cup"

    @property
    def has_attachment(self) -> bool:
        """Whether closed end or flange is clamped or bolted."""
        return self.has_cup and self.cup.attachment != "edge"

    @property
    def is_bolted(self) -> bool:
        """Whether bolts hold the cup, so that its teeth are not alike."""
        return self.has_attachment and self.cup.attachment == "bolted"

    @property
    def is_loaded_sideways(self) -> bool:
        """Whether a radial force or a tilting moment acts on the output."""
        return self.output_bearing is not None and self.output_bearing.is_loaded_sideways

    @property
    def repeats(self) -> bool:
        """Whether the drive is in the same state again after a period of its motion, apart from
        names of teeth: not where a load stands still beside them."""
        return not self.is_loaded_sideways

    @property
    def copies(self) -> int:
        """How many times the model makes the whole drive: the number of lobes where the drive
        equals itself rotated by one of them and the design allows it, else 1."""
        lobes = self.wave_generator.lobes
        counts = [self.drive.teeth_fs, self.drive.teeth_rg]
        if self.is_bolted:
            counts.append(self.cup.bolts)
        # modes of a part of the drive are not all modes
        symmetric = all(count % lobes == 0 for count in counts) and self.frequencies is None
        symmetric = symmetric and self.lobes_are_alike and not self.is_loaded_sideways
        return lobes if symmetric and self.solver.symmetry else 1

    @property
    def periods(self) -> int:
        """Periods that are computed with `steps.samples`: two with friction, whose state settles in
        the first."""
        return 2 if self.contact.friction else 1

    @property
    def bearing(self) -> Bearing | None:
        """Section [wave_generator.bearing]; None where the cam touches the flexible spline."""
        return self.wave_generator.bearing

    @property
    def race_width(self) -> float:
        """Width of the outer race, mm."""
        return self.bearing.race_width or self.wave_generator.face_width

    @property
    def housing(self) -> Housing | None:
        """Section [ring_gear.housing]; None where the frame around the ring gear is rigid."""
        return self.ring_gear.housing

    @property
    def frame_is_rigid(self) -> bool:
        """Whether a rigid frame surrounds the ring gear, or its housing."""
        return self.housing is None or self.housing.outside == "held"

    @property
    def uses_pins(self) -> bool:
        """Whether pins deflect the flexible spline; with a bearing the cam grows instead."""
        return self.steps.pins and self.bearing is None

    @property
    def resolves_root_stress(self) -> bool:
        """Whether windows resolve the stress at the teeth."""
        return self.output.root_stress and not self.has_program

    @property
    def compares_meshes(self) -> bool:
        """Whether the drive is loaded on coarser meshes for errors by the mesh."""
        compares = self.output.contact_errors and not self.has_program
        return self.resolves_root_stress or compares

    @property
    def start_levels(self) -> int:
        """Coarser meshes on which a run starts; none with friction, because the loaded state then
        depends on the path to it."""
        return 0 if self.contact.friction else self.steps.start_levels

    @property
    def starts_bent(self) -> bool:
        """Whether a run begins with the bent shape; not with friction either."""
        return self.steps.bent_start and not self.contact.friction

    @property
    def resolves_wall(self) -> bool:
        """Whether rings resolve the stress of the wall of a cup."""
        return self.output.root_stress and self.has_cup

    @property
    def leaves_out_far_teeth(self) -> bool:
        """Whether teeth out of reach are left out; they have mass."""
        return self.solver.far_teeth == "left_out" and self.frequencies is None

    @property
    def condenses_teeth(self) -> bool:
        """Whether a tooth is one element where nothing touches it, and no mass counts."""
        return self.leaves_out_far_teeth and self.drive.model != "plane" and not self.load.inertia

    @property
    def leaves_out_sectors(self) -> bool:
        """Whether sectors of the ring gear out of reach are left out; an elastic housing gives way
        all round."""
        clamped = self.kinematics.standing_gear == "ring_gear" and self.housing is None
        return self.leaves_out_far_teeth and clamped

    def modulus_of(self, *bodies: DesignBody) -> float:
        """Modulus of elasticity (MPa) of the softest of bodies: the scale of contacts and supports
        between them."""
        return min(self.materials[body].modulus for body in bodies)

    def penalty(self, *bodies: DesignBody) -> float:
        """Stiffness of the support of a body, or penalty of the flanks of two in exported jobs,
        MPa / mm."""
        return self.contact.penalty_coef * self.modulus_of(*bodies) / self.drive.module

    @property
    def wg_penalty(self) -> float:
        """Penalty of the contact of cam and pins, MPa / mm."""
        return self.contact.wg_penalty_coef * self.modulus_of("flexible_spline") / self.drive.module

    @property
    def materials(self) -> dict[str, Material]:
        """Materials of the gears, of the housing and of the bearing by name: that of their own
        section, else [material]."""
        sections: dict[str, Gear | Housing | Bearing | None] = {
            "housing": self.housing,
            "bearing": self.bearing,
        }
        sections |= {gear: getattr(self, gear) for gear in self.gears}
        return {
            body: section.material or self.material
            for body, section in sections.items()
            if section is not None
        }

    def teeth(self, gear: GearName) -> Teeth:
        """Number and sizes of the teeth of a gear."""
        return self.drive.teeth(gear, getattr(self, gear))

    @property
    def temperature_rises(self) -> dict[str, float]:
        """Temperatures (K) above the reference, by the name of the section that has the key."""
        sections: dict[str, Any] = {gear: getattr(self, gear) for gear in self.gears}
        sections |= {
            "ring_gear.housing": self.housing,
            "ring_gear.frame": self.ring_gear.frame,
            "wave_generator": self.wave_generator,
            "wave_generator.bearing": self.bearing,
        }
        reference = self.load.reference_temperature
        return {
            name: 0.0 if section.temperature is None else section.temperature - reference
            for name, section in sections.items()
            if section is not None
        }

    @property
    def cam_strain(self) -> float:
        """Strain of the growth of the rigid cam."""
        own = self.wave_generator.expansion
        expansion = self.material.expansion if own is None else own
        return (expansion or 0.0) * self.temperature_rises["wave_generator"]
