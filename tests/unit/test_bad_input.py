"""Bad design files: one sentence with key, value and range or reason, exit code 2."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

import swgpar
from support.paths import DATA, DESIGN, REFERENCE
from swgpar import load_design
from swgpar.errors import InputError
from swgpar.input.quantities import Section, quantity
from swgpar.input.refusals import sentence

OVERRIDES = [
    ("drive.teeth_fs=-120", "drive.teeth_fs", "-120"),
    ("drive.teeth_fs=0", "drive.teeth_fs", "0"),
    ("drive.teeth_fs=120.5", "drive.teeth_fs", "120.5"),
    ("drive.teeth_fs=true", "drive.teeth_fs", "true"),
    ("drive.teeth_rg=121", "drive.teeth_rg", "multiple of two"),
    ("drive.teeth_rg=118", "drive.teeth_rg", "multiple of two"),
    ("drive.teeth_rg=120", "drive.teeth_rg", "multiple of two"),
    ("drive.module=0", "drive.module", "above 0"),
    ("drive.module=-1.0", "drive.module", "above 0"),
    ("drive.module=nan", "drive.module", "finite"),
    ("drive.module=inf", "drive.module", "finite"),
    ('drive.module="1"', "drive.module", "a number"),
    ("drive.pressure_angle=0", "drive.pressure_angle", "above 0"),
    ("drive.pressure_angle=60", "drive.pressure_angle", "45"),
    ("drive.addendum_coef=-0.6", "drive.addendum_coef", "0 to 2 modules"),
    ("drive.dedendum_coef=9", "drive.dedendum_coef", "2"),
    ("drive.face_width=0", "drive.face_width", "above 0"),
    ("drive.face_width=-10", "drive.face_width", "-10"),
    ('drive.layout="sideways"', "drive.layout", '"spline_fixed" or "wave_generator_fixed"'),
    ('drive.model="solid"', "drive.model", '"cup" or "plane" or "pancake"'),
    ("drive.model=pancake", "dynamic_spline", 'drive.model = "pancake" needs it'),
    ("dynamic_spline.gap=1", "dynamic_spline", "missing"),
    ("drive.model=plane", "micro_geometry.wg_crowning", 'only 0 with drive.model = "plane"'),
    ("drive.tooth_count=3", "drive.tooth_count", "not a key"),
    ("flexible_spline.rim=0", "flexible_spline.rim", "above 0"),
    ("flexible_spline.rim=nan", "flexible_spline.rim", "finite"),
    ("flexible_spline.c_P=0", "flexible_spline.c_P", "above 0"),
    ("flexible_spline.c_l=2", "flexible_spline.c_l", "1"),
    ("flexible_spline.profile.r_tip=-0.5", "flexible_spline.profile.r_tip", "above 0"),
    ("flexible_spline.profile.r_tip=3.0", "flexible_spline.profile", "r_tip"),
    ("flexible_spline.profile.r_root=40.0", "flexible_spline.profile", "r_root"),
    ("ring_gear.housing.thickness=0", "ring_gear.housing.thickness", "above 0"),
    ("ring_gear.housing.thickness=500", "ring_gear.housing.thickness", "0.01 to 100 mm"),
    ("ring_gear.housing.material={E=70e3, nu=0.3}", "ring_gear.housing.thickness", "missing"),
    (
        'ring_gear.housing={thickness=5, outside="bolted"}',
        "ring_gear.housing.outside",
        '"free" or "held"',
    ),
    ("flexible_spline.temperature=60", "material.expansion is missing", "flexible_spline"),
    ("flexible_spline.temperature=-300", "flexible_spline.temperature", "-273.15 to 1000 °C"),
    ("ring_gear.temperature=inf", "ring_gear.temperature", "finite"),
    ("material.expansion=12", "material.expansion", "0.001 1/K"),
    ("wave_generator.temperature=60", "wave_generator.expansion is missing", "needs it"),
    ("ring_gear.frame.temperature=60", "ring_gear.frame.expansion is missing", "needs it"),
    ("ring_gear.frame.interference=-0.1", "ring_gear.frame.interference", "0 to 1000000 mm"),
    ("ring_gear.frame.interference=2", "strain of the growth of ring_gear.frame", "up to 0.01"),
    (
        "ring_gear.housing={thickness=5, interference=2}",
        "strain of the growth of ring_gear.housing",
        "up to 0.01",
    ),
    ("ring_gear.profile.r_root=5.0", "ring_gear.profile", "allowed"),
    ("ring_gear.profile.straight_l=-1", "ring_gear.profile.straight_l", "0"),
    ('ring_gear.profile.type="square"', "ring_gear.profile.type", "square"),
    ("ring_gear.profile.r_dedendum=0", "ring_gear.profile.r_dedendum", "above 0"),
    ("wave_generator.C=0", "wave_generator.C", "above 0"),
    ("wave_generator.C=1.5", "wave_generator.C", "1"),
    ("wave_generator.face_width=-1", "wave_generator.face_width", "above 0"),
    ("wave_generator.face_width=90", "wave_generator.face_width", "allowed"),
    ('wave_generator.type="round"', "wave_generator.type", "elliptical"),
    ("cup.length=0", "cup.length", "above 0"),
    ("cup.fillet_radius=0.5", "cup.fillet_radius", "0.8"),
    ("cup.fillet_radius=50", "cup.fillet_radius", "allowed"),
    ("cup.inner_radius=80", "cup.inner_radius", "allowed"),
    ("cup.back_fillet=0.5", "cup.back_fillet", "rim less wall"),
    ("cup.inner_radius=-2", "cup.inner_radius", "above 0"),
    ("cup.thickness_coef=1.4", "cup.thickness_coef", "0.1 to 1"),
    ("micro_geometry.wg_crowning=-0.1", "micro_geometry.wg_crowning", "0"),
    ("micro_geometry.wg_crowning=5", "micro_geometry.wg_crowning", "allowed"),
    ("wave_generator.face_width=0.35", "micro_geometry.wg_crowning", "0 to 0.0875 mm"),
    ("micro_geometry.wg_slope=-1.9", "micro_geometry.wg_slope", "quarter of the cam's width"),
    ("micro_geometry.fs_crowning=2", "micro_geometry.fs_crowning", "allowed"),
    ("micro_geometry.wg_slope=nan", "micro_geometry.wg_slope", "finite"),
    ("material.E=0", "material.E", "above 0"),
    ("material.nu=0.5", "material.nu", "0.499"),
    ("material.nu=-0.1", "material.nu", "0"),
    ("load.torque=-3", "load.torque", "0"),
    ("load.torque=20000", "load.torque", "up to"),  # meant in N·mm
    ('load.program=[{name="a", torque=-20000}]', "load.program.1.torque", "up to"),
    ("steps.increment=0", "steps.increment", "0.01 to 45 deg"),
    ("steps.rotation=-45", "steps.rotation", "0"),
    ("contact.quadrature=0", "contact.quadrature", "1"),
    ("contact.friction=-0.1", "contact.friction", "allowed 0 to 1"),
    ("contact.friction=1.5", "contact.friction", "allowed 0 to 1"),
    ('contact.friction="low"', "contact.friction", "a number"),
    (
        "solver.condensed_sectors=true",
        "solver.condensed_sectors",
        'allowed only with drive.model = "plane"',
    ),
    ("solver.max_iterations=0", "solver.max_iterations", "1"),
    ('solver.linear="magic"', "solver.linear", "direct"),
    ("nonsense=1", "nonsense", "section.key=value"),
    ("drive.module", "drive.module", "section.key=value"),
    ("gearbox.size=1", "gearbox", "not a key"),
]


@pytest.mark.parametrize(("override", "key", "reason"), OVERRIDES)
def test_one_sentence_with_key_and_reason(override: str, key: str, reason: str) -> None:
    with pytest.raises(InputError) as caught:
        load_design(REFERENCE, [override])
    message = str(caught.value)
    assert "\n" not in message and key in message and reason in message
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    "design", [REFERENCE, REFERENCE.with_name("plane_half_turn.toml")], ids=["cup", "plane"]
)
def test_friction_needs_the_direct_solver(design: Path) -> None:
    with pytest.raises(
        InputError, match='solver.linear = "iterative" .* contact.friction = 0.1: allowed "direct"'
    ):
        load_design(design, ["contact.friction=0.1", 'solver.linear="iterative"'])


def test_condensed_sectors_that_bend_too_much() -> None:
    plane = REFERENCE.with_name("plane_half_turn.toml")
    load_design(plane, ["solver.condensed_sectors=true"])
    few = ["solver.condensed_sectors=true", "drive.teeth_fs=40", "drive.teeth_rg=42"]
    with pytest.raises(
        InputError, match="solver.condensed_sectors = true leaves out 0.019 .* allowed up to 0.01"
    ):
        load_design(plane, few)
    load_design(plane, few[1:])


PANCAKE = [
    (("dynamic_spline.gap=0",), "dynamic_spline.gap = 0", "above 0"),
    (("dynamic_spline.gap=6",), "dynamic_spline.gap = 6", "below 6 mm (drive.face_width)"),
    (("dynamic_spline.face_width=5.5",), "dynamic_spline.face_width = 5.5", "below 5.5 mm"),
    (("dynamic_spline.rim=200",), "dynamic_spline.rim = 200", "0.01 to 100 mm"),
    (("dynamic_spline.profile.r_tip=9",), "dynamic_spline.profile.r_tip = 9", "smaller"),
    (
        ("dynamic_spline.profile={type='s_shaped',r_root=0.3}",),
        "dynamic_spline.profile.type",
        "the other profiles",
    ),
    (("wave_generator.face_width=5",), "wave_generator.face_width = 5", "only 6 mm"),
    (("solver.condensed_sectors=true",), "solver.condensed_sectors = true", "allowed false"),
    (("ratcheting.limit=1",), "ratcheting is not available", "allowed without it"),
    (
        ("stiffness.torque=1", "contact.friction=0.1"),
        "stiffness is not available",
        "allowed contact.friction = 0, not 0.1",
    ),
    (
        ("load.program=[{name='a', output_rotation=1.0}]",),
        "load.program with output_rotation is not available",
        "allowed torque",
    ),
    (("drive.model=cup", "wave_generator.face_width=6"), "dynamic_spline is given", 'not "cup"'),
    (
        ("drive.layout=wave_generator_fixed",),
        'drive.layout = "wave_generator_fixed"',
        "spline_fixed",
    ),
    (("ring_gear.housing.thickness=2",), "ring_gear.housing", "allowed without it"),
    (("drive.model=plane",), "dynamic_spline is given", 'not "plane"'),
    (
        ("deviations.ring_gear.eccentricity=0.01",),
        "deviations is not available",
        "allowed without them",
    ),
    (
        ("cup.length=5", "cup.fillet_radius=1", "cup.inner_radius=3"),
        "cup is not available",
        'only with drive.model = "cup"',
    ),
]
"""Overrides of the small pancake drive, the start of the sentence that refuses them, and a part of
its end."""


@pytest.mark.parametrize(("overrides", "key", "reason"), PANCAKE)
def test_pancake(overrides: tuple[str, ...], key: str, reason: str) -> None:
    with pytest.raises(InputError) as caught:
        load_design(DATA / "pancake.toml", list(overrides))
    message = str(caught.value)
    assert key in message and reason in message and "\n" not in message


@pytest.mark.parametrize("key", ["wg_crowning", "wg_slope", "fs_crowning"])
def test_micro_geometry_of_the_plane_model(key: str) -> None:
    """It has no face width along which anything could change."""
    keys = ("wg_crowning", "wg_slope", "fs_crowning")
    others = [f"micro_geometry.{k}=0" for k in keys if k != key]
    with pytest.raises(InputError) as caught:
        load_design(REFERENCE, ["drive.model=plane", f"micro_geometry.{key}=0.01", *others])
    message = str(caught.value)
    assert f"micro_geometry.{key} = 0.01" in message and "plane" in message and "\n" not in message
    load_design(REFERENCE, ["drive.model=plane", f"micro_geometry.{key}=0", *others])


def test_a_spline_is_at_least_half_as_wide_as_its_rim_is_thick() -> None:
    rim = load_design(REFERENCE).flexible_spline.rim
    narrow = [f"{section}.face_width={0.4 * rim}" for section in ("drive", "wave_generator")]
    straight = [f"micro_geometry.{key}=0" for key in ("wg_crowning", "wg_slope", "fs_crowning")]
    with pytest.raises(
        InputError, match=rf"drive.face_width = .* allowed {0.5 * rim:g} mm \(axial travel of"
    ):
        load_design(REFERENCE, [*narrow, *straight])


def test_teeth_do_not_travel_out_of_the_face_width() -> None:
    """Measured on the small drive of 4 mm width: 0.50 mm."""
    small = load_design(DESIGN)
    assert small.axial_travel == pytest.approx(0.4854, abs=1e-4)
    straight = [f"micro_geometry.{key}=0" for key in ("wg_crowning", "wg_slope", "fs_crowning")]
    narrow = [f"{section}.face_width=0.45" for section in ("drive", "wave_generator")]
    with pytest.raises(
        InputError, match="drive.face_width = 0.45 is out of range: allowed 0.4854 mm"
    ):
        load_design(DESIGN, [*narrow, *straight])


def test_a_cup_drive_needs_a_cup(design_file: Callable[[dict[str, dict]], Path]) -> None:
    path = design_file({})
    lines = path.read_text(encoding="utf-8").splitlines()
    path.write_text(
        "\n".join(line for line in lines if not line.startswith("cup =")), encoding="utf-8"
    )
    with pytest.raises(InputError) as caught:
        load_design(path)
    assert str(caught.value) == 'cup is missing: allowed only with drive.model = "plane"'
    straight = [f"micro_geometry.{key}=0" for key in ("wg_crowning", "wg_slope", "fs_crowning")]
    assert load_design(path, ["drive.model=plane", *straight]).cup is None


@pytest.mark.parametrize("key", ["teeth_fs", "module", "E", "face_width"])
def test_missing_key(tmp_path: Path, key: str) -> None:
    lines = REFERENCE.read_text(encoding="utf-8").splitlines()
    file = tmp_path / "design.toml"
    file.write_text(
        "\n".join(line for line in lines if not line.startswith(f"{key} =")), encoding="utf-8"
    )
    with pytest.raises(InputError, match=f"{key} is missing"):
        load_design(file)


def test_unreadable_files(tmp_path: Path) -> None:
    binary, broken = tmp_path / "binary.toml", tmp_path / "broken.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    broken.write_text("[drive\nmodule = ", encoding="utf-8")
    for path, reason in (
        (tmp_path / "none.toml", "no such file"),
        (tmp_path, "directory"),
        (binary, "UTF-8"),
        (broken, "TOML"),
    ):
        with pytest.raises(InputError, match=reason):
            load_design(path)


def test_exit_code_and_no_traceback() -> None:
    command = [
        sys.executable,
        "-P",
        "-m",
        "swgpar.cli",
        "check",
        str(REFERENCE),
        "--set",
        "load.torque=-3",
    ]
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=120, cwd=REFERENCE.parent
    )
    assert done.returncode == 2
    assert "load.torque = -3" in done.stderr and "Traceback" not in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1


@pytest.mark.parametrize("value", [3, [1.0, 2.0], [[1.0, "x"]]])
def test_a_key_of_points(value: object) -> None:
    class Curve(Section):
        points: list[list[float]] = quantity(unit="mm", text="points [x, y]")

    with pytest.raises(ValidationError) as refused:
        Curve.model_validate({"points": value})
    words = "is not a list of lists of numbers: allowed points [x, y] (mm)"
    assert words in sentence(Curve, refused.value)


class _OneFinding:
    """One finding of pydantic, as `sentence` reads them."""

    def __init__(self, finding: Any) -> None:
        self.finding = finding

    def errors(self, **_: object) -> list[Any]:
        return [self.finding]


def _sections() -> list[type[Section]]:
    """All kinds of sections of the package."""
    for module in pkgutil.walk_packages(swgpar.__path__, "swgpar."):
        if not module.name.startswith(("swgpar.watch._", "swgpar.cli.__main__")):
            importlib.import_module(module.name)
    found, new = [], [Section]
    while new:
        new = [cls for parent in new for cls in parent.__subclasses__()]
        found += new
    own = [cls for cls in found if cls.__module__.startswith("swgpar.")]
    return [cls for cls in own if not inspect.isabstract(cls)]


def test_every_key_refuses_every_value_in_a_sentence() -> None:
    """Whatever the type of the key: also of keys that may be left out."""
    values = [-1e300, 2, 1.5, True, "x", "", [], [[]], ["x"], {}, {"x": 1}, None, float("nan"), 1j]
    refused = 0
    for cls in _sections():
        for name in cls.model_fields:
            for value in values:
                try:
                    cls.model_validate({name: value})
                except ValidationError as error:
                    for finding in error.errors(include_url=False):
                        if finding["loc"][:1] == (name,):
                            text = sentence(cls, _OneFinding(finding))  # type: ignore[arg-type]
                            refused += 1
                            assert name in text and str(InputError(text)).isprintable()
                except InputError:
                    pass
    assert refused > 3000
