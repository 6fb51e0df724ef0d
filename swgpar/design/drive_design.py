"""The validated design of a drive: its sections and the quantities derived from them (section
3.2)."""

from __future__ import annotations

import numpy as np

from swgpar.design.cup_section import Cup
from swgpar.design.cup_sizes import CupSizes
from swgpar.design.deviations import Deviations
from swgpar.design.frequency_section import Frequencies
from swgpar.design.kinematics import Kinematics, make_kinematics
from swgpar.design.program_sections import Ratcheting, Stiffness
from swgpar.design.sections import (
    GEARS,
    OMITTED_BENDING,
    Contact,
    DesignBody,
    Drive,
    DynamicSpline,
    ExternalGear,
    Fatigue,
    Gear,
    GearName,
    Housing,
    InternalGear,
    Load,
    Losses,
    MicroGeometry,
    Output,
    Solver,
    Steps,
)
from swgpar.geometry.bearing import BearingSizes
from swgpar.geometry.cams import Bearing, Cam, WaveGenerator, make_cam
from swgpar.geometry.cams.semi_axes import minor_semi_axis, radial_deflection
from swgpar.geometry.disc_surface import CamSurface, cam_surface
from swgpar.geometry.neutral_line import neutral_line
from swgpar.geometry.profiles import (
    Conjugate,
    RackInvolute,
    RackPath,
    SShaped,
    Teeth,
    ToothMotion,
    ToothProfile,
    make_profile,
)
from swgpar.geometry.profiles.rigid_teeth import RigidTeeth
from swgpar.geometry.profiles.tip_relief import relieved
from swgpar.geometry.rim_motion import axial_travel, omitted_bending
from swgpar.input.design import Design
from swgpar.materials import ChosenMaterial, Material
from swgpar.meshing.drive_geometry import DriveGeometry, FlankCrowning, GearGeometry


class DriveDesign(Design):
    """A drive, its load and how it is computed. Attributes are the keys of the design file."""

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
    contact: Contact = Contact()
    steps: Steps = Steps()
    solver: Solver = Solver()
    output: Output = Output()
    fatigue: Fatigue | None = None
    losses: Losses | None = None
    deviations: Deviations | None = None
    frequencies: Frequencies | None = None

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
    def deflection(self) -> float:
        """Diametral deflection d, mm: twice the radial one at a lobe, for any number of lobes."""
        standard = 0.5 * self.drive.standard_deflection
        return 2.0 * radial_deflection(self.wave_generator, self.inner_radius, standard)

    @property
    def inner_radius(self) -> float:
        """Inner radius r_fs of the undeformed flexible spline, mm (eq. 3.1); a profile shift moves
        the root circle."""
        teeth, profile = self.teeth("flexible_spline"), self.flexible_spline.profile
        shift = profile.shift * teeth.module if isinstance(profile, RackInvolute) else 0.0
        return teeth.r_pitch - teeth.dedendum + shift - self.flexible_spline.rim

    @property
    def major_semi_axis(self) -> float:
        """Major semi-axis a of the wave generator, mm (eq. 3.3)."""
        return self.inner_radius + 0.5 * self.deflection

    @property
    def minor_semi_axis(self) -> float | None:
        """Minor semi-axis b of the wave generator, mm (eqs 3.2, 3.4); rollers have none."""
        return minor_semi_axis(self.wave_generator, self.inner_radius, 0.5 * self.deflection)

    @property
    def kinematics(self) -> Kinematics:
        """Speeds and angles."""
        return make_kinematics(
            self.drive, self.wave_generator.lobes, self.dynamic_spline is not None
        )

    @property
    def has_program(self) -> bool:
        """Whether the output follows a load program, in place of one torque and a rotation."""
        return bool(self.load.program or self.stiffness or self.ratcheting)

    @property
    def is_mirror_symmetric(self) -> bool:
        """Whether the undeformed drive is its own image in the plane through the axis and the major
        axis. The balls of a bearing are placed on one side of it or the other. With bolts no other
        state mirrors it."""
        return (
            self.wave_generator.is_mirror_symmetric and self.bearing is None and not self.is_bolted
        )

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
    def copies(self) -> int:
        """How many times the model makes the whole drive: the number of lobes where the drive
        equals itself rotated by one of them and the design allows it, else 1."""
        lobes = self.wave_generator.lobes
        counts = [self.drive.teeth_fs, self.drive.teeth_rg]
        if self.bearing is not None:
            counts.append(self.bearing.balls)
        if self.is_bolted:
            counts.append(self.cup.bolts)
        # modes of a part of the drive are not all modes
        symmetric = all(count % lobes == 0 for count in counts) and self.frequencies is None
        symmetric = symmetric and self.wave_generator.lobes_are_alike
        return lobes if symmetric and self.solver.symmetry else 1

    @property
    def periods(self) -> int:
        """Periods that are computed with `steps.samples`: two with friction, whose state settles in
        the first."""
        return 2 if self.contact.friction else 1

    @property
    def backlash(self) -> float:
        """Circumferential backlash at the pitch circles, mm (eqs 6.1 to 6.3)."""
        return self.backlash_of("ring_gear")

    def backlash_of(self, ring: GearName) -> float:
        """Circumferential backlash (mm) of a ring gear: its pitch less both teeth."""
        gears: tuple[GearName, ...] = ("flexible_spline", ring)
        thickness = [self.profile(gear).thickness(self.teeth(gear).r_pitch) for gear in gears]
        return float(np.pi * self.teeth(ring).module - sum(thickness))

    @property
    def largest_backlash(self) -> float:
        """Largest circumferential backlash (mm) of a ring gear; 0 where teeth interfere."""
        return max(0.0, *map(self.backlash_of, self.gears[1:]))

    @property
    def backlash_angle(self) -> float:
        """Rotation gamma of the spline that closes the backlash on one side, rad (eq. 6.4)."""
        return self.backlash / (self.drive.teeth_fs * self.drive.module)

    @property
    def bearing(self) -> Bearing | None:
        """Section [wave_generator.bearing]; None where the cam touches the flexible spline."""
        return self.wave_generator.bearing

    @property
    def bearing_sizes(self) -> BearingSizes:
        """Sizes of the bearing, which the design must have."""
        return BearingSizes(
            self.inner_radius, self.bearing.race_thickness, self.bearing.ball_diameter
        )

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
    def cage_speed(self) -> float:
        """Speed of the cage over that of the wave generator.

        With `steps.samples` it is 1: the balls are then fixed to the cam, because only then the
        drive repeats after a period. Otherwise it is the key, or that of balls that roll on a race
        that rotates with the flexible spline.
        """
        if self.steps.samples:
            return 1.0
        if self.bearing.cage_speed is not None:
            return self.bearing.cage_speed
        return self.bearing_sizes.rolling_speed(self.kinematics.spline_speed)

    @property
    def uses_pins(self) -> bool:
        """Whether pins deflect the flexible spline; with a bearing the cam grows instead."""
        return self.steps.pins and self.bearing is None

    @property
    def without_windows(self) -> str:
        """What keeps windows from resolving the stress at the teeth; empty without."""
        if self.bearing is not None:
            return "a bearing"
        return "" if self.dynamic_spline is None else "two ring gears"

    @property
    def resolves_root_stress(self) -> bool:
        """Whether windows resolve the stress at the teeth."""
        return self.output.root_stress and not self.has_program and not self.without_windows

    @property
    def axial_travel(self) -> float:
        """Axial displacement (mm) of a tooth at the major axis towards the closed end; 0 in the
        plane model."""
        if not self.has_cup:
            return 0.0
        middle = self.inner_radius + 0.5 * self.flexible_spline.rim
        height = 0.5 * self.drive.teeth_fs * self.drive.module - middle
        return axial_travel(
            self.deflection, self.cup.length, middle, height, self.wave_generator.lobes
        )

    @property
    def omitted_bending(self) -> float:
        """Share of the bending strain that condensed sectors leave out, at most."""
        wave, sizes = self.wave_generator, (self.inner_radius, self.flexible_spline.rim)
        elliptical = wave.type == "elliptical"
        return omitted_bending(self.deflection, *sizes, self.drive.teeth_fs, wave.lobes, elliptical)

    @property
    def leaves_out_far_teeth(self) -> bool:
        """Whether teeth out of reach are left out; they have mass."""
        return self.solver.far_teeth == "left_out" and self.frequencies is None

    @property
    def condenses_teeth(self) -> bool:
        """Whether a tooth is one element where nothing touches it."""
        return self.leaves_out_far_teeth and self.drive.model != "plane"

    @property
    def leaves_out_sectors(self) -> bool:
        """Whether sectors of the ring gear out of reach are left out; an elastic housing gives way
        all round."""
        clamped = self.kinematics.standing_gear == "ring_gear" and self.housing is None
        return self.leaves_out_far_teeth and clamped

    @property
    def can_condense(self) -> bool:
        """Whether sectors may be condensed: in the plane model, where that leaves out little
        bending strain."""
        return self.drive.model == "plane" and self.omitted_bending <= OMITTED_BENDING

    @property
    def cup_sizes(self) -> CupSizes:
        """Sizes of the cup, which the design must have."""
        return CupSizes(
            self.cup, self.inner_radius, self.flexible_spline.rim, 0.5 * self.drive.face_width
        )

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

    @property
    def crowning(self) -> FlankCrowning:
        """Crowning of the flexible spline's flanks."""
        micro = self.micro_geometry
        return FlankCrowning(micro.fs_crowning, self.drive.face_width, micro.crowning_shape)

    def gear_geometry(self, gear: GearName) -> GearGeometry:
        """Sizes of a gear."""
        return GearGeometry(self.profile(gear), getattr(self, gear).rim, self.axial_range(gear))

    @property
    def geometry(self) -> DriveGeometry:
        """Sizes from which meshes are made. Raises InputError where keys of a profile give no
        flank."""
        drive = self.drive
        return DriveGeometry(
            model=drive.model,
            gears={gear: self.gear_geometry(gear) for gear in self.gears},
            module=drive.module,
            face_width=drive.face_width,
            cam_width=self.wave_generator.width,
            inner_radius=self.inner_radius,
            crowning=self.crowning,
            cup=self.cup_sizes.geometry if self.has_cup else None,
            housing=self.housing.thickness if self.housing else 0.0,
        )

    def teeth(self, gear: GearName) -> Teeth:
        """Number and sizes of the teeth of a gear."""
        return self.drive.teeth(gear, getattr(self, gear))

    def profile(self, gear: GearName, *, relief: bool = True) -> ToothProfile:
        """Exact flank, with its tip relief or before it. Raises InputError where there is none."""
        section: ExternalGear | InternalGear = getattr(self, gear)
        partner, path = None, None
        if isinstance(section.profile, SShaped):
            path = self.rack_path()
        if isinstance(section.profile, Conjugate):
            other = self.profile(GEARS[1 - GEARS.index(gear)], relief=False)
            partner = other, self.tooth_motion(section.profile.section)
        keys = section.profile, self.teeth(gear), section.c_P, section.c_l
        flank, height = make_profile(*keys, gear, partner, path), section.tip_relief_height
        amount = section.tip_relief if relief else 0.0
        return relieved(flank, amount, height * self.drive.module, gear)

    def tooth_motion(self, z: float = 0.0, ring: GearName = "ring_gear") -> ToothMotion:
        """Motion of the flexible spline's tooth in its slot of `ring` at the section z, mm, of the
        rigid limit."""
        inner, axes = self.inner_radius, (self.major_semi_axis, self.minor_semi_axis)
        radius, share = inner + 0.5 * self.flexible_spline.rim, 1.0
        if self.has_cup:
            # the deflection of a cup grows linearly from the closed end, whose middle stays plane
            share = (self.cup_sizes.rest_plane - z) / self.cup_sizes.rest_plane
        line = neutral_line(self.wave_generator, *axes, inner, radius, share)
        return ToothMotion(line, self.drive.teeth_fs, self.teeth(ring).n_teeth)

    def rack_path(self) -> RackPath:
        """Path of the flexible spline's tooth in its slot of the ring gear, of racks in their
        place."""
        drive = self.drive
        apart = 0.5 * drive.module * (drive.teeth_rg - drive.teeth_fs)
        return RackPath(drive.module, self.wave_generator.lobes, apart, 0.5 * self.deflection)

    def rigid_teeth(self, ring: GearName = "ring_gear") -> RigidTeeth:
        """Undeformed teeth of the flexible spline and of a ring gear at mid-width."""
        profiles = self.profile("flexible_spline"), self.profile(ring)
        drive, motion = self.drive, self.tooth_motion(ring=ring)
        lobes = self.wave_generator.lobes
        return RigidTeeth(*profiles, motion, lobes, drive.teeth_fs, drive.module)

    def cam(self) -> Cam:
        """Exact curve of the cam, major axis along +y. Raises InputError where its keys give no
        closed curve."""
        return make_cam(self.wave_generator, self.major_semi_axis, self.minor_semi_axis)

    def cam_surface(self) -> CamSurface:
        """Surface of the cam with crowning and slope."""
        micro = self.micro_geometry
        modified = micro.wg_crowning, micro.wg_slope, micro.crowning_shape
        return cam_surface(self.wave_generator, self.cam(), *modified)
