"""The validated design of a drive: its sections and the quantities derived from them (section
3.2)."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from swgpar.design.cup_section import Cup
from swgpar.design.deviations import Deviations
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
from swgpar.geometry.cams import Bearing, Cam, FourRoller, WaveGenerator, make_cam
from swgpar.geometry.cup_wall import CupWall, rounded_lines
from swgpar.geometry.drive_geometry import CupGeometry, DriveGeometry, FlankCrowning, GearGeometry
from swgpar.geometry.micro_geometry import WaveGeneratorSurface
from swgpar.geometry.neutral_line import NeutralLine, neutral_line
from swgpar.geometry.profiles import (
    Conjugate,
    RackInvolute,
    Teeth,
    ToothMotion,
    ToothProfile,
    make_profile,
)
from swgpar.geometry.profiles.rigid_teeth import RigidTeeth
from swgpar.input.design import Design
from swgpar.materials import ChosenMaterial, Material


@lru_cache(maxsize=16)
def _line(
    keys: WaveGenerator, a: float, b: float | None, inner_radius: float, radius: float, share: float
) -> NeutralLine:
    """Neutral line on the cam of these keys; kept, because a design asks for its profiles again and
    again."""
    return neutral_line(make_cam(keys, a, b), inner_radius, radius, share, keys.lobes)


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

    @property
    def gears(self) -> tuple[GearName, ...]:
        """The gears in the order of the bodies; the dynamic spline of a pancake drive is the third
        one."""
        return GEARS if self.dynamic_spline is None else (*GEARS, "dynamic_spline")

    def axial_range(self, gear: GearName) -> tuple[float, float]:
        """Ends (mm) of the teeth of a gear along z."""
        half, second = 0.5 * self.drive.face_width, self.dynamic_spline
        if second is None or gear == "flexible_spline":
            return -half, half
        width = second.face_width or 0.5 * (self.drive.face_width - second.gap)
        return (
            (half - width, half) if gear == "dynamic_spline" else (-half, half - width - second.gap)
        )

    def rim_radius(self, ring: GearName) -> float:
        """Outer radius (mm) of a ring gear, without a housing."""
        section: InternalGear | DynamicSpline = getattr(self, ring)
        return self.profile(ring).r_root_circle + section.rim

    @property
    def deflection(self) -> float:
        """Diametral deflection d, mm: twice the radial one at a lobe, for any number of lobes."""
        return self.drive.module * (self.drive.teeth_rg - self.drive.teeth_fs)

    @property
    def lobes(self) -> int:
        """Lobes of the wave generator, 2 or 3."""
        return self.wave_generator.lobes

    @property
    def inner_radius(self) -> float:
        """Inner radius r_fs of the undeformed flexible spline, mm (eq. 3.1); a profile shift moves
        the root circle."""
        g, profile = self.drive, self.flexible_spline.profile
        shift = profile.shift if isinstance(profile, RackInvolute) else 0.0
        return (0.5 * g.teeth_fs - g.dedendum_coef + shift) * g.module - self.flexible_spline.rim

    @property
    def major_semi_axis(self) -> float:
        """Major semi-axis a of the wave generator, mm (eq. 3.3)."""
        return self.inner_radius + 0.5 * self.deflection

    @property
    def minor_semi_axis(self) -> float | None:
        """Minor semi-axis b of the wave generator, mm (eqs 3.2, 3.4); None for rollers, which have
        none."""
        wave = self.wave_generator
        return (
            None
            if isinstance(wave, FourRoller)
            else wave.C * (self.inner_radius - 0.5 * self.deflection)
        )

    @property
    def wave_generator_is_fixed(self) -> bool:
        """Whether the ring gear is the input. Everything is then computed in the frame of the ring
        gear."""
        return self.drive.layout == "wave_generator_fixed"

    @property
    def output_gear(self) -> GearName:
        """The gear that is the output; the other one stands in the frame in which the drive is
        computed."""
        if self.drive.layout == "spline_fixed":
            return "ring_gear"
        return "flexible_spline" if self.dynamic_spline is None else "dynamic_spline"

    @property
    def standing_gear(self) -> GearName:
        """The gear that stands in the frame in which the drive is computed: the fixed one, or the
        driven ring gear."""
        if self.output_gear != "ring_gear":
            return "ring_gear"
        return "flexible_spline" if self.dynamic_spline is None else "dynamic_spline"

    @property
    def ratio(self) -> float:
        """Speed ratio, wave generator over output, both against the standing gear."""
        g = self.drive
        return (g.teeth_rg if self.output_gear == "ring_gear" else -g.teeth_fs) / (
            g.teeth_rg - g.teeth_fs
        )

    @property
    def input_ratio(self) -> float:
        """Speed ratio of the drive, input over output."""
        return (
            self.drive.teeth_fs / self.drive.teeth_rg
            if self.wave_generator_is_fixed
            else self.ratio
        )

    def in_frame_of_result(self, angle: float, wave_generator: float) -> float:
        """Angle in the frame of the fixed member, from that in the frame in which the drive is
        computed.

        wave_generator : its angle against the standing gear, in the unit of the angle
        """
        return angle - wave_generator if self.wave_generator_is_fixed else angle

    @property
    def period_angle(self) -> float:
        """Period of the motion, rad of the wave generator against the standing gear: one pitch
        angle of that gear."""
        return 2.0 * np.pi / self.teeth(self.standing_gear).n_teeth

    @property
    def has_program(self) -> bool:
        """Whether the output follows a load program, in place of one torque and a rotation of the
        wave generator."""
        return bool(self.load.program or self.stiffness or self.ratcheting)

    @property
    def is_mirror_symmetric(self) -> bool:
        """Whether the undeformed drive is its own image in the plane through the axis and the major
        axis.

        The balls of a bearing are placed on one side of it or the other. With bolts no other state
        mirrors it.
        """
        return (
            self.wave_generator.type != "asymmetric_parabolic"
            and self.bearing is None
            and not self.is_bolted
        )

    @property
    def has_cup(self) -> bool:
        """Whether the flexible spline has a wall and an end; the plane model leaves out the cup of
        its section."""
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
        """How many times the model makes the whole drive.

        The number of lobes where the drive equals itself rotated by one of them and the design
        allows it, else 1.
        """
        counts = [self.drive.teeth_fs, self.drive.teeth_rg]
        if self.bearing is not None:
            counts.append(self.bearing.balls)
        if self.is_bolted:
            counts.append(self.cup.bolts)
        symmetric = all(count % self.lobes == 0 for count in counts)
        return self.lobes if symmetric and self.solver.symmetry else 1

    @property
    def periods(self) -> int:
        """Periods that are computed with `steps.samples`: two with friction, whose state settles in
        the first."""
        return 2 if self.contact.friction else 1

    @property
    def backlash(self) -> float:
        """Circumferential backlash at the pitch circles, mm (eqs 6.1 to 6.3): the pitch less both
        teeth."""
        thickness = [self.profile(gear).thickness(self.teeth(gear).r_pitch) for gear in GEARS]
        return float(np.pi * self.drive.module - sum(thickness))

    @property
    def dynamic_backlash(self) -> float:
        """Circumferential backlash of the dynamic spline, mm: its pitch less both teeth; 0 without
        one."""
        if self.dynamic_spline is None:
            return 0.0
        second = self.teeth("dynamic_spline")
        space = np.pi * second.module - self.profile("dynamic_spline").thickness(second.r_pitch)
        return float(
            space - self.profile("flexible_spline").thickness(self.teeth("flexible_spline").r_pitch)
        )

    @property
    def backlash_angle(self) -> float:
        """Rotation gamma of the flexible spline that closes the backlash on one side, rad (eq.
        6.4)."""
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
    def ring_outer_radius(self) -> float:
        """Outer radius of the ring gear, mm, without a housing."""
        return self.rim_radius("ring_gear")

    @property
    def outer_radius(self) -> float:
        """Outer radius of the ring gear, mm, or of its housing."""
        return self.ring_outer_radius + (self.housing.thickness if self.housing else 0.0)

    @property
    def largest_radius(self) -> float:
        """Largest radius of any part of the drive, mm: ring gears, housing, wall and flange."""
        radii = [self.outer_radius]
        if self.dynamic_spline is not None:
            radii.append(self.rim_radius("dynamic_spline"))
        if self.has_cup:
            radii += [
                self.cup.edge,
                *(inner + thickness for _, inner, thickness, _ in self.wall_points),
            ]
        return max(radii)

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
        return self.bearing_sizes.rolling_speed(
            0.0 if self.output_gear == "ring_gear" else 1.0 / self.ratio
        )

    @property
    def ball_passing_angle(self) -> float:
        """Rotation (rad) of the wave generator after which a ball takes the place of the one before
        it on the cam.

        inf where the balls are fixed to the cam.
        """
        slip = abs(1.0 - self.cage_speed)
        return 2.0 * np.pi / self.bearing.balls / slip if slip > 1e-9 else np.inf

    @property
    def uses_pins(self) -> bool:
        """Whether pins deflect the flexible spline; with a bearing the cam grows instead."""
        return self.steps.pins and self.bearing is None

    @property
    def resolves_root_stress(self) -> bool:
        """Whether windows resolve the stress at the teeth: with one loaded state, on a cam without
        a bearing, and one ring gear."""
        simple = self.bearing is None and self.dynamic_spline is None
        return self.output.root_stress and not self.has_program and simple

    @property
    def axial_travel(self) -> float:
        """Axial displacement (mm) of a tooth at the major axis towards the closed end; 0 in the
        plane model.

        The cup is taken as a wall that bends without extension, with a radial deflection d / 2 cos
        n phi that grows linearly from the closed end, n lobes. Such a wall moves axially by r d /
        (2 n² L) (Love's inextensional mode), and the tooth leans by d / (2 L).
        """
        middle = self.inner_radius + 0.5 * self.flexible_spline.rim
        height = 0.5 * self.drive.teeth_fs * self.drive.module - middle
        return (
            0.5 * self.deflection / self.cup.length * (middle / self.lobes**2 + height)
            if self.has_cup
            else 0.0
        )

    @property
    def omitted_bending(self) -> float:
        """Share of the bending strain that the plane model's condensed sectors leave out, at most.

        The change of the rim's curvature rotates the ends of a sector, a pitch apart, by theta
        relative to each other. The strain left out is theta^2 / 8, here divided by the bending
        strain. With n lobes the curvature changes by (n^2 - 1) d / (2 r^2) on a cam that the rim
        follows all around, as an ellipse. A ring that touches at its major axis only bends 1.4
        times as much there, on rollers 70 degrees apart 2.9 times: 3 covers both.
        """
        factor = 1.0 if self.wave_generator.type == "elliptical" else 3.0
        curvature = factor * 0.5 * (self.lobes**2 - 1) * self.deflection / self.inner_radius**2
        pitch = 2.0 * np.pi * self.inner_radius / self.drive.teeth_fs
        return (curvature * pitch) ** 2 / 8.0 / (0.5 * self.flexible_spline.rim * curvature)

    @property
    def can_condense(self) -> bool:
        """Whether sectors may be condensed: in the plane model, where that leaves out little
        bending strain."""
        return self.drive.model == "plane" and self.omitted_bending <= OMITTED_BENDING

    @property
    def cup_thickness(self) -> float:
        """Thickness (mm) of the cup's wall at the back of the teeth; that of the rim in the plane
        model without cup."""
        return (self.cup.thickness_coef if self.has_cup else 1.0) * self.flexible_spline.rim

    @property
    def wall_points(self) -> list[tuple[float, float, float, float]]:
        """Points of the cup's wall: distance from the back of the teeth, inner radius, thickness
        and rounding, mm."""
        cup = self.cup
        points = [(0.0, self.inner_radius, self.cup_thickness, 0.0)]
        points += [
            (p.distance, p.radius or self.inner_radius, p.thickness, p.rounding)
            for p in cup.contour
        ]
        (last, radius, thickness, _), length = points[-1], cup.length - cup.fillet_radius
        return points if last >= length else [*points, (length, radius, thickness, 0.0)]

    @property
    def cup_wall(self) -> CupWall:
        """Section of the wall of the cup, which the design must have."""
        cup, back = self.cup, 0.5 * self.drive.face_width
        inner, outer = rounded_lines(self.wall_points)
        return CupWall(
            inner=inner,
            outer=outer,
            back=back,
            end=back + cup.length,
            fillet=cup.fillet_radius,
            end_thickness=self.end_thickness,
            edge=cup.edge,
            outwards=cup.shape == "hat",
        )

    @property
    def end_thickness(self) -> float:
        """Thickness of the closed end or flange, mm."""
        return self.cup.end_thickness or self.wall_points[-1][2]

    @property
    def rest_plane(self) -> float:
        """z (mm) at which the deflection vanishes: the middle of the closed end or flange; 0 in the
        plane model."""
        return (
            0.5 * self.drive.face_width + self.cup.length - 0.5 * self.end_thickness
            if self.has_cup
            else 0.0
        )

    def material_of(self, body: DesignBody) -> Material:
        """Material of a body of the design: that of its own section, else [material]."""
        section = {"housing": self.housing, "bearing": self.bearing}.get(body) or getattr(
            self, body
        )
        return section.material or self.material

    def modulus_of(self, *bodies: DesignBody) -> float:
        """Modulus of elasticity (MPa) of the softest of bodies: the scale of contacts and supports
        between them."""
        return min(self.material_of(body).modulus for body in bodies)

    def penalty(self, *bodies: DesignBody) -> float:
        """Penalty of the contact of flanks of two bodies, or of the support of one, MPa / mm."""
        return self.contact.penalty_coef * self.modulus_of(*bodies) / self.drive.module

    @property
    def wg_penalty(self) -> float:
        """Penalty of the contact of cam and pins, MPa / mm."""
        return self.contact.wg_penalty_coef * self.modulus_of("flexible_spline") / self.drive.module

    @property
    def materials(self) -> dict[str, Material]:
        """Materials of the gears, and of the housing if there is one, by name."""
        bodies: tuple[DesignBody, ...] = (
            self.gears if self.housing is None else (*self.gears, "housing")
        )
        return {body: self.material_of(body) for body in bodies}

    @property
    def crowning(self) -> FlankCrowning:
        """Crowning of the flexible spline's flanks."""
        micro = self.micro_geometry
        return FlankCrowning(micro.fs_crowning, self.drive.face_width, micro.crowning_shape)

    @property
    def geometry(self) -> DriveGeometry:
        """Sizes from which meshes are made. Raises InputError where keys of a profile give no
        flank."""
        drive, cup = self.drive, None
        if self.has_cup:
            section = self.cup
            cup = CupGeometry(
                self.cup_wall, section.thickness_coef, section.back_fillet, section.clamping_radius
            )
        return DriveGeometry(
            model=drive.model,
            gears={
                gear: GearGeometry(
                    self.profile(gear), getattr(self, gear).rim, self.axial_range(gear)
                )
                for gear in self.gears
            },
            module=drive.module,
            face_width=drive.face_width,
            cam_width=self.wave_generator.face_width,
            inner_radius=self.inner_radius,
            crowning=self.crowning,
            cup=cup,
            housing=self.housing.thickness if self.housing else 0.0,
        )

    def teeth(self, gear: GearName) -> Teeth:
        """Number and sizes of the teeth of a gear.

        The dynamic spline has the teeth of the flexible spline on the pitch circle of the ring
        gear, where these mesh at the major axis: its module is larger.
        """
        drive, external = self.drive, gear == "flexible_spline"
        wider = drive.teeth_rg / drive.teeth_fs if gear == "dynamic_spline" else 1.0
        return Teeth(
            n_teeth=drive.teeth_rg if gear == "ring_gear" else drive.teeth_fs,
            module=drive.module * wider,
            pressure_angle=float(np.radians(drive.pressure_angle)),
            addendum=drive.addendum_coef * drive.module,
            dedendum=drive.dedendum_coef * drive.module,
            external=external,
        )

    def profile(self, gear: GearName) -> ToothProfile:
        """Exact flank of a gear. Raises InputError where its keys give no flank."""
        section: ExternalGear | InternalGear = getattr(self, gear)
        partner = None
        if isinstance(section.profile, Conjugate):
            other = GEARS[1 - GEARS.index(gear)]
            partner = self.profile(other), self.tooth_motion(section.profile.section)
        return make_profile(
            section.profile, self.teeth(gear), section.c_P, section.c_l, gear, partner
        )

    def tooth_motion(self, z: float = 0.0, ring: GearName = "ring_gear") -> ToothMotion:
        """Motion of the flexible spline's tooth in its slot of `ring` at the section z, mm, of the
        rigid limit."""
        radius = self.inner_radius + 0.5 * self.flexible_spline.rim
        share = 1.0
        if self.has_cup:
            # the deflection of a cup grows linearly from the closed end, whose middle stays plane
            share = (self.rest_plane - z) / self.rest_plane
        line = _line(
            self.wave_generator,
            self.major_semi_axis,
            self.minor_semi_axis,
            self.inner_radius,
            radius,
            share,
        )
        return ToothMotion(line, self.drive.teeth_fs, self.teeth(ring).n_teeth)

    def rigid_teeth(self, ring: GearName = "ring_gear") -> RigidTeeth:
        """Undeformed teeth of the flexible spline and of a ring gear at mid-width."""
        profiles, motion = (
            (self.profile("flexible_spline"), self.profile(ring)),
            self.tooth_motion(ring=ring),
        )
        return RigidTeeth(*profiles, motion, self.lobes, self.drive.teeth_fs, self.drive.module)

    def cam(self) -> Cam:
        """Exact curve of the cam, major axis along +y. Raises InputError where its keys give no
        closed curve."""
        return make_cam(self.wave_generator, self.major_semi_axis, self.minor_semi_axis)

    def cam_surface(self) -> WaveGeneratorSurface:
        """Surface of the cam with crowning and slope."""
        micro = self.micro_geometry
        return WaveGeneratorSurface(
            self.cam(),
            self.wave_generator.face_width,
            micro.wg_crowning,
            micro.wg_slope,
            micro.crowning_shape,
            self.lobes,
        )
