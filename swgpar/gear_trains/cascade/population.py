"""Gearboxes with random errors, at rest and in motion, under the largest rack force in direction B."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from swgpar.gear_trains.cascade.design import PINIONS, CascadeDesign
from swgpar.gear_trains.cascade.dynamics import Gearbox, ramp
from swgpar.gear_trains.cascade.layout import FLYWHEEL, N_MESHES, rigid_ways
from swgpar.gear_trains.cascade.static import MESHES, static_sharing
from swgpar.gear_trains.cascade.tolerances import standard_deviation
from swgpar.gear_trains.kernel import MESH_ERROR
from swgpar.gear_trains.sampling import blocks, generator

BLOCK = 25
STREAM = 1
"""First number of the keys of these samples' streams."""


@dataclass(frozen=True)
class Shares:
    """Load shares of some gearboxes, (n, 8) each: at rest; in motion, as means and largest values over the hold."""

    static: np.ndarray
    mean: np.ndarray
    largest: np.ndarray


def random_errors(design: CascadeDesign, block: int, count: int) -> np.ndarray:
    """Errors of the gearboxes of a block, (count, 18) of the kernel's MESH_ERROR.

    The amplitude is a sample of the stack-up of its kind of mesh, phases are uniform. At rest the amplitude is the
    error itself.
    """
    random = generator(design.gear_train.seed, STREAM, block)
    deviations = [standard_deviation(design, kind) for kind, number in MESHES.items() for _ in range(number)]
    errors = np.zeros((count, N_MESHES), dtype=MESH_ERROR)
    errors["amplitude"] = random.standard_normal((count, N_MESHES)) * deviations
    errors["phase"], errors["tooth_phase"] = random.uniform(0.0, 2.0 * np.pi, (2, count, N_MESHES))
    return errors


def static_shares(design: CascadeDesign, errors: np.ndarray) -> np.ndarray:
    """Load shares (n, 8) at rest."""
    ends = np.cumsum(list(MESHES.values()))[:-1]
    by_kind = dict(zip(MESHES, np.split(errors["amplitude"], ends, axis=1), strict=True))
    return static_sharing(design, "B", errors=by_kind).shares(np.full(len(errors), 1e3 * design.load.peak))


def steady_velocities(design: CascadeDesign, box: Gearbox) -> np.ndarray:
    """Velocities (23,) in m/s at which the generator balances the largest rack force."""
    ways = rigid_ways(design)
    generator = design.flywheel.generator / design.radius("g4") ** 2
    return 1e3 * design.load.peak / (generator * ways[FLYWHEEL] ** 2) * ways


def block_shares(design: CascadeDesign, block: int, count: int) -> Shares:
    """All load shares of the gearboxes of a block.

    In motion the gears start at their steady speed without touching, the rack force rises and is held.
    """
    section, errors, box = design.population, random_errors(design, block, count), Gearbox(design)
    rising, holding = (int(np.ceil(t / section.step)) for t in (section.ramp, section.hold))
    force = ramp(1e3 * design.load.peak, rising * section.step)
    start = steady_velocities(design, box)
    means, largest = np.empty((count, PINIONS)), np.empty((count, PINIONS))
    for k in range(count):
        carried, _, _ = box.simulate(force, start, section.step, rising + holding, errors=errors[k])
        share = carried[rising:] / carried[rising:].sum(axis=1, keepdims=True)
        means[k], largest[k] = share.mean(axis=0), share.max(axis=0)
    return Shares(static_shares(design, errors), means, largest)


def populations(design: CascadeDesign) -> list[Callable[[], Shares]]:
    """Tasks for all blocks of the population."""
    sizes = blocks(design.population.gearboxes, BLOCK)
    return [lambda block=block, size=size: block_shares(design, block, size) for block, size in enumerate(sizes)]
