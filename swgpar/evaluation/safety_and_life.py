"""What the evaluation of fatigue gives: least safety factors, where they are, and the life."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from swgpar.answers.answer import (
    AnswerGroup,
    AnswerKind,
    answer,
    evaluation,
    joined_error,
    part_answers,
    place_text,
)
from swgpar.design.drive_design import DriveDesign

WARNING = (
    "the strengths in [fatigue] are the user's responsibility: the defaults are those of a steel "
    "like 30CrNiMo8 and "
    "replace no test of the part"
)

CRITERIA = {"goodman": "by Goodman", "crossland": "by Crossland", "yield": "against yield"}
"""Criteria of the safety, with words for them."""


@dataclass(frozen=True)
class LeastSafety:
    """The node with the least safety by a criterion.

    safety : the factor
    amplitude_MPa, mean_MPa : of the normal stress on Goodman's critical plane
    region, radius, z : mm, as of a `Place`;  angle_deg : from the middle of its tooth,
    counter-clockwise
    """

    safety: float
    amplitude_MPa: float
    mean_MPa: float
    region: str
    radius: float
    z: float
    angle_deg: float

    @property
    def place(self) -> str:
        """Words for the place."""
        return place_text(self.region, None, self.radius, self.z)


@dataclass(frozen=True)
class RegionSafety:
    """Least safety factors of a region.

    safety : by criterion
    amplitude_MPa, mean_MPa : where the safety by Goodman is the least;  warning : why it depends on
    the mesh
    """

    safety: Mapping[str, float]
    amplitude_MPa: float
    mean_MPa: float
    warning: str


LIFE_HOURS = AnswerKind("fatigue.life_hours", "life by Basquin", "h")


@evaluation
class Life:
    """Damage and life by Basquin, in turns of the wave generator or in passages of the load
    program.

    Values of the other kind are None. Without damage the life is None, without end. Where the
    stress exceeds the tensile strength, the life is 0 and the damage None.
    """

    damage_per_turn: float | None = None
    life_turns: float | None = answer(
        "fatigue.life_turns", "life by Basquin, turns of the wave generator", default=None
    )
    life_hours: float | None = part_answers(LIFE_HOURS, default=None)
    cycles_per_turn: float | None = None
    damage_per_program: float | None = None
    life_programs: float | None = answer(
        "fatigue.life_programs", "life by Basquin, passages of the load program", default=None
    )


@evaluation
class SafetyAndLife(AnswerGroup):
    """Least safety factors of the flexible spline and its life.

    least : by criterion, of `CRITERIA`;  regions : of every region by its name
    normal : (3,) of the critical plane, in the frame of the tooth (y radial)
    mesh_error : of Goodman's safety by the windows, None where they do not resolve its region or
    it is not known
    sampling_error : its change by half as many angles, None for an odd number of them
    root_factor, root_factor_error : None without windows
    factors : on nodal averages, by region that windows resolve
    windows : whether windows resolve the stress at the teeth where the design asks for it
    phases : of a cycle, or points of the load program
    """

    least: Mapping[str, LeastSafety] = part_answers(
        *(
            AnswerKind(
                f"fatigue.{name}",
                f"least safety factor {words}",
                path=f"least.{name}.safety",
                place=f"least.{name}.place",
                error="goodman_error" if name == "goodman" else "",
            )
            for name, words in CRITERIA.items()
        ),
        AnswerKind(
            "fatigue.amplitude",
            "amplitude of the normal stress where Goodman's safety is the least",
            "MPa",
            "least.goodman.amplitude_MPa",
        ),
        AnswerKind("fatigue.mean", "its mean", "MPa", "least.goodman.mean_MPa"),
    )
    regions: Mapping[str, RegionSafety]
    normal: tuple[float, float, float]
    mesh_error: float | None
    sampling_error: float | None
    life: Life
    root_factor: float | None = answer(
        "fatigue.root_factor",
        "factor of windows on stresses in the tooth root",
        error="root_factor_error",
    )
    root_factor_error: float | None
    windows: bool
    phases: int
    factors: Mapping[str, float] = field(default_factory=dict)
    fatigue_limit_of_the_part_MPa: float = answer(
        "fatigue.limit_of_the_part",
        "fatigue limit with surface and size factors",
        "MPa",
        detail=True,
        exact=True,
    )

    TITLE = "safety and life of the flexible spline"
    ASKED_BY = "[fatigue]"
    SECTION = "fatigue"

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        left_out = ("_turns", "_hours") if design.has_program else ("_programs",)
        return tuple(kind for kind in super().kinds(design) if not kind.name.endswith(left_out))

    @property
    def goodman_error(self) -> float | None:
        """Error of Goodman's safety; None where a part of it is not known."""
        return joined_error(self.mesh_error, self.sampling_error)

    def remarks(self) -> Iterator[str]:
        if self.life.life_turns is None and self.life.life_programs is None:
            yield "life by Basquin: without end"
        if not self.root_factor:
            missing = (
                ": set output.root_stress = true"
                if self.windows
                else ": there are no windows in this run"
            )
            yield f"stresses in the tooth root are nodal averages, up to 25 % low{missing}"
        yield WARNING
