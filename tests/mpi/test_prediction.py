"""The state at the next angle, predicted from those known: on a wave that turns without a drive."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar import load_design
from swgpar.analysis.predictor import (
    KnownState,
    add_change,
    interpolation_points,
    predict,
    predict_guided,
)
from swgpar.fem.vectors import create_vector, read_field, write_field
from swgpar.geometry.rotation import rotated
from swgpar.meshing import load_recipe
from swgpar.model.drive_model import DriveModel, build_drive_model
from swgpar.petsc import PETSc

CASES = ((), ("drive.layout=spline_fixed",), ("solver.symmetry=false",))


@pytest.fixture(scope="module", params=CASES, ids=["ring fixed", "spline fixed", "whole drive"])
def model(request: pytest.FixtureRequest) -> DriveModel:
    return build_drive_model(
        load_design(DESIGN, [*PLANE, *request.param]), load_recipe(RECIPE), comm=MPI.COMM_WORLD
    )


def wave(model: DriveModel, angle: float, slip: float = 0.0, *, height: float = 1.0) -> PETSc.Vec:
    """The drive in a wave of a height (mm) with two lobes, turned by `angle` (rad).

    The gear that is not fixed has turned by the ratio, and by `slip` in its pattern.
    """
    partition = model.partition
    x = create_vector(partition)
    teeth = {name: layout.mesh.n_sectors for name, layout in partition.layouts.items()}
    for body, layout in partition.layouts.items():
        own = partition.owned_indices(body)
        coords = np.repeat(layout.mesh.coords[None], len(own), axis=0)
        turn = (
            0.0
            if body == model.fixed_body
            else angle * (1.0 - teeth[model.fixed_body] / teeth[body]) + slip
        )
        at = layout.sector_angle(layout.first_tooth + own)[:, None]
        place = rotated(coords, at + turn)
        around = np.arctan2(place[..., 1], place[..., 0])
        radial = np.stack([np.cos(around), np.sin(around), np.zeros_like(around)], axis=-1)
        lift = height * np.cos(2.0 * (around - angle))[..., None] * radial
        values = place + lift - rotated(coords, at)
        values[:, layout.numbering.without_unknowns] = 0.0
        write_field(partition, body, values, x)
    return x


def error(model: DriveModel, known: list[float], angle: float, slip: float = 0.0) -> float:
    """Largest error (mm) of a prediction from the states at known angles, over all ranks."""
    x = create_vector(model.partition)
    states = [KnownState(at, wave(model, at)) for at in known]
    predict(model.partition, model.fixed_body, states, x, angle, slip, resting={model.fixed_body})
    return distance(model, x, wave(model, angle, slip))


def guided_error(model: DriveModel, known: list[float], guides: list[float], angle: float) -> float:
    """The same with guides of a wave half as high again at some angles."""
    x = create_vector(model.partition)
    states = [KnownState(at, wave(model, at)) for at in known]
    higher = [KnownState(at, wave(model, at, height=1.5)) for at in guides]
    predict_guided(model.partition, model.fixed_body, states, higher, x, angle)
    return distance(model, x, wave(model, angle))


def distance(model: DriveModel, x: PETSc.Vec, exact: PETSc.Vec) -> float:
    """Largest difference (mm) of two states, over all ranks."""
    worst = 0.0
    for body in model.partition.layouts:
        own = model.partition.owned_indices(body)
        gap = read_field(model.partition, body, own, x) - read_field(
            model.partition, body, own, exact
        )
        worst = max(worst, float(np.abs(gap).max(initial=0.0)))
    return model.comm.allreduce(worst, op=MPI.MAX)


@pytest.mark.parametrize("pitches", [1, 3, -2])
@pytest.mark.parallel([1, 2, 3])
def test_whole_pitches_are_exact(model: DriveModel, pitches: int) -> None:
    assert error(model, [0.0], pitches * model.design.kinematics.period_angle) < 1e-11


@pytest.mark.parametrize("teeth", [1, -2])
@pytest.mark.parallel([1, 2, 3])
def test_a_slip_by_whole_teeth_is_exact(model: DriveModel, teeth: int) -> None:
    (moving,) = (
        layout.mesh.n_sectors
        for name, layout in model.partition.layouts.items()
        if name != model.fixed_body
    )
    assert error(model, [0.0], 0.0, 2.0 * np.pi * teeth / moving) < 1e-11


@pytest.mark.parallel([1, 2, 3])
def test_between_them_cubic_polynomials_interpolate(model: DriveModel) -> None:
    """Error of the middle: 9/16 of a pitch (the spline's, the larger) to the fourth, over 4!, times
    a derivative."""
    pitch = 2.0 * np.pi / model.design.drive.teeth_fs
    middle = error(model, [0.0], 0.5 * model.design.kinematics.period_angle)
    assert 0.5 < middle / (9.0 / 16.0 / 24.0 * (2.0 * pitch) ** 4) < 1.02


@pytest.mark.parallel([1, 2, 3])
def test_more_states_make_it_better(model: DriveModel) -> None:
    """Halfway between two states a quarter of a pitch apart the error is that of the shorter
    distance."""
    pitch = model.design.kinematics.period_angle
    alone = error(model, [0.0], 0.5 * pitch)
    close = error(model, [0.0, 0.25 * pitch, 0.75 * pitch], 0.5 * pitch)
    assert close < 0.04 * alone
    assert error(model, [0.0, 0.25 * pitch], 1.25 * pitch) < 1e-11


@pytest.mark.parallel([1, 2, 3])
def test_guides_add_what_their_own_prediction_misses(model: DriveModel) -> None:
    """Those of a wave half as high again miss half as much again: half of the error is left."""
    pitch = model.design.kinematics.period_angle
    known, middle = [0.0, 0.25 * pitch], 0.6 * pitch
    alone = error(model, known, middle)
    guided = guided_error(model, known, [0.0, 0.25 * pitch, middle], middle)
    assert guided == pytest.approx(0.5 * alone, rel=1e-6)
    lacking = guided_error(model, known, [0.0, middle], middle)
    assert lacking == pytest.approx(alone, rel=1e-12)


@pytest.mark.parallel([1, 2, 3])
def test_a_change_elsewhere_moves_along(model: DriveModel) -> None:
    """A wave that has grown by half at one angle does so at another, exactly after a pitch."""
    pitch = model.design.kinematics.period_angle
    before, after = (KnownState(0.0, wave(model, 0.0, height=high)) for high in (1.0, 1.5))
    for angle, left in ((pitch, 0.0), (0.5 * pitch, 0.5 * error(model, [0.0], 0.5 * pitch))):
        x = wave(model, angle)
        add_change(model.partition, model.fixed_body, [before], [after], x, angle)
        missed = distance(model, x, wave(model, angle, height=1.5))
        assert missed == pytest.approx(left, rel=1e-6, abs=1e-11)


def test_weights_reproduce_cubic_polynomials_and_the_latest_state_counts() -> None:
    shifts = [0.3, 0.05, -0.4, 1.05]  # the last is the second again, one tooth on
    found = interpolation_points(shifts)
    assert 1 not in {point.index for point in found}
    for power in range(4):
        total = sum(point.weight * (point.teeth + shifts[point.index]) ** power for point in found)
        assert total == pytest.approx(float(power == 0), abs=1e-12)


def test_states_close_together_do_not_extrapolate() -> None:
    found = interpolation_points([0.4, 0.4001, 0.4002])
    assert max(abs(point.weight) for point in found) < 2.0
