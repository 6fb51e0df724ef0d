"""Gearboxes with random errors under the largest rack force in one direction, at rest and
moving."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.gear_trains.cascade.design import MESH_COUNTS, PINIONS, CascadeDesign
from swgpar.gear_trains.cascade.dynamics import Gearbox, ramp
from swgpar.gear_trains.cascade.layout import FLYWHEEL, MESHES, rigid_displacements
from swgpar.gear_trains.cascade.static_sharing import static_sharing
from swgpar.gear_trains.cascade.tolerance_stack_up import standard_deviation
from swgpar.gear_trains.kernel import MESH_ERROR
from swgpar.vibration.sampling import random_stream

BLOCK_SIZE = 25
STREAM = 1
"""First number of the keys of these samples' streams."""


@dataclass(frozen=True)
class PopulationShares:
    """Load shares (n, 8) of gearboxes: at rest; in motion, means and largest ones of the hold."""

    static: np.ndarray
    mean: np.ndarray
    largest: np.ndarray


def random_errors(design: CascadeDesign, block: int, count: int) -> np.ndarray:
    """Errors of the gearboxes of a block, (count, 18) of the kernel's MESH_ERROR.

    The amplitude is a sample of the stack-up of its kind of mesh, phases are uniform. At rest the
    amplitude is the error itself.
    """
    random = random_stream(design.gear_train.seed, STREAM, block)
    by_kind = [standard_deviation(design, kind) for kind in MESH_COUNTS]
    deviations = np.repeat(by_kind, list(MESH_COUNTS.values()))
    errors = np.zeros((count, MESHES), dtype=MESH_ERROR)
    errors["amplitude"] = random.standard_normal((count, MESHES)) * deviations
    errors["phase"], errors["tooth_phase"] = random.uniform(0.0, 2.0 * np.pi, (2, count, MESHES))
    return errors


def static_shares(design: CascadeDesign, errors: np.ndarray) -> np.ndarray:
    """Load shares (n, 8) at rest."""
    ends = np.cumsum(list(MESH_COUNTS.values()))[:-1]
    by_kind = dict(zip(MESH_COUNTS, np.split(errors["amplitude"], ends, axis=1), strict=True))
    force = np.full(len(errors), 1e3 * design.load.peak)
    direction = design.population.direction
    return static_sharing(design, direction, errors=by_kind).shares(force)


def rack_force(design: CascadeDesign) -> float:
    """The rack force of the population in motion, N; negative in direction A."""
    return (1e3 if design.population.direction == "B" else -1e3) * design.load.peak


def steady_velocities(design: CascadeDesign) -> np.ndarray:
    """Velocities (23,) in m/s at which the generator balances the rack force of the population."""
    displacements = rigid_displacements(design)
    generator = design.flywheel.generator / design.radius("g4") ** 2
    return rack_force(design) / (generator * displacements[FLYWHEEL] ** 2) * displacements


def block_shares(design: CascadeDesign, block: int, count: int) -> PopulationShares:
    """All load shares of the gearboxes of a block.

    In motion the gears start at their steady speed without contact; the rack force rises and then
    stays constant.
    """
    errors, gearbox = random_errors(design, block, count), Gearbox(design)
    section = design.population
    rising, holding = (int(np.ceil(t / section.step)) for t in (section.ramp, section.hold))
    steps = section.step, rising + holding
    force = ramp(rack_force(design), rising * section.step)
    start = steady_velocities(design)
    means, largest = np.empty((2, count, PINIONS))
    for k in range(count):
        carried, _, _ = gearbox.simulate(force, start, *steps, errors=errors[k])
        share = carried[rising:] / carried[rising:].sum(axis=1, keepdims=True)
        means[k], largest[k] = share.mean(axis=0), share.max(axis=0)
    return PopulationShares(static_shares(design, errors), means, largest)
