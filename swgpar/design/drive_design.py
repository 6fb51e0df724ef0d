"""The validated design of a drive: its sections, and the sizes and growths derived from them
(section 3.2)."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from swgpar.design.cup_sizes import CupSizes
from swgpar.design.drive_sections import DriveSections
from swgpar.design.negligible_torque import negligible_torque
from swgpar.design.sections import SECTIONS, ExternalGear, GearName, InternalGear
from swgpar.geometry.bearing import BallLines, BearingSizes, RigidParts, ball_lines
from swgpar.geometry.cams import Cam, OffsetCam, make_cam
from swgpar.geometry.cams.semi_axes import minor_semi_axis, radial_deflection
from swgpar.geometry.disc_surface import CamSurface, GrownSurface, cam_surface
from swgpar.geometry.micro_geometry import FlankCrowning
from swgpar.geometry.neutral_line import neutral_line
from swgpar.geometry.rim_inertia import RimInertia
from swgpar.geometry.rim_motion import axial_travel, omitted_bending
from swgpar.materials import NO_GROWTH, Growth
from swgpar.meshing.drive_geometry import DriveGeometry, GearGeometry
from swgpar.profiles import (
    Conjugate,
    RackInvolute,
    RackPath,
    SShaped,
    ToothMotion,
    ToothProfile,
    make_profile,
)
from swgpar.profiles.rigid_teeth import RigidTeeth
from swgpar.profiles.tip_relief import relieved

OMITTED_BENDING = 0.01
"""Largest share of the bending strain that condensed sectors may leave out."""

SOLVER_CHOICES = {
    "linear",
    "keep_factor",
    "far_teeth",
    "iteration_limit",
    "time_limit",
    "memory_limit",
}
"""Keys of [solver] that a restart may change: they are about how systems are solved, and limits."""


OF_STATES = (
    "steps",
    "stiffness",
    "input_coupling",
    "ratcheting",
    "output",
    "fatigue",
    "losses",
    "deviations",
    "frequencies",
    "rating",
)
"""Sections that say which states are computed and what is asked of them. Of deviations and
frequencies only whether they are there changes the model."""


class DriveDesign(DriveSections):
    """A drive, its load and how it is computed. Attributes are the keys of the design file."""

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
    def bearing_sizes(self) -> BearingSizes:
        """Sizes of the bearing, which the design must have."""
        return BearingSizes(
            self.inner_radius, self.bearing.race_thickness, self.bearing.ball_diameter
        )

    @property
    def cage_speed(self) -> float:
        """Speed of the cage over that of the wave generator in the rotation that is computed.

        With `steps.samples` the balls go on by whole passings in a period of the teeth, so that the
        drive repeats after it.
        """
        if not self.steps.samples:
            return self.rolling_speed
        kinematics = self.kinematics
        passings = kinematics.ball_passings(self.steps.samples)
        return 1.0 + passings * 2.0 * np.pi / self.bearing.balls / kinematics.period_angle

    @property
    def rolling_speed(self) -> float:
        """Speed of the cage over that of the wave generator: the key, or that of balls that roll on
        a race that rotates with the flexible spline."""
        if self.bearing.cage_speed is not None:
            return self.bearing.cage_speed
        return self.bearing_sizes.rolling_speed(self.kinematics.spline_speed)

    @property
    def negligible_torque(self) -> float:
        """Output torque (N·mm) up to which the drive counts as unloaded."""
        rim = self.flexible_spline.rim
        sizes = self.drive.face_width, rim, self.inner_radius + 0.5 * rim
        return negligible_torque(self.modulus_of("flexible_spline"), self.deflection, *sizes)

    @property
    def negligible_torque_Nm(self) -> float:
        """The same in N·m."""
        return 1e-3 * self.negligible_torque

    @property
    def speeds(self) -> tuple[float, float]:
        """Speeds (rad/s) of flexible spline and wave generator in space at `load.input_speed`."""
        spline, wave = self.kinematics.speeds_in_space
        return self.load.input_rate * spline, self.load.input_rate * wave

    @property
    def rim_inertia(self) -> RimInertia | None:
        """The rim of the flexible spline with half of the mass of full teeth; None without a
        density.

        The wall of a cup is left out: it makes the rim stiffer, and the speeds higher.
        """
        material, teeth = self.materials["flexible_spline"], self.teeth("flexible_spline")
        if material.density is None:
            return None
        rim = self.flexible_spline.rim
        return RimInertia(
            radius=self.inner_radius + 0.5 * rim,
            thickness=rim,
            mass_thickness=rim + 0.5 * (teeth.addendum + teeth.dedendum),
            modulus=material.modulus,
            density=material.density,
            lobes=self.wave_generator.lobes,
            amplitude=0.5 * self.deflection,
        )

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

    def crowning(self, gear: GearName) -> FlankCrowning:
        """Crowning of the flanks of a gear."""
        micro, (low, high) = self.micro_geometry, self.axial_range(gear)
        amount = micro.flank_crowning(gear)
        return FlankCrowning(amount, high - low, micro.crowning_shape, 0.5 * (low + high))

    def gear_geometry(self, gear: GearName) -> GearGeometry:
        """Sizes of a gear."""
        rim, ends = getattr(self, gear).rim, self.axial_range(gear)
        return GearGeometry(self.profile(gear), rim, ends, self.crowning(gear))

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
            cup=self.cup_sizes.geometry if self.has_cup else None,
            housing=self.housing.thickness if self.housing else 0.0,
        )

    def profile(self, gear: GearName, *, relief: bool = True) -> ToothProfile:
        """Exact flank, with its tip relief or before it. Raises InputError where there is none."""
        section: ExternalGear | InternalGear = getattr(self, gear)
        partner, path = None, None
        if isinstance(section.profile, SShaped):
            path = self.rack_path()
        if isinstance(section.profile, Conjugate):
            # the flexible spline's is that to the ring gear
            ring: GearName = "ring_gear" if gear == "flexible_spline" else gear
            other = self.profile(
                ring if gear == "flexible_spline" else "flexible_spline", relief=False
            )
            partner = other, self.tooth_motion(section.profile.section, ring)
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
        return RigidTeeth(*profiles, self.tooth_motion(ring=ring), self.drive.module)

    @property
    def rigid_pairs(self) -> dict[GearName, RigidTeeth]:
        """`rigid_teeth` of every ring gear, by its name."""
        return {ring: self.rigid_teeth(ring) for ring in self.gears[1:]}

    def cam(self) -> Cam:
        """Exact curve of the cam, major axis along +y. Raises InputError where its keys give no
        closed curve."""
        return make_cam(self.wave_generator, self.major_semi_axis, self.minor_semi_axis)

    def cam_surface(self) -> CamSurface:
        """Surface of the cam with crowning and slope."""
        micro = self.micro_geometry
        modified = micro.wg_crowning, micro.wg_slope, micro.crowning_shape
        return cam_surface(self.wave_generator, self.cam(), *modified)

    @property
    def growths(self) -> dict[str, Growth]:
        """Growth without stress of the gears, of the housing and of the bearing, by the names of
        `materials`.

        A body of one material at one temperature grows alike everywhere. What it touches or is
        bonded to makes the stress. An interference is a smaller bore: the housing, were it free,
        would be smaller across the axis by the interference over the diameter of the fit. A check
        has refused temperatures of materials whose expansion is not known.
        """
        rises, every = self.temperature_rises, {}
        for body, material in self.materials.items():
            every[body] = material.thermal_growth(rises[SECTIONS.get(body, body)]) or NO_GROWTH
        if self.housing is not None:
            fit = 2.0 * self.geometry.gears["ring_gear"].outer_radius
            every["housing"] += Growth(across=-self.housing.interference / fit)
        return every

    @property
    def frame_growth(self) -> Growth:
        """Growth of the bore of the rigid frame; an interference makes it smaller."""
        frame = self.ring_gear.frame
        thermal = (frame.expansion or 0.0) * self.temperature_rises["ring_gear.frame"]
        fit = Growth(across=-frame.interference / (2.0 * self.geometry.outer_radius))
        return Growth(thermal, thermal) + fit

    def grown_cam_surface(self) -> CamSurface | GrownSurface:
        """Surface of the cam at its temperature."""
        strain, surface = self.cam_strain, self.cam_surface()
        return GrownSurface(surface, strain) if strain else surface

    def grown_ball_lines(self) -> BallLines:
        """Places of the balls on the cam at its temperature."""
        lines = partial(ball_lines, self.cam(), self.bearing_sizes.centre_depth)
        factor = 1.0 + self.cam_strain

        def grown(angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            centre, normal, curvature = lines(angle)
            return factor * centre, normal, curvature / factor

        return grown

    @property
    def rigid_parts(self) -> RigidParts:
        """The cam, and the balls on it at its temperature."""
        width, sizes = self.wave_generator.face_width, self.bearing
        if sizes is None:
            return RigidParts(self.cam(), width)
        groove = OffsetCam(self.cam(), -(sizes.race_thickness + sizes.ball_diameter))
        return RigidParts(groove, width, self.grown_ball_lines(), sizes.ball_diameter)

    @property
    def ball_clearance(self) -> float:
        """Clearance (mm) of a ball with the outer race at its temperature.

        Half of what a ball grows by moves its centre off the inner race. `grown_ball_lines` has
        moved the centre by what half a ball would grow by as the cam.
        """
        strain = self.growths["bearing"].across - 0.5 * self.cam_strain
        return self.bearing.clearance - strain * self.bearing.ball_diameter

    @property
    def decisive_keys(self) -> dict[str, Any]:
        """The keys that determine results, by section: without the output, the rating, the
        rotation, whose angles are compared one by one, and how systems are solved."""
        content = self.model_dump(
            exclude={
                "output": True,
                "rating": True,
                "steps": {"rotation", "samples"},
                "solver": SOLVER_CHOICES,
            }
        )
        if self.bearing is not None:
            content["cage_speed"] = self.cage_speed  # follows from steps.samples
        return content

    @property
    def model_keys(self) -> dict[str, Any]:
        """The keys that determine the model on a mesh, by section: without the load, and without
        what is asked of the states under it."""
        load = set() if self.load.inertia else {"input_speed"}
        content = self.model_dump(
            exclude={
                **dict.fromkeys(OF_STATES, True),
                "load": {"torque", "program", *load},
                "solver": {"iteration_limit", "time_limit"},
            }
        )
        content["deviates"] = self.deviations is not None
        return content

    @property
    def modelled_part(self) -> tuple[int, bool, bool, float]:
        """What of the drive the model has: copies that make the whole of it, whether teeth out of
        reach are left out or one element each, and the speed of the cage, which moves the balls
        where the wave generator has turned."""
        cage = 0.0 if self.bearing is None else self.cage_speed
        return self.copies, self.leaves_out_far_teeth, self.condenses_teeth, cage
