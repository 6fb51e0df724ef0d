"""The app without a browser: form, section of the teeth, variants, queue of jobs, token."""

from __future__ import annotations

import asyncio
import dataclasses
import json
import logging
import re
import shutil
import time
import tomllib
from base64 import b64decode
from collections.abc import Callable
from multiprocessing import Pipe
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

import swgpar
from support.paths import DATA, DESIGN, DRIVERS, RECIPE, ROOT
from support.scripts import load_script
from swgpar.analysis.forecast import forecast
from swgpar.answers.verdict import Judgement
from swgpar.api.runs import load_mesh
from swgpar.app.access import COOKIE, TokenGate
from swgpar.app.choices import Choices
from swgpar.app.drawings import DRAWINGS, FOLDER, drawings_of
from swgpar.app.durations import durations
from swgpar.app.fields import FormField, form_fields, is_optional, missing_sections
from swgpar.app.flank_gaps import NEAR, flank_gaps
from swgpar.app.jobs import AppJob, JobQueue, JobState, shell_environment
from swgpar.app.key_control import slider_range
from swgpar.app.loaded_states import (
    PLANE,
    SOLID,
    ShownState,
    open_session,
    plane_table,
    solve_state,
)
from swgpar.app.search_plot import EVALUATION, pair_figure, parallel_figure
from swgpar.app.section_panel import TeethPicture
from swgpar.app.section_plot import moved, section_figure
from swgpar.app.state import AppState, recipes_of
from swgpar.app.state_worker import RunProgress
from swgpar.app.verdict_panel import sheet_of, verdict_text
from swgpar.app.workspace import Variant, Workspace, drive_of
from swgpar.checks.clearance import clearances, smallest_clearance
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS
from swgpar.errors import InputError, OutputError
from swgpar.input.differences import differences
from swgpar.optimisation.tried_designs import read_tried
from swgpar.presentation.body_curves import body_curves
from swgpar.presentation.overlap_areas import slot_overlap
from swgpar.profiles.keys import ExternalProfile, InternalProfile
from swgpar.profiles.mesh_gap import outline
from swgpar.rating.forecast import rating_seconds
from swgpar.rating.planned_runs import plan_runs
from swgpar.rating.sheet_differences import sheet_differences
from swgpar.rating.stored_sheet import StoredRow, StoredSheet, read_sheet

ADDENDUM = "drive.addendum_coef"
DESIGNS = ["cup_45deg.toml", "three_lobes.toml", "rating.toml"]


def drive(path: Path = DESIGN) -> DriveDesign:
    design = swgpar.load_design(path)
    assert isinstance(design, DriveDesign)
    return design


def fields(design: DriveDesign) -> dict[str, FormField]:
    return {field.key: field for field in form_fields(design)}


def test_every_plain_key_of_a_design_has_a_field() -> None:
    """With the value of the design, its unit and its range."""
    design = drive(DRIVERS / "rating.toml")
    found = fields(design)
    field = found["wave_generator.bearing.ball_diameter"]
    assert (field.value, field.unit, field.kind) == (4.0, "mm", "number")
    assert field.allowed.startswith("allowed above 0")
    for key, one in found.items():
        value: Any = design
        for part in key.split("."):
            value = getattr(value, part)
        assert one.value == value


@pytest.mark.parametrize(
    ("key", "entry", "value"),
    [
        ("drive.module", "0,45", 0.45),
        ("drive.module", "1.5e-1", 0.15),
        ("drive.module", "wide", "wide"),
        ("drive.teeth_fs", "80", 80),
        ("drive.teeth_fs", "80.5", 80.5),
        ("flexible_spline.addendum_coef", "", None),
        ("drive.layout", "spline_fixed", "spline_fixed"),
    ],
)
def test_what_an_entry_means(key: str, entry: str, value: Any) -> None:
    assert fields(drive())[key].parsed(entry) == value


@pytest.mark.parametrize("name", DESIGNS)
@pytest.mark.parametrize("angle", [0.0, 17.0, 271.0])
def test_gaps_of_the_picture_are_those_of_the_rigid_teeth(name: str, angle: float) -> None:
    """None is smaller than the clearance of a turn; near it there is one at each angle."""
    design = drive(DRIVERS / name)
    gaps = flank_gaps(design, angle)
    smallest = clearances(design.rigid_pairs)[0].nearest.distance
    pitch = 2.0 * np.pi / design.drive.teeth_fs
    assert smallest - 1e-9 <= gaps.gap.min() < smallest + 0.05 * design.drive.module * pitch
    assert gaps.gap.max() < NEAR * design.drive.module
    # flanks are drawn where their gaps are taken: on the outline of the spline
    keys = design.geometry, design.tooth_motion(), design.cam(), float(np.radians(angle))
    outline = body_curves(*keys)["flexible_spline"][0]
    for place in gaps.place[:: len(gaps.gap) // 8]:
        ahead = np.roll(outline, -1, axis=0) - outline
        along = ((place - outline) * ahead).sum(1) / (ahead**2).sum(1)
        foot = outline + np.clip(along, 0.0, 1.0)[:, None] * ahead
        assert np.hypot(*(place - foot).T).min() < 0.02 * design.drive.module


def test_the_picture_repeats_after_a_pitch_of_the_ring_gear() -> None:
    """Then another tooth of the flexible spline is at each place."""
    design = drive()
    teeth = design.drive.teeth_fs
    gaps = []
    for angle in (0.0, 360.0 / design.drive.teeth_rg):
        found = flank_gaps(design, angle)
        flank = np.cumsum(np.diff(found.tooth, prepend=0) < 0)
        gaps.append(np.full((2, teeth), np.inf))
        gaps[-1][flank, found.tooth] = found.gap
    assert np.isfinite(gaps[0]).sum() > 8
    assert gaps[1] == pytest.approx(np.roll(gaps[0], 1, axis=1), abs=1e-9)


def test_sections_with_a_shape_have_drawings() -> None:
    """Every file that is named is there, and every kind of profile has one."""
    named = {name for names in DRAWINGS.values() for name in names}
    kinds = {
        get_args(kind.model_fields["type"].annotation)[0]
        for union in (ExternalProfile, InternalProfile)
        for kind in get_args(get_args(union)[0])
    }
    assert len(kinds) > 6
    files = {path.stem for path in FOLDER.glob("*.png")}
    assert files == named | {f"profile_{kind}" for kind in kinds}
    design = drive(DRIVERS / "rating.toml")
    assert drawings_of(design, "ring_gear.profile") == (f"profile_{design.ring_gear.profile.type}",)
    assert set(DRAWINGS) >= {"cup", "wave_generator.bearing"} and not drawings_of(design, "fatigue")


def test_drawings_are_those_of_the_documents() -> None:
    """`python scripts/app_drawings.py` takes them over, and writes down from which scripts."""
    script = load_script(ROOT / "scripts" / "app_drawings.py")
    assert script.RECORD.read_text(encoding="utf-8") == script.record()


def test_how_long_commands_take(tmp_path: Path) -> None:
    """By the forecasts of their runs; nothing is said of a mesh that does not fit."""
    design = drive(DRIVERS / "rating.toml")
    run = forecast(design, load_mesh("coarse")).seconds
    rating = rating_seconds(plan_runs(design), load_mesh("coarse"))
    said = durations(design, "coarse", tmp_path)
    amounts = [float(one) for one in re.findall(r"about (\d+) s", said)]
    assert amounts == [pytest.approx(run, abs=10.0), pytest.approx(rating, abs=10.0)]
    assert rating > 2.0 * run
    assert durations(design, "none.toml", tmp_path) == ""
    assert "rating" not in durations(drive(), "", tmp_path)


def test_an_overlap_is_marked() -> None:
    design = drive(DRIVERS / "cup_45deg.toml")
    tight = design.with_values({"ring_gear.c_P": 1.01})
    assert clearances(tight.rigid_pairs)[0].overlaps
    marks = section_figure(tight)["data"][-1]
    assert marks["marker"]["symbol"] == "x" and "overlap" in marks["hovertemplate"]
    assert max(marks["marker"]["color"]) < 0.0


@pytest.mark.parametrize("name", ["cup_45deg.toml", "three_lobes.toml"])
def test_the_shade_of_an_overlap_is_as_deep_as_the_overlap(name: str) -> None:
    """On the whole path to 1 %, beside the search of the check; at an angle of the cam at most;
    none where teeth have clearance."""
    design, depths = drive(DRIVERS / name).with_values({"ring_gear.c_P": 1.03}), []
    ring, half_pitch = outline(design.profile("ring_gear")), np.pi / design.drive.teeth_rg
    profiles = [design.profile(gear) for gear in GEARS]
    slot = slot_overlap(*profiles, design.tooth_motion(), design.drive.module)
    for curves in (slot.path, slot.covered(0.3)):
        points = np.vstack(curves) @ (1.0, 1j) * np.exp(1j * half_pitch)
        depths.append(ring.distance(ring.folded(points)[0]).distance.min())
    known = clearances(design.rigid_pairs)[0].nearest.distance
    assert known < 0.0 and depths[0] == pytest.approx(known, rel=0.01)
    assert 1.001 * known < depths[1] < 0.9 * known
    names = [one["name"] for one in section_figure(drive(DRIVERS / name))["data"]]
    assert not any("overlap" in one for one in names)


def test_an_overlap_with_the_second_ring_gear_is_said_and_shaded() -> None:
    """The shade is as deep as the overlap, on the whole path and where the tooth of the largest one
    is; the second ring gear turns with the flexible spline."""
    design = drive(DATA / "pancake.toml").with_values({"dynamic_spline.c_P": 0.85})
    first, second = clearances(design.rigid_pairs)
    assert not first.overlaps and second.overlaps
    assert smallest_clearance(design.rigid_pairs) == second and "dynamic spline" in second.place
    teeth, turns = design.drive.teeth_rg, design.teeth("dynamic_spline").n_teeth
    ring, known = outline(design.profile("dynamic_spline")), second.nearest.distance
    angle = -second.nearest.psi * design.drive.teeth_fs / teeth  # tooth 0 is there then
    figure = section_figure(design, float(np.degrees(angle)))
    shades = [one for one in figure["data"] if "overlap" in one["name"]]
    assert len(shades) == 2 and all("dynamic spline" in one["name"] for one in shades)
    for shade in shades:
        x, y = (np.frombuffer(b64decode(shade[axis]["bdata"]), "<f4") for axis in "xy")
        points = (x + 1j * y)[np.isfinite(x)] * np.exp(-1j * angle * (1.0 - teeth / turns))
        depth = ring.distance(ring.folded(points * np.exp(1j * np.pi / turns))[0]).distance.min()
        assert depth == pytest.approx(known, rel=0.01)
    marks = [one for one in figure["data"] if one["name"] == "gaps"]
    words = [one["hovertemplate"].split(", ")[1].split(" %")[0] for one in marks]
    assert words == ["ring gear: gap", "dynamic spline: gap", "dynamic spline: overlap"]
    assert min(marks[-1]["marker"]["color"]) == pytest.approx(1e3 * known, rel=0.02)


@pytest.mark.parametrize(("c_P", "other_c_P"), [(0.98, 1.01), (1.01, 0.98)])
def test_a_change_moves_curves_and_marks(c_P: float, other_c_P: float) -> None:
    """Of designs with and without overlaps, where they stay so, and the view. Plotly takes marks
    for one another that share a name."""

    def rest(figure: dict[str, Any]) -> list[dict[str, Any]]:
        for trace in figure["data"]:
            ids = trace.pop("ids", [])
            assert len(ids) == len(set(ids))
            trace.get("marker", {}).pop("color", None)
            del trace["x"], trace["y"]
        return list(figure["data"])

    first = drive(DRIVERS / "cup_45deg.toml").with_values({"ring_gear.c_P": c_P})
    before = section_figure(first)
    for other, angle in (({"ring_gear.c_P": other_c_P}, 0.0), ({}, 7.0)):
        changed = section_figure(first.with_values(other), angle)
        assert moved(changed, before) == changed
    after = section_figure(first.with_values({"drive.addendum_coef": 0.57}))
    assert before["data"] != after["data"]
    assert moved(after, before) == after | {
        "layout": after["layout"] | {"transition": {"duration": 0}}
    }
    assert rest(before) == rest(after)


def test_a_picture_is_drawn_again_where_it_changes() -> None:
    """Not under another torque; at another angle, of other teeth, and for a state."""
    picture = TeethPicture(drive(), 3.0)
    assert picture.shows_the_same(TeethPicture(drive().with_values({"load.torque": 1.0}), 3.0))
    for other in (
        TeethPicture(drive().with_values({ADDENDUM: 0.55}), 3.0),
        TeethPicture(drive(), 4.0),
        TeethPicture(drive(), 3.0, loaded=True),
    ):
        assert not picture.shows_the_same(other)


def test_sliders_reach_both_sides_where_values_may_be_negative() -> None:
    """None where neither the value nor its range says how large a change is."""
    fields = {one.key: one for one in form_fields(drive())}
    crowning, slope = (
        dataclasses.replace(fields[f"micro_geometry.wg_{name}"], value=value)
        for name, value in (("crowning", 0.0), ("slope", 0.1))
    )
    assert slider_range(crowning, 0.5) == (0.0, 0.1)
    assert slider_range(slope, 0.5) == pytest.approx((-0.3, 0.3))
    assert slider_range(fields["contact.friction"], 0.5) == (0.0, 1.0)
    torque = dataclasses.replace(fields["load.torque"], value=0.0)
    assert slider_range(torque, 0.5) is None


def test_changes_are_undone_and_redone() -> None:
    variant = Variant("one", drive())
    before = variant.design.drive.addendum_coef
    variant.change({ADDENDUM: 0.55})
    variant.change({ADDENDUM: 0.55})
    assert len(variant.before) == 1
    assert variant.undo() and variant.design.drive.addendum_coef == before
    assert not variant.undo()
    assert variant.redo() and variant.design.drive.addendum_coef == 0.55
    with pytest.raises(InputError, match="is out of range"):
        variant.change({"drive.module": -3.0})
    assert variant.design.drive.module > 0.0
    variant.change({ADDENDUM: 0.56})
    assert not variant.redo()


def test_a_key_is_left_out() -> None:
    variant = Variant("one", drive().with_values({"flexible_spline.addendum_coef": 0.55}))
    variant.change({"flexible_spline.addendum_coef": None})
    assert "addendum_coef" not in variant.design.model_dump(exclude_unset=True)["flexible_spline"]


def test_a_workspace_keeps_every_change(tmp_path: Path) -> None:
    """A later one brings all variants back, with their changes; a file of the user is not replaced
    unasked."""
    workspace = Workspace(tmp_path)
    workspace.add("one", drive())
    workspace.variant.change({ADDENDUM: 0.55})
    workspace.keep()
    later = Workspace(tmp_path)
    later.bring_back()
    assert later.variants["one"].design.drive.addendum_coef == 0.55
    path = later.save()
    assert drive(path).drive.addendum_coef == 0.55
    with pytest.raises(OutputError, match="exists"):
        later.save()
    assert later.variant.undo() and later.variant.design.model_dump() == drive().model_dump()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[]", 'no lists "before" and "after"'),
        ('{"before": [], "after": [', 'no lists "before" and "after"'),
        ('{"before": [3], "after": []}', "is no design"),
        ('{"before": [{"drives": {}}], "after": []}', "drives"),
    ],
)
def test_changes_that_a_user_has_edited_are_refused_at_the_start(
    tmp_path: Path, text: str, sentence: str
) -> None:
    """With a sentence; the variant is there, and undo begins anew."""
    workspace = Workspace(tmp_path)
    workspace.add("one", drive())
    workspace.keep()
    (tmp_path / "variants" / "one.history.json").write_text(text)
    later = Workspace(tmp_path)
    later.bring_back()
    assert sentence in later.refused["variants/one.history.json"]
    assert "undo begins anew" in later.refused["variants/one.history.json"]
    assert not later.variants["one"].undo()


@pytest.mark.parametrize("name", ["../out", "", "a b", ".hidden", "x" * 61, "a/b", "--help"])
def test_names_that_are_no_files_of_the_workspace_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="is not allowed"):
        Workspace(tmp_path).add(name, drive())


def test_a_variant_that_is_a_link_is_not_written(tmp_path: Path) -> None:
    outside = tmp_path / "outside.toml"
    folder = tmp_path / "workspace"
    folder.mkdir()
    (folder / "one.toml").symlink_to(outside)
    workspace = Workspace(folder)
    workspace.add("one", drive())
    with pytest.raises(OutputError, match="is a link"):
        workspace.save(overwrite=True)
    assert not outside.exists()


def waited(queue: JobQueue, done: Callable[[], bool]) -> None:
    for _ in range(600):
        queue.step()
        if done():
            return
        time.sleep(0.1)
    raise AssertionError("the jobs have not ended")


def test_jobs_follow_each_other(tmp_path: Path) -> None:
    """One that fails has its sentence; a cancelled one never begins; the record survives."""
    queue = JobQueue(tmp_path)
    good = queue.add(["check", str(DESIGN)], "results/1")
    bad = queue.add(["check", "none.toml"], "results/2")
    never = queue.add(["check", str(DESIGN)], "results/3")
    assert good.state == JobState.RUNS and bad.state == JobState.WAITS
    queue.cancel(never)
    waited(queue, lambda: bad.state not in (JobState.WAITS, JobState.RUNS))
    assert (good.state, bad.state) == (JobState.FINISHED, JobState.FAILED)
    assert never.state == JobState.CANCELLED
    assert "none.toml cannot be read" in bad.reason
    assert [job.state for job in JobQueue(tmp_path).jobs] == [job.state for job in queue.jobs]
    assert good.typed == f"swgpar check {DESIGN}"


def test_a_rating_without_its_section_is_refused_before_it_waits(tmp_path: Path) -> None:
    workspace = Workspace(tmp_path)
    workspace.add("drive", drive())
    state = AppState(workspace, JobQueue(tmp_path), Choices())
    with pytest.raises(InputError, match=r"rating is missing: swgpar rate needs the section"):
        state.queue_design("rate", (), 1)
    assert not state.queue.jobs


@pytest.mark.parametrize(
    ("printed", "reason"),
    [
        ("swgpar: error: no file\n-----\nmpirun detected that\n-----\n", "swgpar: error: no file"),
        ("Traceback\nKeyError: 1\n-----\nMPI_ABORT was invoked\n-----\n", "KeyError: 1"),
        ("", "it has printed nothing"),
    ],
)
def test_a_failed_job_has_its_own_sentence(tmp_path: Path, printed: str, reason: str) -> None:
    """Not the last line of mpirun."""
    job = {"number": 1, "arguments": ["run", "one.toml"], "ranks": 2, "out": "results/1"}
    job |= {"state": "runs", "process": 2**22 + 1}  # no process has such a number
    (tmp_path / "jobs.json").write_text(json.dumps({"jobs": [job]}), encoding="utf-8")
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs" / "1.log").write_text(printed, encoding="utf-8")
    queue = JobQueue(tmp_path)
    assert queue.step() and queue.jobs[0].reason == reason


def test_the_plane_model_of_a_cup_is_a_design() -> None:
    for name in ("cup_45deg.toml", "silk_hat.toml", "rating.toml"):
        design = drive(DRIVERS / name)
        plane = swgpar.load_design(plane_table(design))
        assert isinstance(plane, DriveDesign)
        assert plane.drive.model == "plane" and plane.load.torque == design.load.torque


def answered(scope: dict[str, Any]) -> list[dict[str, Any]]:
    """What the gate sends to a request."""
    sent: list[dict[str, Any]] = []

    async def page(scope: Any, receive: Any, send: Any) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def send(message: Any) -> None:
        sent.append(message)

    async def receive() -> dict[str, Any]:
        return {"type": "http.request"}

    base = {"type": "http", "query_string": b"", "headers": [(b"host", b"127.0.0.1:8000")]}
    asyncio.run(TokenGate(page, "secret", 8000)(base | scope, receive, send))
    return sent


def test_the_token_opens_the_page_and_sets_the_cookie() -> None:
    (start,) = answered({"query_string": b"token=secret"})
    assert start["status"] == 200
    headers = dict(start["headers"])
    assert f"{COOKIE}=secret".encode() in headers[b"set-cookie"]
    assert b"default-src 'self'" in headers[b"content-security-policy"]
    cookie = (b"cookie", f"{COOKIE}=secret".encode())
    (start,) = answered({"headers": [(b"host", b"127.0.0.1:8000"), cookie]})
    assert start["status"] == 200


@pytest.mark.parametrize(
    "scope",
    [
        {},
        {"query_string": b"token=wrong"},
        {"query_string": b"token=secret", "headers": [(b"host", b"elsewhere.example")]},
        {
            "query_string": b"token=secret",
            "headers": [(b"host", b"127.0.0.1:8000"), (b"origin", b"http://elsewhere.example")],
        },
        {"headers": [(b"host", b"127.0.0.1:8000"), (b"cookie", b"swgpar_token=\xff")]},
    ],
)
def test_other_requests_are_refused(scope: dict[str, Any]) -> None:
    assert answered(scope)[0]["status"] == 403
    (closed,) = answered({"type": "websocket", **scope})
    assert closed["type"] == "websocket.close"


def test_a_slider_is_one_step_of_undo() -> None:
    variant = Variant("one", drive())
    before = variant.design.drive.addendum_coef
    for value in (0.58, 0.57, 0.56):
        variant.change({ADDENDUM: value}, dragged=ADDENDUM)
    assert variant.undo() and variant.design.drive.addendum_coef == before
    assert not variant.undo()


@pytest.mark.parametrize("name", DESIGNS)
def test_a_saved_design_has_the_meaning_of_its_keys_and_is_the_same(name: str) -> None:
    variant = Variant("one", drive(DRIVERS / name))
    assert drive_of(tomllib.loads(variant.text), {}).model_dump() == variant.design.model_dump()
    assert re.search(r"^module = \S+ +# module \(mm\)$", variant.text, re.MULTILINE)


def test_a_section_is_added_and_left_out() -> None:
    """The housing needs its thickness, the stiffness nothing."""
    variant = Variant("one", drive())
    missing = {one.name: one for one in missing_sections(variant.design)}
    assert [one.key for one in missing["ring_gear.housing"].required] == [
        "ring_gear.housing.thickness"
    ]
    assert missing["stiffness"].required == [] and not is_optional(variant.design, "drive")
    variant.change({"ring_gear.housing": {"thickness": 4.0}})
    assert variant.design.ring_gear.housing.thickness == 4.0
    assert "ring_gear.housing" not in {one.name for one in missing_sections(variant.design)}
    assert is_optional(variant.design, "ring_gear.housing")
    variant.change({"ring_gear.housing": None})
    assert variant.design.ring_gear.housing is None


def test_keys_that_differ() -> None:
    first = drive()
    second = first.with_values({ADDENDUM: 0.55, "ring_gear.housing.thickness": 4.0})
    found = {one.key: (one.first, one.second) for one in differences(first, second)}
    assert found[ADDENDUM] == (first.drive.addendum_coef, 0.55)
    assert found["ring_gear.housing.thickness"] == (None, 4.0)
    assert all(key == ADDENDUM or key.startswith("ring_gear.housing") for key in found)
    assert differences(first, first) == []


@pytest.mark.parametrize(
    ("value", "sense", "limit", "used"),
    [(50.0, "at most", 200.0, 0.25), (4.0, "at least", 2.0, 0.5), (3.0, "", None, None)],
)
def test_share_of_a_limit(
    tmp_path: Path, value: float, sense: str, limit: float | None, used: float | None
) -> None:
    row = dict.fromkeys((field.name for field in dataclasses.fields(StoredRow)), "")
    row |= {"verdict": "passes", "value": value, "limit": limit, "sense": sense, "error": None}
    sheet = {"format": 1, "title": "one", "headline": "passes", "rows": [row]}
    (tmp_path / "rating.json").write_text(json.dumps(sheet), encoding="utf-8")
    assert read_sheet(tmp_path).rows[0].used == used
    (tmp_path / "rating.json").write_text("{}", encoding="utf-8")
    with pytest.raises(OutputError, match="cannot be read"):
        read_sheet(tmp_path)


def stored(row: str, value: float | None, error: float | None, verdict: str) -> StoredRow:
    rest = dict.fromkeys((field.name for field in dataclasses.fields(StoredRow)), "")
    known = {"row": row, "value": value, "unit": "MPa", "error": error, "verdict": verdict}
    return StoredRow(**{**rest, "limit": None, **known})


def test_what_differs_between_two_ratings() -> None:
    """Rows with the same value and verdict are left out; an error needs both."""
    first = (stored("yield", 500.0, 5.0, "passes"), stored("life", 9.0, None, "passes"))
    second = (stored("yield", 530.0, 6.0, "fails"), stored("life", 9.0, None, "passes"))
    sheets = [StoredSheet("one", Judgement.FAILS, rows) for rows in (first, second)]
    (found,) = sheet_differences(*sheets)
    assert (found.name, found.unit, found.change, found.error) == ("yield", "MPa", 30.0, 11.0)
    assert sheet_differences(sheets[0], sheets[0]) == []
    other = StoredSheet("other", Judgement.FAILS, (stored("life", 8.0, 1.0, "passes"),))
    gone, life = sorted(sheet_differences(sheets[0], other), key=lambda one: one.name == "life")
    assert gone.name == "yield" and gone.change is None
    assert life.change == -1.0 and life.error is None


def test_the_verdict_of_a_rating_that_runs_is_not_the_last_one(tmp_path: Path) -> None:
    """A job without a sheet has none."""
    job = AppJob(1, ["rate", "one.toml"], 1, "results/1", state=JobState.RUNS)
    known = StoredSheet("one", Judgement.FAILS, (), "The drive fails: yield of wall.")
    assert verdict_text(job, known) == "rating runs, so far: The drive fails: yield of wall."
    job.state = JobState.FINISHED
    assert verdict_text(job, known) == "The drive fails: yield of wall."
    assert sheet_of(tmp_path, job) is None and sheet_of(tmp_path, None) is None


def test_a_rating_that_runs_says_where_it_is(tmp_path: Path) -> None:
    """Its own lines, and the last one of the log of its run."""
    queue, (logs, run) = JobQueue(tmp_path), (tmp_path / "logs", tmp_path / "results/1/runs/rated")
    for folder in (logs, run):
        folder.mkdir(parents=True)
    (logs / "1.log").write_text("one\ntwo\n", encoding="utf-8")
    (run / "run.log").write_text("2026-01-01 10:00:00,000  INFO     2/4  load\n", encoding="utf-8")
    job = AppJob(1, ["rate", "one.toml"], 1, "results/1", begun=time.time() - 125.0)
    assert queue.progress(job).splitlines() == ["for 2 min", "one", "two", "rated: 2/4  load"]


def test_tried_designs_of_a_search(tmp_path: Path) -> None:
    """Each one is the design file with what is set and with its variables; figures have units, and
    whole numbers whole ticks."""
    (tmp_path / "optimise.csv").write_text(
        "rank,evaluation,wave_generator.beta,wave_generator.C,status,best,mean.fs_vm\n"
        "1,3,44.5,0.996,feasible,1,230.5\n,4,50.0,0.999,failed,0,\n",
        encoding="utf-8",
    )
    tried = read_tried(DRIVERS / "optimise" / "arcs.toml", tmp_path)
    assert tried.best == [3] and tried.evaluations[4].quantities == {}
    assert tried.evaluations[3].quantities["mean.fs_vm"] == 230.5
    design = drive_of(tried.table(3), {})
    assert design.wave_generator.type == "arcs" and design.wave_generator.beta == 44.5
    figure = pair_figure(tried, EVALUATION, "mean.fs_vm")
    (best,) = figure["data"]  # the failed one has no value
    assert best["name"] == "best" and best["customdata"] == [3]
    assert "mean.fs_vm = 230.5 MPa" in best["text"][0] and "= 44.5 deg" in best["text"][0]
    assert figure["layout"]["yaxis"]["title"]["text"] == "mean.fs_vm (MPa)"
    assert figure["layout"]["xaxis"]["dtick"] == 1
    lines = parallel_figure(tried)["data"]
    assert [line["name"] for line in lines] == ["failed", "best"]
    assert lines[1]["y"][:2] == pytest.approx([0.3, 0.2])  # between the bounds


def largest_distance(state: ShownState, design: DriveDesign) -> float:
    """Of the contacts that are drawn from the flanks of the rigid ring gear, mm."""
    ring, half_pitch = outline(design.profile("ring_gear")), np.pi / design.drive.teeth_rg
    assert state.outline is not None
    points = state.outline.pairs.place @ (1.0, 1j) * np.exp(1j * half_pitch)
    return float(np.abs(ring.distance(ring.folded(points)[0]).distance).max())


def test_the_loaded_state_is_that_of_the_interface() -> None:
    """Largest tension, balance of shares, and forces of the pairs, in the whole drive."""
    table = plane_table(drive(DESIGN))
    state = solve_state(table, PLANE.mesh, open_session())
    assert state.reason == "" and state.outline is not None
    values = {one.name: one.value for one in state.answers}
    outline = state.outline
    assert outline.s1.max() == pytest.approx(
        max(values["largest.fs_s1"], values["largest.rg_s1"]), rel=1e-6
    )
    assert outline.pairs.share.sum() == pytest.approx(1.0)
    assert len(outline.pairs.force) == values["sharing.pairs"]
    assert outline.pairs.share.max() == pytest.approx(values["sharing.largest_force_share"])
    assert largest_distance(state, drive(DESIGN)) < 0.03


def test_the_loaded_state_in_3d_is_that_of_the_interface() -> None:
    """Answers and their places; the picture has the nodes at mid-width."""
    table = SOLID.table(drive())
    state, result = solve_state(table, RECIPE, open_session()), swgpar.run(table, RECIPE)
    assert state.reason == "" and state.outline is not None
    known = {one.name: one for one in result.summary.answers()}
    assert {"largest.fs_s1", "largest.fs_vm", "sharing.pairs"} <= {
        one.name for one in state.answers
    }
    for one in state.answers:
        assert one.value == pytest.approx(known[one.name].value, rel=1e-9)
        assert one.place == known[one.name].place
    largest = []
    for gear in GEARS:
        middle = np.abs(result.mesh(gear).points[:, 2]) < 1e-9
        largest.append(result.field("s1", body=gear)[middle].max())
    # the teeth are in tension at their surface
    assert state.outline.s1.max() == pytest.approx(max(largest), rel=1e-9)
    assert state.outline.pairs.share.sum() == pytest.approx(1.0)
    # contacts lie beside mid-width, where the deflection is another one
    assert largest_distance(state, drive()) < 0.1


def test_a_folder_shows_its_designs(tmp_path: Path) -> None:
    """Not those with a hostile name, links, gear trains and other files."""
    text = DESIGN.read_text(encoding="utf-8")
    for name in ("two", "one", "<img src=x onerror=alert(1)>"):
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
    (tmp_path / "link.toml").symlink_to(DESIGN)
    shutil.copy(DRIVERS / "gear_pair.toml", tmp_path)
    shutil.copy(RECIPE, tmp_path)
    workspace = Workspace(tmp_path)
    workspace.open_all()
    assert sorted(workspace.variants) == ["one", "two"] and workspace.shown == "one"
    assert recipes_of(tmp_path) == [RECIPE.name]
    assert workspace.free_name("one") == "one_2"
    assert workspace.free_name("<b>") == "_b_"


def test_jobs_have_nothing_of_the_mpi_of_their_server(monkeypatch: pytest.MonkeyPatch) -> None:
    """A server that is started by a process with MPI inherits all of it."""
    names = {"PMIX_RANK", "OMPI_MCA_ess", "OMPI_MCA_orte_launch", "OMPI_COMM_WORLD_RANK"}
    for name in names:
        monkeypatch.setenv(name, "0")
    monkeypatch.setenv("OMPI_ALLOW_RUN_AS_ROOT", "1")
    found = shell_environment()
    assert found["OMPI_ALLOW_RUN_AS_ROOT"] == "1"
    assert not names & found.keys()


def test_a_state_without_a_torque_has_no_pairs() -> None:
    """Its picture has the tension by the cam alone."""
    idle = drive(DESIGN).with_values({"load.torque": 0.0})
    state = solve_state(plane_table(idle), RECIPE, open_session())
    assert state.reason == "" and state.answers and state.outline is not None
    assert state.outline.s1.size and not state.outline.pairs.force.size
    assert section_figure(idle, loaded=state.outline)["data"]


def test_progress_of_a_state_counts_residuals(monkeypatch: pytest.MonkeyPatch) -> None:
    """After the last line of the log; a message from the server gives the state up."""
    ours, theirs = Pipe()
    progress = RunProgress(theirs)
    progress.emit(logging.LogRecord("swgpar", logging.INFO, "", 0, " 24 elements", None, None))
    assert not progress.stops()
    monkeypatch.setattr("swgpar.app.state_worker.SAID", -1.0)
    assert not progress.stops()
    assert [ours.recv(), ours.recv()] == ["24 elements", "24 elements; 2 residuals"]
    assert not ours.poll()
    ours.send(None)
    assert progress.stops()
