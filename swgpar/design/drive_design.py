"""The validated design file: every key with its unit and range, and the derived geometry (section 3.2)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.cams import FourRoller, WaveGenerator, make_cam
from swgpar.geometry.profiles import ExternalProfile, InternalProfile, RackInvolute, make_profile
from swgpar.input.quantities import Section, quantity
from swgpar.input.toml_file import apply_overrides, read_toml, validate


class Drive(Section):
    layout: Literal["ring_fixed", "spline_fixed"] = quantity(
        "ring_fixed", text="fixed member; the other gear is the output"
    )
    model: Literal["cup", "plane"] = quantity("cup", text="the cup drive, or the toothed section in plane stress")
    teeth_fs: int = quantity(text="teeth of the flexible spline", ge=8, le=2000)
    teeth_rg: int = quantity(text="teeth of the ring gear", ge=10, le=2002)
    module: float = quantity(unit="mm", text="module", gt=0.0)
    pressure_angle: float = quantity(20.0, unit="deg", text="pressure angle", gt=0.0, lt=45.0)
    addendum_coef: float = quantity(unit="modules", text="addendum", gt=0.0, le=2.0)
    dedendum_coef: float = quantity(unit="modules", text="dedendum", gt=0.0, le=2.0)
    face_width: float = quantity(unit="mm", text="face width", gt=0.0)


class Gear(Section):
    rim: float = quantity(unit="mm", text="rim thickness below the root circle", gt=0.0)
    c_P: float = quantity(1.0, text="angular tooth thickness reduction; 1 for involutes", gt=0.0, le=1.2)
    c_l: float = quantity(0.5, text="place of the pitch point on the straight segment", ge=0.0, le=1.0)


class ExternalGear(Gear):
    profile: ExternalProfile


class InternalGear(Gear):
    profile: InternalProfile


class Cup(Section):
    length: float = quantity(unit="mm", text="from the back of the teeth to the closed end", gt=0.0)
    thickness_coef: float = quantity(0.8, text="cup thickness over rim thickness", ge=0.1, le=0.95)
    fillet_radius: float = quantity(unit="mm", text="outer fillet radius", gt=0.0)
    inner_radius: float = quantity(unit="mm", text="bore radius of the closed end", gt=0.0)


class MicroGeometry(Section):
    wg_crowning: float = quantity(0.0, unit="mm", text="crowning of the cam at its edges", ge=0.0)
    wg_slope: float = quantity(
        0.0, unit="mm", text="slope of the cam: radial -s (2z/F_w) cos 2 theta; s > 0 follows the cone of the cup"
    )
    fs_crowning: float = quantity(0.0, unit="mm", text="crowning of the flexible spline's flanks at their ends", ge=0.0)
    crowning_shape: Literal["parabolic", "circular"] = quantity("parabolic", text="curve of the crowning")


class Material(Section):
    E: float = quantity(unit="MPa", text="modulus of elasticity", gt=0.0)
    nu: float = quantity(text="Poisson's ratio", ge=0.0, le=0.499)


class Load(Section):
    torque: float = quantity(0.0, unit="N·m", text="output torque, against the output's motion", ge=0.0)


class Contact(Section):
    friction: float = quantity(0.0, text="coefficient of friction between the flanks", ge=0.0, le=1.0)
    penalty_coef: float = quantity(50.0, text="penalty of the flanks over E / module", gt=0.0)
    wg_penalty_coef: float = quantity(5.0, text="penalty of cam and pins over E / module", gt=0.0)
    quadrature: int = quantity(2, text="Gauss points per direction on segments of flank faces", ge=1, le=16)
    wg_quadrature: int = quantity(3, text="Gauss points per direction on the inner surface", ge=1, le=16)
    max_augmentations: int = quantity(3, text="largest number of augmentations per increment", ge=0, le=50)
    penetration_tolerance: float = quantity(
        1e-3, unit="modules", text="penetration that needs no augmentation", gt=0.0, le=0.1
    )


class Steps(Section):
    rotation: float = quantity(45.0, unit="deg", text="rotation of the wave generator", ge=0.0, le=36000.0)
    increment: float = quantity(5.0, unit="deg", text="increment of that rotation", ge=0.01, le=45.0)
    pins: bool = quantity(True, text="deflect the spline by pins before the cam is there; false: by the growing cam")
    deflect_increments: int = quantity(1, text="increments of the deflection (step 1)", ge=1, le=1000)
    engage_increments: int = quantity(1, text="increments of the engagement", ge=1, le=1000)
    load_increments: int = quantity(1, text="increments of the torque", ge=1, le=1000)
    samples: int = quantity(
        0,
        text="angles computed in one period and continued by symmetry, instead of increments; 0: off",
        ge=0,
        le=1000,
    )
    start_levels: int = quantity(
        0, text="coarser meshes on which the drive is assembled and loaded (steps 1 to 3); 0: off", ge=0, le=4
    )


class Solver(Section):
    linear: Literal["direct", "iterative"] = quantity("direct", text="linear solver: MUMPS, or GMRES with GAMG")
    rtol: float = quantity(1e-9, text="residual over contact force at convergence", gt=0.0, le=1e-3)
    max_iterations: int = quantity(
        25, text="Newton iterations before a cut-back, unless the residual falls", ge=1, le=1000
    )
    max_cutbacks: int = quantity(5, text="halvings of an increment before the run ends", ge=0, le=20)
    twofold_symmetry: bool = quantity(True, text="model half of the drive when tooth numbers allow it")
    far_teeth: Literal["left_out", "modelled"] = quantity(
        "left_out", text="ring-gear sectors out of reach of the flexible spline, with the ring gear fixed"
    )
    condensed_sectors: bool = quantity(False, text="plane model: eliminate the inside of tooth sectors")
    keep_factor: bool = quantity(True, text="cup drive: use factors for later tangents while GMRES converges with them")


class Output(Section):
    fields: bool = quantity(True, text="write fields.h5 and fields.xdmf")
    figures: bool = quantity(True, text="draw the figures")


class DriveDesign(Section):
    """A drive, its load and how it is computed. Attributes are the keys of the design file."""

    drive: Drive
    flexible_spline: ExternalGear
    ring_gear: InternalGear
    wave_generator: WaveGenerator
    cup: Cup | None = None
    micro_geometry: MicroGeometry = MicroGeometry()
    material: Material
    load: Load = Load()
    contact: Contact = Contact()
    steps: Steps = Steps()
    solver: Solver = Solver()
    output: Output = Output()

    @property
    def d(self) -> float:
        """Diametral deflection, mm."""
        return self.drive.module * (self.drive.teeth_rg - self.drive.teeth_fs)

    @property
    def r_fs(self) -> float:
        """Inner radius of the undeformed flexible spline, mm (eq. 3.1); a profile shift moves the root circle."""
        g, profile = self.drive, self.flexible_spline.profile
        shift = profile.shift if isinstance(profile, RackInvolute) else 0.0
        return (0.5 * g.teeth_fs - g.dedendum_coef + shift) * g.module - self.flexible_spline.rim

    @property
    def a(self) -> float:
        """Major semi-axis of the wave generator, mm (eq. 3.3)."""
        return self.r_fs + 0.5 * self.d

    @property
    def b(self) -> float:
        """Minor semi-axis, mm (eqs 3.2, 3.4); rollers have none."""
        return self.wave_generator.C * (self.r_fs - 0.5 * self.d)

    @property
    def ratio(self) -> float:
        """Speed ratio, wave generator over output."""
        g = self.drive
        return (-g.teeth_fs if g.layout == "ring_fixed" else g.teeth_rg) / (g.teeth_rg - g.teeth_fs)

    @property
    def pitch(self) -> float:
        """Period of the motion, rad of the wave generator: one pitch of the fixed gear."""
        return 2.0 * np.pi / (self.drive.teeth_rg if self.drive.layout == "ring_fixed" else self.drive.teeth_fs)

    @property
    def periods(self) -> int:
        """Periods that are computed with `steps.samples`: in the first of two, friction settles."""
        return 2 if self.contact.friction else 1

    @property
    def backlash(self) -> float:
        """Circumferential backlash at the pitch circles, mm (eqs 6.1 to 6.3): the pitch less both teeth."""
        g = self.drive
        teeth = {"flexible_spline": g.teeth_fs, "ring_gear": g.teeth_rg}
        thickness = [make_profile(self, gear).thickness(0.5 * n * g.module) for gear, n in teeth.items()]
        return float(np.pi * g.module - sum(thickness))

    @property
    def gamma(self) -> float:
        """Turn that closes the backlash on one side, rad (eq. 6.4)."""
        return self.backlash / (self.drive.teeth_fs * self.drive.module)

    @property
    def axial_travel(self) -> float:
        """Way (mm) of a tooth at the major axis towards the closed end, on the cone of a cup that bends without strain.

        A wall whose deflection d / 2 cos 2 phi grows from the closed end on moves axially by r d / (8 L) (Love's
        inextensional mode), and the tooth leans by d / (2 L).
        """
        middle = self.r_fs + 0.5 * self.flexible_spline.rim
        height = 0.5 * self.drive.teeth_fs * self.drive.module - middle
        return 0.5 * self.d / self.cup.length * (0.25 * middle + height) if self.cup else 0.0

    @property
    def sector_bend(self) -> float:
        """Share of the bending strain that the plane model's condensed sectors leave out, at most.

        The rim's change of curvature turns the ends of a sector, a pitch apart, by theta against each other: a strain
        of theta^2 / 8 over that of bending. On an elliptical cam the curvature changes by 3 d / (2 r^2); a ring that
        touches at its major axis only bends 1.4 times as much there, on rollers 70 degrees apart 2.9 times.
        """
        sharper = 1.0 if self.wave_generator.type == "elliptical" else 3.0
        curvature, pitch = sharper * 1.5 * self.d / self.r_fs**2, 2.0 * np.pi * self.r_fs / self.drive.teeth_fs
        return (curvature * pitch) ** 2 / 8.0 / (0.5 * self.flexible_spline.rim * curvature)

    @property
    def cup_thickness(self) -> float:
        """mm; the rim's thickness in the plane model, which has no cup."""
        return (self.cup.thickness_coef if self.cup else 1.0) * self.flexible_spline.rim

    @property
    def penalty(self) -> float:
        """Penalty of the flanks' contact, MPa / mm."""
        return self.contact.penalty_coef * self.material.E / self.drive.module

    @property
    def wg_penalty(self) -> float:
        """Penalty of the contact of cam and pins, MPa / mm."""
        return self.contact.wg_penalty_coef * self.material.E / self.drive.module


SECTOR_BEND = 0.01
"""Largest share of the bending strain that condensed sectors may leave out."""

BULGE_POINTS = 2000
"""Points of the cam's outline at which it is checked."""


def _refuse(key: str, value: float, allowed: str) -> None:
    raise InputError(f"{key} = {value:g} is out of range: allowed {allowed}")


def check_fit(design: DriveDesign) -> None:
    """Refuse sizes that do not fit each other, naming the key, the value and what is allowed."""
    g, cup, micro, wave = design.drive, design.cup, design.micro_geometry, design.wave_generator
    difference = g.teeth_rg - g.teeth_fs
    if difference <= 0 or difference % 2:
        raise InputError(
            f"drive.teeth_rg - drive.teeth_fs = {difference} is out of range: allowed a positive multiple of two"
        )
    if g.dedendum_coef <= g.addendum_coef:
        _refuse("drive.dedendum_coef", g.dedendum_coef, f"above {g.addendum_coef:g} (the addendum) to 2 modules")
    if design.r_fs <= design.d:
        _refuse(
            "flexible_spline.rim", design.flexible_spline.rim, "a rim that leaves an inner radius above the deflection"
        )
    if isinstance(wave, FourRoller):
        if wave.beta >= wave.pin_half_angle:
            _refuse("wave_generator.beta", wave.beta, f"above 0 to below {wave.pin_half_angle:g} deg (pin_half_angle)")
    elif design.b < 0.4 * design.r_fs:
        _refuse("wave_generator.C", wave.C, "values whose minor semi-axis is at least 0.4 of the spline's inner radius")
    steps = design.steps
    least = np.degrees(design.pitch) * design.periods
    if steps.samples and steps.rotation < 0.999999 * least:
        _refuse(
            "steps.rotation", steps.rotation, f"{least:.6g} deg (periods: {design.periods}) and more with steps.samples"
        )
    width = g.face_width
    if wave.face_width > width:
        _refuse("wave_generator.face_width", wave.face_width, f"above 0 to {width:g} mm (drive.face_width)")
    if design.contact.friction > 0.0 and design.solver.linear == "iterative":
        raise InputError(
            f'solver.linear = "iterative" is not available with contact.friction = {design.contact.friction:g}: '
            'allowed "direct" with friction'
        )
    if g.model == "plane":
        if design.solver.condensed_sectors and design.sector_bend > SECTOR_BEND:
            raise InputError(
                f"solver.condensed_sectors = true leaves out {design.sector_bend:.2g} of the bending strain: allowed "
                f"up to {SECTOR_BEND:g}, with more teeth or a thicker flexible_spline.rim"
            )
        for key in ("wg_crowning", "wg_slope", "fs_crowning"):
            if getattr(micro, key) != 0.0:
                _refuse(f"micro_geometry.{key}", getattr(micro, key), 'only 0 with drive.model = "plane"')
        return
    if design.solver.condensed_sectors:
        raise InputError('solver.condensed_sectors = true is out of range: allowed only with drive.model = "plane"')
    if cup is None:
        raise InputError('cup is missing: allowed only with drive.model = "plane"')
    if cup.fillet_radius < design.cup_thickness:
        _refuse("cup.fillet_radius", cup.fillet_radius, f"{design.cup_thickness:g} (the cup's thickness) to inf mm")
    if cup.length <= cup.fillet_radius:
        _refuse("cup.length", cup.length, f"above {cup.fillet_radius:g} mm (cup.fillet_radius)")
    # narrower splines leave the ring gear's width (docs/benchmarks/stability.md)
    narrowest = max(design.axial_travel, 0.5 * design.flexible_spline.rim)
    why = "axial travel of the teeth, half of the rim"
    if g.face_width < narrowest:
        _refuse("drive.face_width", g.face_width, f"{narrowest:.4g} mm ({why}) to inf mm")
    outer = design.r_fs + design.cup_thickness
    if cup.inner_radius >= outer - cup.fillet_radius:
        _refuse(
            "cup.inner_radius",
            cup.inner_radius,
            f"above 0 to below {outer - cup.fillet_radius:g} mm (the closed end inside cup.fillet_radius)",
        )
    # beyond a quarter of its width the cam is a cone of some 30 degrees, off which the spline slides
    most = min(0.5 * design.d, 0.25 * wave.face_width)
    why = "half the deflection, a quarter of the cam's width"
    if micro.wg_crowning > most:
        _refuse("micro_geometry.wg_crowning", micro.wg_crowning, f"0 to {most:g} mm ({why})")
    if abs(micro.wg_slope) > most:
        _refuse("micro_geometry.wg_slope", micro.wg_slope, f"-{most:g} to {most:g} mm ({why})")
    if micro.fs_crowning > 0.25 * g.module:
        _refuse(
            "micro_geometry.fs_crowning", micro.fs_crowning, f"0 to {0.25 * g.module:g} mm (a quarter of the module)"
        )


def load_design(path: str | Path, overrides: Sequence[str] = ()) -> DriveDesign:
    """Read and check a design file; every problem is an `InputError` of one sentence."""
    return make_design(apply_overrides(read_toml(path), overrides))


def make_design(table: dict[str, Any]) -> DriveDesign:
    """Check the content of a design file; every problem is an `InputError` of one sentence."""
    design = validate(DriveDesign, table)
    check_fit(design)
    spline, ring = (make_profile(design, gear) for gear in ("flexible_spline", "ring_gear"))
    bulge = float(np.linalg.norm(make_cam(design).outline(BULGE_POINTS), axis=1).max()) - design.a
    clearance = max(ring.r_root_circle - spline.r_tip_circle - 0.5 * design.d, 1e-6 * design.a)
    if bulge > clearance:
        raise InputError(
            f"wave_generator ({design.wave_generator.type}) bulges {bulge:.3g} mm beyond its major semi-axis: "
            f"allowed up to {clearance:.3g} mm, where the flexible spline's teeth meet the ring gear's root circle"
        )
    return design
