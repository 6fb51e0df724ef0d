"""`swgpar new`: starter designs are valid, checked and commented, and keep what is given."""

from __future__ import annotations

import csv
import re
import tomllib
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

import swgpar
from swgpar.checks.remarks import remarks
from swgpar.checks.starter import LARGEST_RATIO, LEAST_RATIO, Request, starter_design
from swgpar.checks.starter_cam import CamType
from swgpar.checks.starter_file import as_toml
from swgpar.checks.starter_teeth import PROFILE_KEYS, Profile
from swgpar.checks.starter_torques import (
    CARRIED,
    carried_torque,
    overload,
    torque_text,
)
from swgpar.cli import main, parser
from swgpar.errors import InputError, OutputError
from swgpar.geometry.cams import taut_length

RATIOS = (LEAST_RATIO, 30.0, 80.5, 160.0, LARGEST_RATIO)


@pytest.mark.parametrize("profile", get_args(Profile))
@pytest.mark.parametrize("ratio", RATIOS)
def test_a_starter_design_clears_and_can_be_meshed(ratio: float, profile: Profile) -> None:
    model = "cup" if profile == "double_arc" else "plane"
    design = swgpar.new(ratio=ratio, diameter=50.0, torque=10.0, profile=profile, model=model)
    # other angles and points than those of the search
    assert design.rigid_teeth().clearance() > 0.0 and design.backlash > 0.0


@pytest.mark.parametrize(
    ("ratio", "least_share", "most_error"),
    # the teeth of ratio 30 are lower than those of arcs by a half, and mesh over less of their path
    [(30.0, 1.0, 0.5), (80.0, 1.5, 0.3), (100.0, 1.5, 0.3), (320.0, 1.5, 0.3)],
)
def test_a_cup_is_one_that_is_built(ratio: float, least_share: float, most_error: float) -> None:
    design = swgpar.new(ratio=ratio, diameter=50.8, torque=10.0)
    assert remarks(design) == []
    assert (design.flexible_spline.profile.type, design.ring_gear.profile.type) == (
        "s_shaped",
        "conjugate",
    )
    assert design.bearing is not None and design.micro_geometry.wg_slope == 0.0
    cup = design.cup
    assert cup.attachment == "clamped" and cup.clamping_radius > cup.inner_radius
    assert 0.0 < cup.back_fillet < (1.0 - cup.thickness_coef) * design.flexible_spline.rim
    arcs = swgpar.new(ratio=ratio, diameter=50.8, torque=10.0, profile="quadruple_arc")
    found, before = swgpar.check(design), swgpar.check(arcs)
    assert found["smallest flank clearance, kinematic (mm)"] > 0.0
    error, share = (
        "transmission error of rigid teeth (arcsec)",
        "share of rigid teeth within 1 µm of contact",
    )
    assert found[error] < most_error * before[error]
    assert found[share] > least_share * before[share]


def test_drives_of_one_ratio_are_similar() -> None:
    """So stresses depend on the torque over the third power of the diameter only."""
    small, large = (starter_design(Request(80.0, 1.0, diameter=d))[1] for d in (8.0, 64.0))
    lengths = 0

    def compare(one: dict, other: dict) -> None:
        nonlocal lengths
        for key, value in one.items():
            if isinstance(value, dict):
                compare(value, other[key])
            elif isinstance(value, float) and value != other[key]:
                assert other[key] == pytest.approx(8.0 * value, rel=2e-3), key  # rounded
                lengths += 1

    compare(small, large)
    assert lengths > 10


def test_the_file_names_its_sources() -> None:
    request = Request(80.0, 1.0, diameter=50.0, profile="s_shaped")
    text = as_toml(request, *starter_design(request), "drive.toml")
    for source in ("US 4,823,638", "EP 1 628 045", "US 8,770,064", "s10033-021-00621-z"):
        assert source in text


RATED = Path(__file__).parents[2] / "docs/verification/data/starter_ratings.csv"


def test_the_torques_of_starts_are_those_of_their_ratings() -> None:
    """Of every ratio the table has the largest torque whose sheet has no row about strength that
    fails or is within its error."""
    with RATED.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    carried: dict[float, float] = {}
    for row in rows:
        if not row["strength"]:
            share = 1e3 * float(row["torque"]) / float(row["diameter"]) ** 3
            ratio = float(row["ratio"])
            carried[ratio] = max(carried.get(ratio, 0.0), share)
    assert carried == pytest.approx(CARRIED, rel=1e-3) and list(CARRIED) == sorted(CARRIED)
    page = (RATED.parents[1] / "starter.md").read_text(encoding="utf-8")
    table = page.partition("<!-- starter_ratings -->")[2].partition("<!-- end of")[0]
    assert len(rows) == table.count("\n") - 3
    for row in rows:
        start = " | ".join(f"{float(row[key]):g}" for key in ("ratio", "diameter", "torque"))
        assert f"| {start} |" in table


def test_a_torque_that_is_too_large_is_said_in_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    ratio, share = next(iter(CARRIED.items()))
    carried = 1e-3 * share * 20.0**3
    words = ["new", str(tmp_path / "d.toml"), "--ratio", f"{ratio:g}", "--diameter", "20"]
    assert main([*words, "--torque", f"{8.0 * carried:.6f}"]) == 0
    (said,) = [record.getMessage() for record in caplog.records]
    named = re.search(r"up to ([\d.]+) N·m, .* with a pitch diameter of ([\d.]+) mm$", said)
    assert named is not None and "\n" not in said
    # rounded to the safe side, to three digits
    assert 0.99 * carried <= float(named[1]) <= carried
    assert 40.0 <= float(named[2]) <= 40.4
    assert said in (tmp_path / "d.toml").read_text(encoding="utf-8")
    caplog.clear()
    assert main([*words, "--torque", f"{0.9 * carried:.6f}", "--overwrite"]) == 0
    assert not caplog.records
    assert f"carries up to {named[1]} N·m" in (tmp_path / "d.toml").read_text(encoding="utf-8")
    # module 0.8333 mm, so that the pitch diameter is 49.998 mm
    words[-1] = "50"
    assert main([*words, "--torque", f"{1e-3 * share * 50.0**3:g}", "--overwrite"]) == 0
    assert not caplog.records


def test_the_torque_of_other_starts_is_not_named() -> None:
    below = Request(min(CARRIED) - 5.0, 200.0, diameter=50.0, profile="s_shaped")
    arcs = Request(min(CARRIED), 200.0, diameter=50.0)
    for request in (below, arcs):
        design, _ = starter_design(request)
        assert carried_torque(request, design) is None and overload(request, design) == ""
        assert "has not been computed" in torque_text(request, design)


NO_ROOM = {(15.0, "four_roller"), (160.0, "parabolic"), (320.0, "parabolic")}
"""Ratios and cams with which the flanks of the quadruple arc interfere at any backlash.

The parabolas with the ratio 160 overlap by 0.02 modules; the motion of first order in the
deflection had found room."""


@pytest.mark.parametrize("cam", get_args(CamType))
@pytest.mark.parametrize("ratio", RATIOS)
def test_a_cam_fits_a_ratio_or_is_refused(ratio: float, cam: CamType) -> None:
    if (ratio, cam) in NO_ROOM:
        with pytest.raises(InputError, match="leaves no clearance between the flanks"):
            starter_design(Request(ratio, 10.0, bore=60.0, cam=cam))
        return
    design, _ = starter_design(Request(ratio, 10.0, bore=60.0, cam=cam))
    assert design.wave_generator.type == cam
    stretch = taut_length(design.cam()) / (2.0 * np.pi * design.inner_radius) - 1.0
    if cam != "four_roller":  # its rollers leave the spline free in between
        assert (
            abs(stretch) < 2.0 * (design.deflection / design.inner_radius) ** 2
        )  # an ellipse: 0.047 of it
    if cam in ("parabolic", "simplified", "harmonic"):
        assert abs(stretch) < 2e-4  # chosen for it, and rounded


@pytest.mark.parametrize("ratio", [55.0, 80.0])
def test_s_shaped_teeth_on_a_parabolic_cam_have_their_relief(ratio: float) -> None:
    """Their conjugate flank has a corner, which a relief keeps."""
    design = swgpar.new(ratio=ratio, diameter=50.0, torque=5.0, cam="parabolic", profile="s_shaped")
    assert design.ring_gear.tip_relief > 0.0
    relieved, given = design.profile("ring_gear"), design.profile("ring_gear", relief=False)
    corners = [np.abs(flank.kinks).max() for flank in (relieved, given)]
    assert corners[1] > 0.1 and corners[0] == pytest.approx(corners[1], rel=0.01)


def test_teeth_that_cannot_be_built_are_refused_by_what_was_asked_for() -> None:
    refusal = (
        r"^ratio = 120 with .* gives no teeth that can be built.*: allowed are cam = elliptical or "
        r"four_roller or harmonic, profile = quadruple_arc or double_arc or involute, or other"
    )
    with pytest.raises(InputError, match=refusal):
        starter_design(Request(120.0, 5.0, diameter=60.0, cam="parabolic", profile="s_shaped"))


@pytest.mark.parametrize("layout, ratio", [("ring_fixed", -40.0), ("spline_fixed", 40.0)])
@pytest.mark.parametrize("profile", PROFILE_KEYS)
def test_three_lobes_give_whole_ratios(profile: Profile, layout: str, ratio: float) -> None:
    request = Request(
        40.0,
        10.0,
        diameter=60.0,
        profile=profile,
        cam="harmonic",
        layout=layout,
        model="plane",
        lobes=3,
    )
    design, _ = starter_design(request)
    assert (
        design.kinematics.ratio,
        design.wave_generator.lobes,
        design.drive.teeth_rg - design.drive.teeth_fs,
    ) == (
        ratio,
        3,
        3,
    )
    assert design.drive.teeth_fs % 3 == 0 and design.rigid_teeth().clearance() > 0.0
    assert abs(taut_length(design.cam()) / (2.0 * np.pi * design.inner_radius) - 1.0) < 1e-5


@pytest.mark.parametrize("profile", PROFILE_KEYS)
@pytest.mark.parametrize("ratio", RATIOS)
def test_a_pancake_clears_in_both_ring_gears(ratio: float, profile: Profile) -> None:
    request = Request(ratio, 10.0, diameter=100.0, profile=profile, model="pancake")
    design, table = starter_design(request)
    assert (
        design.rigid_teeth().clearance() > 0.0
        and design.rigid_teeth("dynamic_spline").clearance() > 0.0
    )
    assert design.dynamic_spline.c_P > 0.6  # thinner teeth are lost motion
    assert "[dynamic_spline.profile]" in as_toml(request, design, table, "drive.toml")


@pytest.mark.parametrize("layout, ratio", [("ring_fixed", -75.0), ("spline_fixed", 75.0)])
def test_what_is_given_is_kept(layout: str, ratio: float) -> None:
    design, _ = starter_design(Request(75.0, 33.0, bore=61.7, layout=layout))
    assert design.kinematics.ratio == ratio and design.load.torque == 33.0
    assert 2.0 * design.inner_radius == pytest.approx(
        61.7, rel=1e-5
    )  # the module is rounded to six digits
    pitch = starter_design(Request(75.0, 33.0, diameter=61.7))[0].drive
    assert pitch.module * pitch.teeth_fs == pytest.approx(61.7, rel=1e-5)


@pytest.mark.parametrize(
    "profile, cam",
    [
        *zip(get_args(Profile), get_args(CamType)),
        ("involute", "parabolic"),
        ("involute", "harmonic"),
    ],
)
def test_every_key_of_the_file_has_its_meaning(profile: Profile, cam: CamType) -> None:
    request = Request(100.0, 52.0, diameter=50.8, profile=profile, cam=cam)
    design, table = starter_design(request)
    text = as_toml(request, design, table, "drive.toml")
    assert swgpar.load_design(tomllib.loads(text)) == design
    keys = [line for line in text.splitlines() if line and line[0] not in "#["]
    assert all(line.partition("#")[2].strip() for line in keys) and len(keys) > 25


@pytest.mark.parametrize(
    "values, words",
    [
        ({"ratio": 10.0, "diameter": 50.0}, "ratio = 10 is out of range: allowed 15 to 320"),
        ({"ratio": 50.2, "diameter": 50.0}, "steps of 0.5"),
        ({"ratio": 50.0}, "either diameter"),
        ({"ratio": 40.5, "diameter": 50.0, "lobes": 3}, "steps of 1"),
        (
            {"ratio": 40.0, "diameter": 50.0, "lobes": 3, "cam": "elliptical"},
            'allowed with "harmonic"',
        ),
        ({"ratio": 40.0, "diameter": 50.0, "lobes": 4}, "lobes = 4 is not available"),
        ({"ratio": 50.0, "diameter": 50.0, "bore": 48.0}, "either diameter"),
        ({"ratio": 50.0, "diameter": -1.0}, "diameter = -1"),
        ({"ratio": 50.0, "bore": float("nan")}, "bore = nan"),
    ],
)
def test_requests_that_make_no_drive(values: dict[str, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        swgpar.new(torque=10.0, **values)


def test_the_command_writes_the_file_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "drive.toml"
    words = [
        "new",
        str(path),
        "--ratio",
        "50",
        "--diameter",
        "42",
        "--torque",
        "5",
        "--model",
        "plane",
    ]
    assert main(words) == 0
    assert "100 and 102 teeth, module 0.42 mm" in capsys.readouterr().out
    assert swgpar.load_design(path) == swgpar.new(
        ratio=50.0, diameter=42.0, torque=5.0, model="plane"
    )
    assert main(words) == OutputError.exit_code and "exists" in capsys.readouterr().err
    assert main([*words, "--overwrite"]) == 0


def test_the_command_offers_all_profiles_and_cams() -> None:
    words = ["new", "drive.toml", "--ratio", "50", "--bore", "42", "--torque", "5"]
    for name, kind in (("--profile", Profile), ("--cam", CamType)):
        for choice in get_args(kind):
            assert getattr(parser().parse_args([*words, name, choice]), name.strip("-")) == choice
