"""Verdicts change where the limit is crossed, for every kind of row of the rating sheet."""

from __future__ import annotations

import re
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any, cast

import pytest

import swgpar
from support.cup_shapes import bolted
from support.paths import DESIGN, DRIVERS
from support.small_drive import PLANE
from swgpar.answers.answer import NO_LIMIT, Answer
from swgpar.answers.table import AnswerTable
from swgpar.answers.verdict import Judgement, Limit, Sense, Verdict, worst
from swgpar.api.ratings import load_rated_design
from swgpar.design.drive_design import DriveDesign
from swgpar.drive_results.report_checks import RESOLUTION
from swgpar.drive_results.strength_checks import FIRST_YIELD
from swgpar.drive_results.summary import DriveSummary
from swgpar.errors import InputError
from swgpar.input.toml_file import read_toml
from swgpar.largest_stress.accuracy import Accuracy
from swgpar.rating.planned_runs import LoadCase, plan_runs, rating_loads
from swgpar.rating.rate_drive import accuracy_of
from swgpar.rating.rated_answers import STATIC_PRESSURE
from swgpar.rating.rows import (
    NO_FLANK_PRESSURE,
    NO_RING_STRENGTH,
    RatingRow,
    rating_rows,
)

PASSES, FAILS = Judgement.PASSES, Judgement.FAILS
WITHIN, OPEN = Judgement.WITHIN_ERROR, Judgement.NOT_JUDGED

RATING = {
    "rated_torque": 1.0,
    "repeated_peak_torque": 1.5,
    "average_torque": 0.8,
    "momentary_torque": 2.0,
    "largest_speed": 3000.0,
    "life": 7000.0,
    "yield_safety": 1.25,
    "fatigue_safety": 1.5,
    "static_safety": 2.0,
    "ratcheting_safety": 1.5,
    "flank_pressure": 800.0,
    "flank_pressure_source": "the maker",
    "K1": 100.0,
    "K2": 200.0,
    "K3": 300.0,
    "hysteresis": 1.0,
    "lost_motion": 2.0,
    "transmission_error": 60.0,
    "efficiency": 0.7,
    "no_load_torque": 0.05,
    "starting_torque": 0.03,
}
BEARING = {"race_thickness": 1.0, "balls": 12, "ball_diameter": 2.5}
SECTIONS: dict[str, Any] = {
    "material": {"name": "steel"},
    "fatigue": {"yield_strength": 1000.0},
    "losses": {},
    "frequencies": {},
    "deviations": {},
}


def rated(**changes: Any) -> DriveDesign:
    """The small drive with a rating. changes : of sections; None takes one away"""
    values = {**SECTIONS, "rating": RATING, **changes}
    design = swgpar.load_design(DESIGN)
    table = design.model_dump(exclude_unset=True)
    table |= {name: value for name, value in values.items() if value is not None}
    return load_rated_design(table)


def with_bearing() -> dict[str, Any]:
    micro = {"wg_crowning": 0.1, "fs_crowning": 0.04}
    return {"wave_generator": {"face_width": 4.0, "bearing": BEARING}, "micro_geometry": micro}


def row(name: str, design: DriveDesign) -> RatingRow:
    (found,) = [one for one in rating_rows(design) if one.name == name]
    return found


class _Summary(AnswerTable):
    """A summary with these answers; attributes are evaluations, None by default."""

    def __init__(self, answers: dict[str, Answer], **evaluations: Any) -> None:
        self.given, self.evaluations = answers, evaluations

    def answers(self) -> Iterator[Answer]:
        return iter(self.given.values())

    def __getattr__(self, name: str) -> Any:
        return self.evaluations.get(name)


def summary(name: str, value: float, error: float | None = None, **more: Any) -> DriveSummary:
    answer = Answer(name, value, "", name, error=error)
    return cast(DriveSummary, _Summary({name: answer}, **more))


def judged(name: str, design: DriveDesign, found: DriveSummary) -> Judgement:
    return row(name, design).verdict(found, "").judgement


@pytest.mark.parametrize(
    ("sense", "value", "judgement"),
    [
        (Sense.AT_MOST, 8.9, PASSES),
        (Sense.AT_MOST, 9.1, WITHIN),
        (Sense.AT_MOST, 10.9, WITHIN),
        (Sense.AT_MOST, 11.1, FAILS),
        (Sense.AT_LEAST, 8.9, FAILS),
        (Sense.AT_LEAST, 9.1, WITHIN),
        (Sense.AT_LEAST, 10.9, WITHIN),
        (Sense.AT_LEAST, 11.1, PASSES),
    ],
)
def test_a_verdict_beyond_the_error(sense: Sense, value: float, judgement: Judgement) -> None:
    limit = Limit(10.0, sense, "here")
    assert Verdict("a", Answer("a", value, "", "a", error=1.0), limit).judgement == judgement


@pytest.mark.parametrize("sense", Sense)
def test_without_an_error_the_value_is_judged_and_the_limit_is_good(sense: Sense) -> None:
    limit = Limit(10.0, sense, "here")
    beyond = 1e-9 if sense == Sense.AT_MOST else -1e-9
    for value, judgement in ((10.0, PASSES), (10.0 + beyond, FAILS), (10.0 - beyond, PASSES)):
        assert Verdict("a", Answer("a", value, "", "a"), limit).judgement == judgement


def test_what_is_not_judged_says_why() -> None:
    limit = Limit(10.0, Sense.AT_MOST, "here")
    known = Answer("a", 1.0, "", "a")
    growing = Answer("a", 1.0, "", "a", no_error=NO_LIMIT, remark="on an edge")
    lacking = Answer("a", None, "", "a", remark="no load")
    for verdict, why in (
        (Verdict("a", known, None), "no requirement"),
        (Verdict("a", None, limit, "the run failed"), "the run failed"),
        (Verdict("a", None, limit), "the run does not have it"),
        (Verdict("a", growing, limit), "on an edge"),
        (Verdict("a", lacking, limit), "no load"),
    ):
        assert verdict.judgement == OPEN
        assert verdict.why == why
    assert Verdict("a", known, limit).why == ""


@pytest.mark.parametrize(
    ("sense", "below", "above"), [(Sense.AT_MOST, OPEN, FAILS), (Sense.AT_LEAST, OPEN, PASSES)]
)
def test_a_lower_bound_says_only_what_it_can(
    sense: Sense, below: Judgement, above: Judgement
) -> None:
    limit = Limit(10.0, sense, "here")
    for value, judgement in ((9.0, below), (11.0, above)):
        answer = Answer("a", value, "", "a")
        verdict = Verdict("a", answer, limit, "a bound", is_lower_bound=True)
        assert verdict.judgement == judgement
        assert verdict.why == ("a bound" if judgement == OPEN else "")


def test_the_headline_is_the_worst_of_what_is_required() -> None:
    limit = Limit(10.0, Sense.AT_MOST, "here")

    def one(value: float, error: float | None = None, **more: Any) -> Verdict:
        return Verdict("a", Answer("a", value, "", "a", error=error), more.pop("at", limit), **more)

    good, near, bad = one(1.0), one(9.9, 1.0), one(11.0)
    free, unknown = one(1.0, at=None), one(1.0, at=None, of_strength=True)
    assert worst([]) == OPEN
    assert worst([good, free]) == PASSES
    assert worst([good, unknown]) == OPEN
    assert worst([good, unknown, near]) == WITHIN
    assert worst([near, bad, good, unknown]) == FAILS


CROSSED = {
    "stiffness K1": ("stiffness.K1", 100.0, True),
    "stiffness K2": ("stiffness.K2", 200.0, True),
    "stiffness K3": ("stiffness.K3", 300.0, True),
    "lost motion": ("stiffness.lost_motion", 2.0, False),
    "transmission error": ("transmission_error.peak_to_peak", 60.0, False),
    "efficiency": ("losses.efficiency", 0.7, True),
    "no-load torque": ("losses.no_load_torque", 50.0, False),
    "starting torque": ("losses.starting_torque", 30.0, False),
    "lowest natural frequency": ("frequency.1", 100.0, True),
    "pressure of the flanks": ("contact.pressure", 800.0, False),
    "yield below the flanks": ("contact.pressure", FIRST_YIELD * 800.0, False),
    "yield of teeth and rim": ("largest.fs_vm in tooth root", 800.0, False),
    "yield of the ring gear": ("largest.rg_vm in tooth root", 800.0, False),
    "yield of wall": ("largest.fs_vm in cup wall", 800.0, False),
    "clearance of the rigid teeth": ("clearance.ring_gear", -0.002, True),
}
"""Row -> answer, limit in the unit of the answer, and whether larger values are good."""


@pytest.mark.parametrize("name", CROSSED)
def test_a_row_changes_where_its_limit_is_crossed(name: str) -> None:
    answer, limit, larger_is_good = CROSSED[name]
    design, step = rated(), 0.01 * abs(limit)
    below, above = (FAILS, PASSES) if larger_is_good else (PASSES, FAILS)
    assert judged(name, design, summary(answer, limit - step)) == below
    assert judged(name, design, summary(answer, limit + step)) == above
    for side in (-step, step):
        assert judged(name, design, summary(answer, limit + side, 2.0 * step)) == WITHIN


ELSEWHERE = {
    "fatigue of teeth and rim",
    "fatigue of wall",
    "life of the flexible spline",
    "static safety of the bearing",
    "life of the bearing",
    "sliding of bolts",
    "gaping of bolts",
    "ratcheting",
    "hysteresis",
    "clearance of the rigid teeth in the dynamic spline",
    "resolution",
}
"""Rows whose limits are crossed in tests of their own below."""


def test_every_row_has_its_limit_crossed() -> None:
    designs = [rated(**with_bearing()), rated(**with_bolts()), pancake()]
    names = {one.name for design in designs for one in rating_rows(design)}
    assert names == CROSSED.keys() | ELSEWHERE | {"bearing"}  # the last one: there is none
    assert row("bearing", rated()).limit is None


def test_clearance_in_the_second_ring_gear() -> None:
    name, answer = "clearance of the rigid teeth in the dynamic spline", "clearance.dynamic_spline"
    design = pancake()
    limit = row(name, design).limit
    assert limit is not None
    for share, judgement in ((1.01, FAILS), (0.99, PASSES)):
        found = summary(answer, share * limit.value)
        assert limit.value < 0.0 and judged(name, design, found) == judgement


@pytest.mark.parametrize("part", ["teeth and rim", "wall"])
@pytest.mark.parametrize(
    ("safety", "judgement"), [(1.49, FAILS), (1.51, PASSES)], ids=["below", "above"]
)
def test_fatigue_of_a_part(part: str, safety: float, judgement: Judgement) -> None:
    own, other = ("tooth root", "cup wall") if part == "teeth and rim" else ("fillet", "tip")
    region = SimpleNamespace(safety={"goodman": safety, "crossland": 1.7}, warning="")
    safe = SimpleNamespace(safety={"goodman": 0.5, "crossland": 0.5}, warning="")
    least = SimpleNamespace(safety=safety, region=own, place=own)
    fatigue = SimpleNamespace(
        regions={own: region, other: safe},
        least={"goodman": least, "crossland": least},
        goodman_error=None,
    )
    found = summary("none", 0.0, fatigue=fatigue)
    assert judged(f"fatigue of {part}", rated(), found) == judgement
    fatigue.goodman_error = 0.1
    assert judged(f"fatigue of {part}", rated(), found) == WITHIN
    region.warning = "no limit"
    assert judged(f"fatigue of {part}", rated(), found) == OPEN


def test_life_of_the_flexible_spline() -> None:
    """Under a peak torque that does not always act it is a lower bound."""
    always = {**RATING, "average_torque": RATING["repeated_peak_torque"]}
    for hours, alone, bound in (
        (6999.0, FAILS, OPEN),
        (7001.0, PASSES, PASSES),
        (None,) + 2 * (PASSES,),
    ):
        life = SimpleNamespace(life_hours=hours)
        least = {"goodman": SimpleNamespace(place="")}
        found = summary("none", 0.0, fatigue=SimpleNamespace(life=life, least=least))
        assert judged("life of the flexible spline", rated(rating=always), found) == alone
        assert judged("life of the flexible spline", rated(), found) == bound


def test_static_safety_and_life_of_the_bearing() -> None:
    design = rated(**with_bearing())
    most = STATIC_PRESSURE / 2.0 ** (1.0 / 3.0)
    name = "static safety of the bearing"
    for pressure, judgement in ((0.999 * most, PASSES), (1.001 * most, FAILS)):
        assert judged(name, design, summary("bearing.pressure", pressure)) == judgement
        near = summary("bearing.pressure", pressure, 0.002 * most)
        assert judged(name, design, near) == WITHIN
    for hours, judgement in ((6999.0, FAILS), (7001.0, PASSES)):
        found = summary("bearing.life_hours", hours)
        assert judged("life of the bearing", design, found) == judgement


def with_bolts(**more: Any) -> dict[str, Any]:
    cup = swgpar.load_design(DESIGN).model_dump(exclude_unset=True)["cup"]
    return {"cup": cup | bolted(8) | more, "deviations": None, "frequencies": None}


def pancake() -> DriveDesign:
    table = read_toml(DRIVERS / "pancake.toml")
    return load_rated_design(table | {"rating": RATING, "fatigue": {}, "losses": {}})


PRELOADED = {"bolt_preload": 1000.0, "joint_friction": 0.15}


@pytest.mark.parametrize("name", ["sliding", "gaping"])
def test_bolts(name: str) -> None:
    row_name, answer = f"{name} of bolts", f"bolts.{name}_safety"
    design = rated(**with_bolts(**PRELOADED))
    for safety, judgement in ((0.99, FAILS), (1.01, PASSES)):
        assert judged(row_name, design, summary(answer, safety)) == judgement
        assert judged(row_name, design, summary(answer, safety, 0.02)) == WITHIN
    loose = row(row_name, rated(**with_bolts())).verdict(summary("none", 0.0), "")
    assert loose.judgement == OPEN and loose.of_strength and "cup.bolt_preload" in loose.why


def test_a_stress_cycle_with_bolts_has_an_angle_at_every_pitch() -> None:
    """40 teeth and 8 bolts: a period of five pitches, in which five angles show one place."""
    plan = plan_runs(rated(**with_bolts(**PRELOADED)))
    runs = {run.name: run for run in plan.runs}
    for name in ("rated torque", "repeated peak torque", "no load"):
        design = runs[name].design
        assert design is not None and not runs[name].left_out
        assert design.steps.samples == 6 and design.kinematics.pitches == 5
    free = plan_runs(rated(**with_bolts(), fatigue=None, losses=None)).runs[0].design
    assert free is not None and free.steps.samples == 4


def test_the_ring_gear_has_the_strength_of_its_own_material() -> None:
    name, found = "yield of the ring gear", summary("largest.rg_vm in tooth root", 500.0)
    design = rated()
    ring = design.model_dump(exclude_unset=True)["ring_gear"] | {"material": {"name": "7075-T6"}}
    other = rated(ring_gear=ring)
    unknown = row(name, other).verdict(found, "")
    assert unknown.judgement == OPEN and unknown.of_strength
    assert "rating.ring_yield_strength" in unknown.why
    for strength, judgement in ((1.24 * 500.0, FAILS), (1.26 * 500.0, PASSES)):
        given = rated(ring_gear=ring, rating=RATING | {"ring_yield_strength": strength})
        assert judged(name, given, found) == judgement
    assert row(name, rated(fatigue=None)).verdict(found, "").judgement == OPEN


PRINTED: dict[str, Any] = {
    "material": {"E": 3500.0, "nu": 0.36},
    "fatigue": {"tensile_strength": 60.0},
}
UNKNOWN = {"flank_pressure": None, "flank_pressure_source": ""}
TREATED = [
    ("through_hardened", 300.0, 1.313 * 300.0 + 373.0),
    ("induction_hardened", 550.0, 0.541 * 550.0 + 882.0),
    ("nitrided", 500.0, 998.0),
    ("case_hardened", 700.0, 1500.0),
]


@pytest.mark.parametrize(("treatment", "hardness", "limit"), TREATED)
def test_pressure_by_treatment_and_hardness(treatment: str, hardness: float, limit: float) -> None:
    keys = {"flank_treatment": treatment, "flank_hardness": hardness}
    design, name = rated(rating=RATING | UNKNOWN | keys), "pressure of the flanks"
    for pressure, judgement in ((0.999 * limit, PASSES), (1.001 * limit, FAILS)):
        assert judged(name, design, summary("contact.pressure", pressure)) == judgement
    assert "ISO 6336-5" in row(name, design).limit.source


@pytest.mark.parametrize(
    ("keys", "changes", "words"),
    [
        ({"flank_hardness": 300.0}, {}, "rating.flank_hardness = 300 is out of range"),
        ({"flank_treatment": "nitrided"}, {}, "rating.flank_hardness is missing"),
        (
            {"flank_treatment": "nitrided", "flank_hardness": 300.0},
            {},
            "rating.flank_hardness = 300 is out of range: allowed 450 to 650 HV",
        ),
        (
            {"flank_treatment": "nitrided", "flank_hardness": 500.0, "flank_pressure": 800.0},
            {},
            "is not available with rating.flank_pressure = 800.0",
        ),
        (
            {"flank_treatment": "nitrided", "flank_hardness": 500.0},
            {"material": {"name": "7075-T6"}, "fatigue": None},
            "is not available with a flexible spline of 71 GPa",
        ),
        # a run that leaves [fatigue] out has not seen it, and its limits stay on the sheet
        ({}, PRINTED, "fatigue.yield_strength is missing: the default is that of a steel"),
    ],
)
def test_refused_materials(keys: dict[str, Any], changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words.replace("(", r"\(")):
        rated(rating=RATING | UNKNOWN | keys, **changes)


@pytest.mark.parametrize(
    ("torques", "words"),
    [
        ({"rated_torque": 4.0, "repeated_peak_torque": 3.0}, "allowed 4 N·m (the rated torque)"),
        ({"rated_torque": 4.0, "average_torque": 5.0}, "allowed above 0 to 4 N·m"),
        (
            {"rated_torque": 1.0, "repeated_peak_torque": 4.0, "momentary_torque": 3.0},
            "allowed 4 N·m (the repeated peak torque)",
        ),
    ],
)
def test_refused_torques(torques: dict[str, float], words: str) -> None:
    with pytest.raises(InputError, match=re.escape(words)):
        rating_loads(rated(rating=torques))


@pytest.mark.parametrize(
    ("torque", "is_peak", "judgement"),
    [(2.99, True, FAILS), (3.01, True, PASSES), (2.99, False, OPEN), (3.01, False, PASSES)],
)
def test_ratcheting(torque: float, is_peak: bool, judgement: Judgement) -> None:
    more = {"ratcheting": SimpleNamespace(is_peak=is_peak, ended="limit reached")}
    found = summary("ratcheting.peak_torque_Nm", torque, **more)
    assert judged("ratcheting", rated(), found) == judgement


@pytest.mark.parametrize(("width", "judgement"), [(0.99, PASSES), (1.01, FAILS)])
def test_hysteresis_needs_friction_to_pass(width: float, judgement: Judgement) -> None:
    found = summary("stiffness.hysteresis", width)
    assert judged("hysteresis", rated(contact={"friction": 0.1}), found) == judgement
    alone = OPEN if judgement == PASSES else judgement
    assert judged("hysteresis", rated(), found) == alone


def test_the_transmission_error_needs_deviations_to_pass() -> None:
    design = rated(deviations=None)
    found = summary("transmission_error.peak_to_peak", 59.0)
    assert judged("transmission error", design, found) == OPEN
    found = summary("transmission_error.peak_to_peak", 61.0)
    assert judged("transmission error", design, found) == FAILS


def test_resolution() -> None:
    for share, judgement in ((0.99 * RESOLUTION, PASSES), (1.01 * RESOLUTION, FAILS)):
        root = SimpleNamespace(total_error=100.0 * share, s1=100.0, place="")
        found = summary("none", 0.0, root_stress=root)
        assert judged("resolution", rated(), found) == judgement
    (last,) = [one for one in rating_rows(rated(), 0.02) if one.name == "resolution"]
    root = SimpleNamespace(total_error=2.1, s1=100.0, place="")
    verdict = last.verdict(summary("none", 0.0, root_stress=root), "")
    assert verdict.judgement == FAILS
    # an accuracy that was asked for is no advice
    asked = Accuracy(asked=0.02, estimated=0.2, reached=False)
    root = SimpleNamespace(total_error=20.0, s1=100.0, place="")
    for accuracy, remark in ((None, "--accuracy 0.05"), (asked, "NOT reached")):
        found = summary("none", 0.0, root_stress=root, accuracy=accuracy)
        assert last.verdict(found, "").answer.remark.startswith(remark)
    root = SimpleNamespace(total_error=None, s1=100.0, place="")
    assert judged("resolution", rated(), summary("none", 0.0, root_stress=root)) == OPEN


def test_without_requirements_rows_stand_and_say_so() -> None:
    design = rated(rating={"rated_torque": 1.0}, fatigue=None, losses=None, frequencies=None)
    plan = plan_runs(design)
    for one in rating_rows(design):
        if one.name in ("clearance of the rigid teeth", "resolution"):
            continue
        verdict = one.verdict(summary("none", 0.0), plan.missing.get(one.case, ""))
        assert verdict.judgement == OPEN
        assert verdict.why
    found = summary("contact.pressure", 5.0)
    for name, why in (
        ("pressure of the flanks", NO_FLANK_PRESSURE),
        ("yield of the ring gear", NO_RING_STRENGTH),
        ("yield below the flanks", "no strengths are given: [fatigue]"),
    ):
        assert row(name, design).verdict(found, "").why == why
    assert row("resolution", design).verdict(None, "the run waits").why == "the run waits"
    found = summary("stiffness.K1", 5.0)
    assert row("stiffness K1", design).verdict(found, "").why == "no requirement"
    assert plan.missing[LoadCase.RATCHETING] == "rating.momentary_torque is not given"


def test_loads_of_one_torque_share_a_run() -> None:
    names = [run.name for run in plan_runs(rated()).runs]
    assert names == [
        "rated torque",
        "repeated peak torque",
        "largest torque",
        "no load",
        "stiffness",
        "natural frequencies",
        "ratcheting",
    ]
    one_torque = {"rated_torque": 1.0, "largest_speed": 10.0}
    plan = plan_runs(rated(rating=one_torque, **with_bearing()))
    first, *others = plan.runs
    assert first.name == "rated torque, repeated peak torque, average torque, largest torque"
    assert first.design is not None and first.design.fatigue and first.design.losses
    assert [run.name for run in others] == ["no load", "stiffness", "natural frequencies"]


def test_with_friction_what_cannot_have_it_runs_without() -> None:
    plan = plan_runs(rated(contact={"friction": 0.1}))
    runs = {run.name: run for run in plan.runs}
    run = runs["natural frequencies"]
    assert run.design is not None and run.design.contact.friction == 0.0
    assert "friction" in run.left_out
    design = runs["rated torque"].design
    assert design is not None and design.contact.friction == 0.1 and design.deviations
    assert design.steps.samples


def test_a_load_from_one_side_has_no_period_and_the_sheet_says_it() -> None:
    springs = {"radial_stiffness": 1e5, "axial_stiffness": 1e5, "tilting_stiffness": 1e4}
    sideways = {**springs, "radial_force": 10.0}
    plan = plan_runs(rated(output_bearing=sideways, deviations=None, frequencies=None))
    first = plan.runs[0]
    assert first.design is not None and first.design.losses is None
    assert "radial force" in first.left_out


def test_a_pancake_drive_has_all_runs_but_ratcheting() -> None:
    plan = plan_runs(pancake())
    runs = {run.name: run for run in plan.runs}
    first = runs["rated torque"].design
    assert first is not None and first.steps.samples and first.losses
    for name in ("no load", "stiffness"):
        assert runs[name].design is not None and not runs[name].refusal
    assert runs["ratcheting"].design is None
    assert 'drive.model = "pancake"' in runs["ratcheting"].refusal


def test_resolution_names_no_option_that_the_drive_refuses() -> None:
    assert "--accuracy" in row("resolution", rated()).missing
    assert "--accuracy" in row("resolution", pancake()).missing
    sideways = {
        "radial_stiffness": 1e5,
        "axial_stiffness": 1e5,
        "tilting_stiffness": 1e4,
        "radial_force": 10.0,
    }
    one = row("resolution", rated(output_bearing=sideways, deviations=None, frequencies=None))
    assert "--accuracy" not in one.missing


def test_yield_of_the_ring_gear_is_that_of_both_ring_gears() -> None:
    name, design = "yield of the ring gear", pancake()
    limit = row(name, design).limit
    assert limit is not None
    for body in ("rg", "ds"):
        for share, judgement in ((0.99, PASSES), (1.01, FAILS)):
            found = summary(f"largest.{body}_vm in tooth root", share * limit.value)
            assert judged(name, design, found) == judgement


def test_sections_that_exclude_each_other_may_stand_in_one_file() -> None:
    keys = {"stiffness": {"positions": 2}, "ratcheting": {"increment": 0.05}}
    runs = {run.name: run for run in plan_runs(rated(**keys)).runs}
    loop, jump = runs["stiffness"].design, runs["ratcheting"].design
    assert loop is not None and loop.stiffness is not None and loop.ratcheting is None
    assert (loop.stiffness.positions, loop.stiffness.torque) == (2, RATING["rated_torque"])
    assert jump is not None and jump.ratcheting is not None and jump.ratcheting.increment == 0.05
    assert jump.ratcheting.sufficient_torque == 1.25 * 1.5 * RATING["momentary_torque"]
    assert jump.ratcheting.start_torque == RATING["average_torque"]
    keys["ratcheting"] |= {"yield_strength": 600.0}  # the first yield may be before that
    jump = next(run.design for run in plan_runs(rated(**keys)).runs if run.name == "ratcheting")
    assert jump is not None and jump.ratcheting.start_torque is None
    with pytest.raises(InputError, match="gear train has no rating"):
        load_rated_design(DRIVERS / "gear_pair.toml")


def test_an_accuracy_is_for_runs_with_stresses() -> None:
    runs = {run.name: run for run in plan_runs(rated()).runs}
    refined = {name for name, run in runs.items() if accuracy_of(run, 0.02) == (0.02, "")}
    assert refined == {"repeated peak torque", "largest torque"}
    springs = {"radial_stiffness": 1e5, "axial_stiffness": 1e5, "tilting_stiffness": 1e4}
    sideways = {"output_bearing": springs | {"radial_force": 10.0}, "frequencies": None}
    (carried,) = [
        run
        for run in plan_runs(rated(deviations=None, **sideways)).runs
        if run.name == "largest torque"
    ]
    chosen, reason = accuracy_of(carried, 0.02)
    assert chosen is None and "radial force" in reason
    assert accuracy_of(carried, None) == (None, "")
    assert not any(reason for _, reason in (accuracy_of(run, 0.02) for run in runs.values()))
    assert all(accuracy_of(run, None) == (None, "") for run in runs.values())
    with pytest.raises(InputError, match="--accuracy = 0.5 is out of range"):
        swgpar.rate(rated(), "results", accuracy=0.5)


def test_a_rating_is_refused_without_its_section_or_a_torque() -> None:
    with pytest.raises(InputError, match="rating is missing"):
        load_rated_design(DESIGN, PLANE)
    with pytest.raises(InputError, match=r"rating\.rated_torque is missing"):
        load_rated_design(DESIGN, {"rating": {}, "load.torque": 0.0})
    with pytest.raises(InputError, match=r"rating\.efficiency = 1\.5 is out of range"):
        load_rated_design(DESIGN, {"rating.efficiency": 1.5})
