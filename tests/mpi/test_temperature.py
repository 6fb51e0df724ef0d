"""Temperatures of bodies and press fits in whole drives: similarity, reductions, ranks."""

from __future__ import annotations

import pytest
from mpi4py import MPI

from support.cup_shapes import ATTACHMENTS, shaped
from support.stepping import assert_agree, load_stepper, loaded, row, small
from swgpar.load.load_states import LoadState, Stage

RISE, EXPANSION = 60.0, 12e-6
PHYSICAL = (
    *("fs_s1", "fs_s3", "fs_vm", "rg_s1", "rg_s3", "rg_vm"),
    *("wg_torque_Nmm", "tooth_torque_Nmm", "output_angle_deg"),
)
MATERIAL = f"material.expansion={EXPANSION}"
FRAME = f"ring_gear.frame.expansion={EXPANSION}"
WARM = 20.0 + RISE
DIFFERENT = (
    MATERIAL,
    "flexible_spline.temperature=50",
    "ring_gear.temperature=35",
    "wave_generator.temperature=60",
)
"""A drive that is warm inside, in a frame that is not."""


def alike(model: str) -> tuple[str, ...]:
    """Overrides that let all bodies and the frame grow alike, with the torque of the larger
    drive."""
    torque = {"plane": 0.2, "cup": 2.0}[model] * (1.0 + EXPANSION * RISE) ** 3
    bodies = ("flexible_spline", "ring_gear", "wave_generator", "ring_gear.frame")
    return (
        MATERIAL,
        FRAME,
        f"load.torque={torque:.12f}",
        *(f"{body}.temperature={WARM}" for body in bodies),
    )


def test_a_drive_that_grows_alike_is_a_larger_drive() -> None:
    """Stresses are those of the cold drive under a torque that is smaller by the volume.

    The strain of the growth is 7e-4. The law of the flanks holds per length of the cold drive, and
    the ring gear has no other stress than theirs: 2 MPa, within twice that strain.
    """
    _, cold = loaded(small("plane"))
    _, warm = loaded(small("plane", *alike("plane")))
    assert_agree(warm, cold, ("fs_s1", "fs_s3", "fs_vm"), 2e-6)
    assert_agree(warm, cold, ("output_angle_deg",), 1e-4)
    assert_agree(warm, cold, ("rg_s1", "rg_vm"), 2.0 * EXPANSION * RISE)
    for name in ("wg_torque_Nmm", "tooth_torque_Nmm"):
        assert warm[name] == pytest.approx(cold[name] * (1.0 + EXPANSION * RISE) ** 3, rel=2e-4)
    assert warm["pairs_in_contact"] == cold["pairs_in_contact"]


def test_a_warm_ring_gear_in_a_cold_frame_is_pressed() -> None:
    """Its rim, far from the teeth in contact, has the stress of a ring that is held: -E alpha dT /
    (1 - nu) where teeth and inner surface carry nothing, less where it can move inwards."""
    _, cold = loaded(small("plane"))
    _, warm = loaded(small("plane", MATERIAL, f"ring_gear.temperature={WARM}"))
    held = 210e3 * EXPANSION * RISE
    assert warm["rg_s3"] - cold["rg_s3"] > 0.5 * held
    _, free = loaded(
        small(
            "plane",
            MATERIAL,
            FRAME,
            f"ring_gear.temperature={WARM}",
            f"ring_gear.frame.temperature={WARM}",
        )
    )
    assert abs(free["rg_s3"] - cold["rg_s3"]) < 0.01 * held


@pytest.mark.parametrize("layout", [(), ("drive.layout=spline_fixed",)])
def test_half_the_drive_equals_the_whole(layout: tuple[str, ...]) -> None:
    fits = ("ring_gear.frame.interference=0.01", *layout)
    _, half = loaded(small("plane", *DIFFERENT, *fits))
    _, whole = loaded(small("plane", *DIFFERENT, *fits, "solver.symmetry=false"))
    assert_agree(half, whole, PHYSICAL, 1e-6)


@pytest.mark.parallel(2)
@pytest.mark.parametrize("model", ["plane", "cup"])
def test_two_ranks_give_the_same(model: str) -> None:
    fits = ("ring_gear.frame.interference=0.01",)
    _, parallel = loaded(small(model, *DIFFERENT, *fits))
    _, alone = loaded(small(model, *DIFFERENT, *fits), MPI.COMM_SELF)
    assert_agree(parallel, alone, PHYSICAL, 1e-8 if model == "plane" else 1e-6)


def test_condensed_teeth_and_whole_ones_give_the_same() -> None:
    """Teeth out of reach are one element, which grows as the rim does."""
    _, condensed = loaded(small("cup", *DIFFERENT))
    _, whole = loaded(small("cup", *DIFFERENT, "solver.far_teeth=modelled"))
    assert_agree(condensed, whole, PHYSICAL, 1e-3)


@pytest.mark.parametrize("name", ["edge", *ATTACHMENTS])
def test_a_warm_cup_alone_has_no_stress(name: str) -> None:
    """Its flange grows with it, from the axis and its own middle plane: E alpha dT are 151 MPa."""
    design = shaped(ATTACHMENTS.get(name, {})).with_values(
        {"material.expansion": EXPANSION, "flexible_spline.temperature": WARM}
    )
    stepper = load_stepper(design)
    assert stepper.solver.solve(LoadState(Stage.ENGAGE, 2)).converged
    values = row(stepper)
    print(f"{name}: {values['fs_vm']:.1e} MPa")
    assert values["fs_vm"] < 1e-3 and values["rg_vm"] < 1e-9
