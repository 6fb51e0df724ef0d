"""The exact invariants of the model on a small drive; the same tests on 1, 2 and 3 ranks."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from swgpar.contact.pressure import nodal_pressure
from swgpar.contact.rigid import CamPose
from swgpar.design import DriveDesign, load_design
from swgpar.incremental import DriveModel, Runner, stresses
from swgpar.meshing import load_recipe
from swgpar.steps import sequence
from swgpar.stress import body_fields

DATA = Path(__file__).parent.parent / "data"
WORLD = MPI.COMM_WORLD


def loaded(design: DriveDesign, comm: MPI.Comm = WORLD) -> tuple[Runner, dict[str, float]]:
    """The small drive after step 3, and its history row."""
    runner = Runner(DriveModel(design, load_recipe(DATA / "tiny.toml"), comm))
    for item in sequence(design):
        if item.step > 3:
            break
        runner.increment(item)
    return runner, row(runner)


def row(runner: Runner) -> dict[str, float]:
    return {**runner.row(), **stresses(runner.model)[0]}


def small(*overrides: str) -> DriveDesign:
    return load_design(DATA / "small.toml", overrides)


@lru_cache
def base() -> tuple[Runner, dict[str, float]]:
    return loaded(small())


def turn(runner: Runner, angle: float) -> dict[str, float]:
    """Row after turning the wave generator to `angle` (rad)."""
    runner.iterations = 0
    runner.advance(replace(runner.scene, step=4, name="rotate", angle=angle))
    return row(runner)


PHYSICAL = ("fs_s1", "fs_s3", "fs_vm", "rg_s1", "rg_s3", "rg_vm", "wg_torque_Nmm", "tooth_torque_Nmm")


def assert_same(a: dict[str, float], b: dict[str, float], rel: float) -> None:
    for name in PHYSICAL:
        assert a[name] == pytest.approx(b[name], rel=rel), name
    assert a["pairs_in_contact"] == b["pairs_in_contact"]


def test_torques_balance() -> None:
    _, r = base()
    total = r["wg_torque_Nmm"] + r["tooth_torque_Nmm"] + r["output_torque_Nmm"]
    assert r["output_torque_Nmm"] == pytest.approx(2000.0)
    assert abs(total) < 1e-6 * r["output_torque_Nmm"]


def test_any_number_of_ranks_gives_the_same() -> None:
    if WORLD.size == 1:
        pytest.skip("compares several ranks with one: runs under mpirun")
    several, parallel = base()
    one, alone = loaded(small(), MPI.COMM_SELF)
    assert_same(parallel, alone, 1e-8)
    first, end = several.model.partition.owned(0)
    mine, whole = (nodal_pressure(r.equilibrium, r.equilibrium.elements.bodies[0]) for r in (several, one))
    assert np.abs(mine - whole[first:end]).max() < 1e-6 * whole.max()
    assert parallel["output_angle_deg"] == pytest.approx(alone["output_angle_deg"], rel=1e-8)


def test_period_and_work() -> None:
    """After one ring-gear pitch the state repeats, the output turned by pitch / ratio; the mean torque is T / ratio."""
    runner, _ = loaded(small())
    pitch, samples = 2.0 * np.pi / 42, 6
    first = turn(runner, 0.2 * pitch)  # away from the start, whose history is another one
    rows = [turn(runner, (0.2 + k / samples) * pitch) for k in range(1, samples + 1)]
    last = rows[-1]
    assert_same(last, first, 1e-6)
    turned = last["output_angle_deg"] - first["output_angle_deg"]
    assert turned == pytest.approx(-np.degrees(pitch) / 20.0, rel=1e-6)
    for r in rows:
        assert abs(r["wg_torque_Nmm"] + r["tooth_torque_Nmm"] + r["output_torque_Nmm"]) < 1e-6 * 2000.0
    # the integrand is continuous with kinks where pairs come and go: six samples a period are good to a per cent
    assert np.mean([r["wg_torque_Nmm"] for r in rows]) == pytest.approx(2000.0 / 20.0, rel=0.01)


def test_rotating_the_whole_spline_changes_no_stress() -> None:
    """The loaded spline and its wave generator turned by 0.7 rad: the same stresses, the forces turned alike."""
    runner, _ = base()
    equilibrium, scene, angle = runner.equilibrium, runner.scene, 0.7
    c, s = np.cos(angle), np.sin(angle)
    turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    spline = equilibrium.elements.bodies[0]
    nodes = np.unique(spline.local[spline.local >= 0])
    place, u = equilibrium.positions(), equilibrium.displacement()
    v = u.copy()
    v[nodes] = (place + u)[nodes] @ turned.T - place[nodes]

    def forces(w: np.ndarray, pose: CamPose) -> np.ndarray:
        r = np.zeros_like(w)
        equilibrium.elements.assemble(w, r, None, None)
        equilibrium.rigid.evaluate(w, pose, r, None)
        return r[nodes[nodes < equilibrium.partition.n_own]]

    after, before = forces(v, CamPose(scene.angle + angle, scene.cam)), forces(u, CamPose(scene.angle, scene.cam))
    largest = WORLD.allreduce(np.abs(before).max(), op=MPI.MAX)
    assert np.abs(after - before @ turned.T).max() < 1e-8 * largest
    first, second = body_fields(spline, u), body_fields(spline, v)
    for name in ("s1", "s3", "vm"):
        largest = WORLD.allreduce(np.abs(first[name]).max(), op=MPI.MAX)
        assert np.abs(first[name] - second[name]).max() < 1e-8 * largest, name


def test_half_the_drive_equals_the_whole() -> None:
    _, half = base()
    _, whole = loaded(small("solver.twofold_symmetry=false"))
    assert_same(half, whole, 1e-6)


@pytest.mark.parametrize(
    ("overrides", "augmented", "gears"),
    [
        (("contact.penalty_coef=200",), False, ("fs", "rg")),
        # softer than the elements: the ring's stress under the contact needs the augmentation, the spline's maxima not
        (("contact.penalty_coef=12.5",), False, ("fs",)),
        (
            ("contact.penalty_coef=10", "contact.penetration_tolerance=5e-5", "contact.max_augmentations=10"),
            True,
            ("fs", "rg"),
        ),
    ],
)
def test_enforcement_does_not_show(overrides: tuple[str, ...], augmented: bool, gears: tuple[str, ...]) -> None:
    _, r = base()
    runner, other = loaded(small(*overrides))
    assert (runner.equilibrium.augmentations > 0) == augmented
    for name in (f"{gear}_{stress}" for gear in gears for stress in ("s1", "s3", "vm")):
        assert other[name] == pytest.approx(r[name], rel=5e-3), name


def test_units_do_not_matter() -> None:
    """The same drive in inches and pounds-force."""
    inch, pound = 25.4, 4.4482216152605
    d = small()

    def lengths(section: object, *names: str) -> dict[str, float]:
        return {name: getattr(section, name) / inch for name in names}

    def gear(g):
        profile = g.profile.model_copy(
            update=lengths(g.profile, "r_tip", "r_addendum", "straight_l", "r_dedendum", "r_root")
        )
        return g.model_copy(update={**lengths(g, "rim"), "profile": profile})

    other = d.model_copy(
        update={
            "drive": d.drive.model_copy(update=lengths(d.drive, "module", "face_width")),
            "flexible_spline": gear(d.flexible_spline),
            "ring_gear": gear(d.ring_gear),
            "wave_generator": d.wave_generator.model_copy(update=lengths(d.wave_generator, "face_width")),
            "cup": d.cup.model_copy(update=lengths(d.cup, "length", "fillet_radius", "inner_radius")),
            "micro_geometry": d.micro_geometry.model_copy(
                update=lengths(d.micro_geometry, "wg_crowning", "wg_slope", "fs_crowning")
            ),
            "material": d.material.model_copy(update={"E": d.material.E * inch**2 / pound}),
            "load": d.load.model_copy(update={"torque": d.load.torque / inch / pound}),
        }
    )
    _, a = base()
    _, b = loaded(other)
    for name in ("fs_s1", "fs_s3", "fs_vm", "rg_vm"):
        assert b[name] * pound / inch**2 == pytest.approx(a[name], rel=1e-6), name
    assert b["wg_torque_Nmm"] * pound * inch == pytest.approx(a["wg_torque_Nmm"], rel=1e-6)
