"""The state at the next angle, predicted from those known: on a wave that turns without a drive."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc
from small_drive import DESIGN, PLANE, RECIPE

from swgpar.assembly import create_vector, read_field, write_field
from swgpar.design import load_design
from swgpar.incremental import DriveModel
from swgpar.meshing import load_recipe
from swgpar.prediction import predict, supports, turned


@pytest.fixture(scope="module")
def model() -> DriveModel:
    return DriveModel(load_design(DESIGN, list(PLANE)), load_recipe(RECIPE), MPI.COMM_WORLD)


def wave(model: DriveModel, angle: float, lobes: int) -> PETSc.Vec:
    """The drive in a wave of 1 mm that the generator has turned by `angle`, its output by the ratio."""
    partition = model.partition
    x = create_vector(partition)
    teeth = [layout.mesh.n_sectors for layout in partition.layouts]
    for body, layout in enumerate(partition.layouts):
        own = np.arange(*partition.owned(body))
        coords = np.repeat(layout.mesh.coords[None], len(own), axis=0)
        turn = 0.0 if body == model.fixed_body else angle * (1.0 - teeth[model.fixed_body] / teeth[body])
        at = layout.turn(layout.first_tooth + own)
        place = turned(coords, at + turn)
        # sectors turn clockwise from +y or anticlockwise: places tell
        around = np.arctan2(place[..., 1], place[..., 0])
        swing = np.cos(lobes * (around - angle))
        radial = np.stack([np.cos(around), np.sin(around), np.zeros_like(around)], axis=-1)
        write_field(partition, body, own, place + swing[..., None] * radial - turned(coords, at), x)
    return x


def error(model: DriveModel, known: list[float], angle: float, lobes: int = 2) -> float:
    """Largest error (mm) of a prediction from the states at known angles, over all ranks."""
    x = create_vector(model.partition)
    predict(model.partition, model.fixed_body, [(there, wave(model, there, lobes)) for there in known], x, angle)
    exact, worst = wave(model, angle, lobes), 0.0
    for body in range(len(model.partition.layouts)):
        own = np.arange(*model.partition.owned(body))
        free = ~model.partition.layouts[body].is_fixed
        gap = read_field(model.partition, body, own, x) - read_field(model.partition, body, own, exact)
        worst = max(worst, float(np.abs(gap[:, free]).max(initial=0.0)))
    return model.comm.allreduce(worst, op=MPI.MAX)


@pytest.mark.parametrize("pitches", [1, 3, -2])
def test_whole_pitches_are_exact(model: DriveModel, pitches: int) -> None:
    assert error(model, [0.0], pitches * model.design.pitch) < 1e-11


def test_between_them_cubic_polynomials_interpolate(model: DriveModel) -> None:
    """Error of the middle: 9/16 of a pitch (the spline's, the larger) to the fourth, over 4!, times a derivative."""
    pitch = 2.0 * np.pi / model.design.drive.teeth_fs
    middle = error(model, [0.0], 0.5 * model.design.pitch)
    assert 0.5 < middle / (9.0 / 16.0 / 24.0 * (2.0 * pitch) ** 4) < 1.02


def test_more_states_make_it_better(model: DriveModel) -> None:
    """Halfway between two states a quarter of a pitch apart the error is that of the shorter distance."""
    pitch = model.design.pitch
    alone = error(model, [0.0], 0.5 * pitch)
    close = error(model, [0.0, 0.25 * pitch, 0.75 * pitch], 0.5 * pitch)
    assert close < 0.5 * alone
    assert error(model, [0.0, 0.25 * pitch], 1.25 * pitch) < 1e-11


def test_weights_reproduce_cubic_polynomials_and_the_latest_state_counts() -> None:
    shifts = [0.3, 0.05, -0.4, 1.05]  # the last is the second again, one tooth on
    found = supports(shifts)
    assert 1 not in {state for state, *_ in found}
    for power in range(4):
        total = sum(weight * (tooth + shifts[state]) ** power for state, tooth, weight in found)
        assert total == pytest.approx(float(power == 0), abs=1e-12)


def test_states_close_together_do_not_extrapolate() -> None:
    found = supports([0.4, 0.4001, 0.4002])
    assert max(abs(weight) for *_, weight in found) < 2.0
