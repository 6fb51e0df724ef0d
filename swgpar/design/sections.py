"""The sections of the drive's design file: every key with its unit and allowed range."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np

from swgpar.design.linear_solvers import LINEAR_SOLVERS, LinearSolverName
from swgpar.design.program_sections import ProgramStage
from swgpar.design.surroundings import Frame, Housing
from swgpar.input.quantities import Section, not_negative, positive, quantity
from swgpar.materials import OptionalMaterial
from swgpar.materials.temperature import temperature
from swgpar.profiles import ExternalProfile, InternalProfile, Points, Teeth
from swgpar.profiles.flank_points import heights

GearName = Literal["flexible_spline", "ring_gear", "dynamic_spline"]
"""Name of a gear: its section in the design file, and its body in meshes and results."""

DesignBody = Literal["flexible_spline", "ring_gear", "dynamic_spline", "housing", "bearing"]
"""Name of what may have a material of its own."""

SECTIONS = {"housing": "ring_gear.housing", "bearing": "wave_generator.bearing"}
"""Sections of bodies that have another name than these."""

GEARS: tuple[GearName, GearName] = ("flexible_spline", "ring_gear")
"""The gears that every drive has, in the order of the bodies."""

PER_MINUTE = np.pi / 30.0
"""A turn per minute in rad/s."""


class Drive(Section):
    """Section [drive]: layout, tooth numbers and sizes both gears share."""

    layout: Literal["ring_fixed", "spline_fixed", "wave_generator_fixed"] = quantity(
        "ring_fixed",
        text="fixed member; the wave generator drives the other gear, or where it is fixed the "
        "ring gear the spline; "
        "in a pancake drive the dynamic spline takes the place of the flexible one",
    )
    model: Literal["cup", "plane", "pancake"] = quantity(
        "cup",
        text="the cup drive, the toothed section in plane stress, or a flexible spline between two "
        "ring gears",
    )
    teeth_fs: int = quantity(text="teeth of the flexible spline", ge=8, le=2000)
    teeth_rg: int = quantity(text="teeth of the ring gear", ge=10, le=2002)
    module: float = positive("module", "mm")
    pressure_angle: float = positive("pressure angle", "deg", 20.0, lt=45.0)
    addendum_coef: float = not_negative("addendum of gears without their own", "modules", le=2.0)
    dedendum_coef: float = positive("dedendum of gears without their own", "modules", le=2.0)
    face_width: float = positive("face width", "mm")

    @property
    def standard_deflection(self) -> float:
        """Diametral deflection (mm) with which the pitch circles meet at a lobe."""
        return self.module * (self.teeth_rg - self.teeth_fs)

    def teeth(self, gear: GearName, section: ExternalGear | InternalGear) -> Teeth:
        """Number and sizes of the teeth of a gear, whose section may have its own heights.

        The dynamic spline has the teeth of the flexible spline on the pitch circle of the ring
        gear, where these mesh at the major axis: its module is larger.
        """
        external = gear == "flexible_spline"
        wider = self.teeth_rg / self.teeth_fs if gear == "dynamic_spline" else 1.0
        n_teeth = self.teeth_rg if gear == "ring_gear" else self.teeth_fs
        module = self.module * wider
        if isinstance(section.profile, Points):  # they have heights of their own
            of_points = n_teeth, external, module, f"{gear}.profile"
            addendum, dedendum = heights(section.profile, *of_points)
        else:
            tip, root = section.addendum_coef, section.dedendum_coef
            addendum = self.module * (self.addendum_coef if tip is None else tip)
            dedendum = self.module * (self.dedendum_coef if root is None else root)
        angle = float(np.radians(self.pressure_angle))
        return Teeth(n_teeth, module, angle, addendum, dedendum, external)


class Gear(Section):
    """What the sections [flexible_spline] and [ring_gear] have in common."""

    rim: float = positive("rim thickness below the root circle", "mm")
    addendum_coef: float | None = not_negative(
        "addendum; without it drive.addendum_coef", "modules", None, le=2.0
    )
    dedendum_coef: float | None = positive(
        "dedendum; without it drive.dedendum_coef", "modules", None, le=2.0
    )
    c_P: float = positive(
        "angular tooth thickness reduction: (1 - c_P) of half a pitch is the backlash that "
        "these teeth give; 1 with conjugate profiles",
        default=1.0,
        le=1.2,
    )
    c_l: float = not_negative(
        "share of the straight segment above the pitch point", default=0.5, le=1.0
    )
    tip_relief: float = not_negative(
        "tip relief of each flank, along the addendum circle", "mm", 0.0
    )
    tip_relief_height: float = positive(
        "height of the relieved part of the flank", "modules", 0.2, le=2.0
    )
    temperature: float | None = temperature("the gear")
    material: OptionalMaterial = None


class ExternalGear(Gear):
    """Section [flexible_spline]."""

    profile: ExternalProfile


class InternalGear(Gear):
    """Section [ring_gear]."""

    profile: InternalProfile
    housing: Housing | None = None
    frame: Frame = Frame()


class DynamicSpline(Gear):
    """Section [dynamic_spline]: the second ring gear of a pancake drive, with as many teeth as the
    flexible spline.

    It lies at z > 0, [ring_gear] at z < 0. Both end with the teeth of the flexible spline, whose
    face width they share.
    """

    profile: InternalProfile
    face_width: float | None = positive(
        "face width; default half of what the gap leaves, the rest is the ring gear's", "mm", None
    )
    gap: float = positive("axial gap between the ring gears", "mm")


FLANK_CROWNINGS: Mapping[GearName, str] = {
    "flexible_spline": "fs_crowning",
    "ring_gear": "rg_crowning",
    "dynamic_spline": "ds_crowning",
}
"""Keys of the crowning of flanks."""


class MicroGeometry(Section):
    """Section [micro_geometry]: crowning and slope (section 7.12)."""

    wg_crowning: float = not_negative("crowning of the cam at its edges", "mm", 0.0)
    wg_slope: float = quantity(
        0.0,
        unit="mm",
        text="slope of the cam: radial -s (2z/F_w) cos(lobes theta); s > 0 follows the cone of the "
        "cup",
    )
    fs_crowning: float = not_negative(
        "crowning of the flexible spline's flanks at their ends", "mm", 0.0
    )
    rg_crowning: float = not_negative(
        "crowning of the ring gear's flanks at the ends of its face width", "mm", 0.0
    )
    ds_crowning: float = not_negative("the same of the dynamic spline's flanks", "mm", 0.0)
    crowning_shape: Literal["parabolic", "circular"] = quantity(
        "parabolic", text="curve of the crowning"
    )

    def flank_crowning(self, gear: GearName) -> float:
        """Crowning (mm) of the flanks of a gear at the ends of its face width."""
        return float(getattr(self, FLANK_CROWNINGS[gear]))


class Load(Section):
    """Section [load]."""

    torque: float = not_negative("output torque, against the output's motion", "N·m", 0.0)
    input_speed: float = positive("speed of the input, for sliding speeds", "1/min", 2000.0, le=1e6)
    inertia: bool = quantity(
        False,
        text="forces of inertia of flexible spline and outer race, through which the wave passes "
        "at input_speed",
    )
    reference_temperature: float = quantity(
        20.0, unit="°C", text="temperature at which all sizes hold", ge=-273.15, le=1000.0
    )
    program: list[ProgramStage] = quantity(
        [], text="stages of a load program, which takes the place of torque and rotation"
    )

    @property
    def input_rate(self) -> float:
        """Speed of the input, rad/s."""
        return PER_MINUTE * self.input_speed


class ContactSection(Section):
    """Section [contact]: friction and lines of contact of the flanks, penalty of cam and pins."""

    friction: float = not_negative(
        "coefficient of friction between the flanks", default=0.0, le=1.0
    )
    penalty_coef: float = positive(
        "over E / module, E of the softer gear: stiffness of clamped and bolted ends and of "
        "the guide, penalty of flanks in exported jobs",
        default=50.0,
    )
    wg_penalty_coef: float = positive(
        "penalty of cam and pins over E / module, E of the flexible spline", default=5.0
    )
    quadrature: int = quantity(
        2, text="lines of contact on a layer of elements along the face width", ge=1, le=16
    )
    wg_quadrature: int = quantity(
        3, text="Gauss points per direction on the inner surface", ge=1, le=16
    )
    max_augmentations: int = quantity(
        3, text="largest number of augmentations of cam and pins per increment", ge=0, le=50
    )
    penetration_tolerance: float = positive(
        "penetration of cam and pins that needs no augmentation", "modules", 1e-3, le=0.1
    )


class Steps(Section):
    """Section [steps]: the load sequence and its increments."""

    rotation: float = not_negative("rotation of the input", "deg", 45.0, le=36000.0)
    increment: float = quantity(
        5.0, unit="deg", text="increment of that rotation", ge=0.01, le=45.0
    )
    pins: bool = quantity(
        True,
        text="deflect the spline by pins before the cam acts; false, or with a bearing: by the "
        "growing cam",
    )
    deflect_increments: int = quantity(
        1, text="increments of the deflection (step 1)", ge=1, le=1000
    )
    engage_increments: int = quantity(1, text="increments of the engagement", ge=1, le=1000)
    load_increments: int = quantity(1, text="increments of the torque", ge=1, le=1000)
    samples: int = quantity(
        0,
        text="angles computed in one period and continued by symmetry, instead of increments; 0: "
        "off",
        ge=0,
        le=1000,
    )
    bent_start: bool = quantity(
        False,
        text="begin with the loaded state, from the shape of the bent flexible spline, instead of "
        "steps 1 to 3",
    )
    start_levels: int = quantity(
        0,
        text="coarser meshes on which the drive is assembled and loaded (steps 1 to 3); 0: off",
        ge=0,
        le=4,
    )
    subdivide: bool = quantity(
        True,
        text="solve an increment in several steps where teeth would pass, or slip would begin, "
        "unseen; false: in one step",
    )


class Solver(Section):
    """Section [solver]: linear solver, convergence and reductions of the model."""

    linear: LinearSolverName = quantity(
        next(iter(LINEAR_SOLVERS)),
        text=f"linear solver: {', or '.join(entry.meaning for entry in LINEAR_SOLVERS.values())}",
    )
    rtol: float = positive("residual over contact force at convergence", default=1e-9, le=1e-3)
    max_iterations: int = quantity(
        25, text="Newton iterations before a cut-back, unless the residual falls", ge=1, le=1000
    )
    max_cutbacks: int = quantity(
        5, text="halvings of an increment before the run ends", ge=0, le=20
    )
    iteration_limit: int = quantity(
        600,
        text="Newton iterations of one step of an increment, those before cut-backs included",
        ge=1,
        le=1_000_000,
    )
    time_limit: float | None = positive(
        "wall time after which a run ends with the next Newton iteration; without it none",
        "s",
        None,
    )
    memory_limit: float | None = positive(
        "largest memory that a run may need by its forecast; without it what is free", "GB", None
    )
    symmetry: bool = quantity(
        True, text="model half of the drive when tooth numbers allow it, with three lobes a third"
    )
    far_teeth: Literal["left_out", "modelled"] = quantity(
        "left_out",
        text="teeth out of reach: sectors of a fixed ring gear without housing are left out, in "
        "the cup drive teeth "
        "are one element",
    )
    condensed_sectors: bool = quantity(
        False, text="plane model: eliminate the inside of tooth sectors"
    )
    keep_factor: bool = quantity(
        True, text="use factors for later tangents while GMRES converges with them"
    )


class Output(Section):
    """Section [output]."""

    fields: bool = quantity(True, text="write fields.h5 and fields.xdmf")
    figures: bool = quantity(True, text="draw the figures")
    root_stress: bool = quantity(
        True,
        text="resolve the largest stresses of teeth and wall of the flexible spline under load by "
        "windows on finer meshes",
    )
    contact_errors: bool = quantity(
        False,
        text="without root_stress: load the drive on a coarser mesh too, for the errors of "
        "contacts and bearing",
    )
    bearing_shares: bool = quantity(
        True,
        text="give the shares of the bearing in the compliance of the loaded drive, which take a "
        "factor of its last tangent",
    )


class Fatigue(Section):
    """Section [fatigue]: strengths of the flexible spline, for polished specimens; present to
    compute its fatigue.

    The defaults are those of a steel like 30CrNiMo8, quenched and tempered
    (docs/theory/fatigue.md).
    """

    tensile_strength: float = positive("tensile strength", "MPa", 1250.0)
    yield_strength: float = positive("yield strength", "MPa", 1050.0)
    fatigue_limit: float = positive("fatigue limit under alternating tension", "MPa", 560.0)
    shear_fatigue_limit: float = positive("fatigue limit under alternating torsion", "MPa", 348.0)
    surface_factor: float = positive(
        "factor of the surface on the fatigue strengths", default=0.86, le=1.5
    )
    size_factor: float = positive(
        "factor of the size on the fatigue strengths", default=1.0, le=1.5
    )
    basquin_coefficient: float = positive("Basquin's coefficient, of reversals", "MPa", 1875.0)
    basquin_exponent: float = quantity(-0.087, text="Basquin's exponent", ge=-0.5, lt=0.0)
