"""All results of a cascade gearbox."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from mpi4py import MPI

from swgpar.gear_trains.cascade.design import PINIONS, CascadeDesign
from swgpar.gear_trains.cascade.dynamics import natural_frequencies
from swgpar.gear_trains.cascade.flex_unit import FlexUnits
from swgpar.gear_trains.cascade.layout import DOFS
from swgpar.gear_trains.cascade.load_cycle import LoadCycle, braked_load_shares, one_load_cycle
from swgpar.gear_trains.cascade.population import PopulationShares, population_tasks
from swgpar.gear_trains.cascade.quantities import RANKED_TOLERANCES
from swgpar.gear_trains.cascade.static_sharing import (
    MESH_COUNTS,
    Direction,
    even_pinion_mask,
    first_crossing,
    static_sharing,
)
from swgpar.gear_trains.cascade.tolerance_stack_up import contributions, stack_up_tasks
from swgpar.gear_trains.published import number_label
from swgpar.gear_trains.result import Table, TrainResult
from swgpar.log import logger
from swgpar.vibration.sampling import run_tasks

DIRECTIONS: tuple[Direction, ...] = ("B", "A")

EACH = [f"{k}" for k in range(1, PINIONS + 1)]
CURVE_END = 2.5
"""End of the table of the flexible units, over the deformation above which they are linear."""


def compute(design: CascadeDesign, comm: MPI.Comm) -> TrainResult:
    """All results of a design, the same on all ranks; collective."""
    first: list[Callable[[], object]] = [
        partial(one_load_cycle, design),
        *(partial(braked_load_shares, design, side) for side in DIRECTIONS),
    ]
    tolerances, gearboxes = stack_up_tasks(design), population_tasks(design)
    logger.info(
        "cascade gearbox: %d degrees of freedom, %d tolerance samples, %d gearboxes with errors; "
        "%d ranks",
        DOFS,
        design.tolerances.samples,
        design.population.gearboxes,
        comm.size,
    )
    done, _ = run_tasks(comm, [*first, *tolerances, *gearboxes])
    cycle, braked = done[0], dict(zip(DIRECTIONS, done[1 : len(first)], strict=True))
    stacks = dict(zip(MESH_COUNTS, done[len(first) : len(first) + len(tolerances)], strict=True))
    parts: list[PopulationShares] = done[len(first) + len(tolerances) :]
    shares = PopulationShares(
        *(np.concatenate([getattr(p, k) for p in parts]) for k in ("static", "mean", "largest"))
    )
    limit = 1.0 / PINIONS + design.load.overload
    values: dict[str, float | list[float]] = {
        "spearman_rack_pinion": [stacks["rack_pinion"][1][name] for name in RANKED_TOLERANCES],
        "first_crossing_static": 1e-3
        * first_crossing(static_sharing(design, "B"), 1e3 * design.load.peak),
        "first_crossing_dynamic": 1e-3 * cycle.first_crossing(),
        **{f"braked_{side}": shares_of_side.tolist() for side, shares_of_side in braked.items()},
        "overloaded_static": float((shares.static > limit).any(axis=1).sum()),
        "overloaded_dynamic": float((shares.largest > limit).any(axis=1).sum()),
        "largest_static_share": float(shares.static.max()),
        "largest_dynamic_mean_share": float(shares.mean.max()),
        "largest_dynamic_share": float(shares.largest.max()),
        "natural_frequencies": natural_frequencies(design).tolist(),
        **{
            f"largest_error_{k}": 1e6 * float(np.abs(stacks[k][0]).max())
            for k in ("rack_pinion", "g1_g1")
        },
    }
    tables = {
        "static": _static(design),
        "flex_unit": _flex_unit(design),
        "spearman": _spearman(design, stacks),
        "stack_up": {f"{kind}_um": 1e6 * samples for kind, (samples, _) in stacks.items()},
        "population": _population(shares),
    }
    return TrainResult(
        _history(cycle),
        tables,
        values | _shares_at_forces(design, cycle),
        {"overload_limit": limit},
    )


def _shares_at_forces(design: CascadeDesign, cycle: LoadCycle) -> dict[str, list[float]]:
    """Load shares at the rack forces of the design, at rest and in motion."""
    even, values = even_pinion_mask(), {}
    for force in design.load.forces:
        name = number_label(force)
        for direction in DIRECTIONS:
            values[f"static_{direction}_{name}"] = (
                static_sharing(design, direction).shares(1e3 * force).tolist()
            )
        equal = static_sharing(design, "B", equal_units=True).shares(1e3 * force)
        values[f"static_equal_B_{name}"] = [equal[~even].mean(), equal[even].mean()]
        moving = cycle.shares_at(1e3 * force)
        values[f"dynamic_B_{name}"] = moving.tolist()
        values[f"dynamic_mean_B_{name}"] = [moving[~even].mean(), moving[even].mean()]
    return values


def _history(cycle: LoadCycle) -> Table:
    out = {
        "time_s": cycle.time,
        "rack_force_kN": 1e-3 * cycle.rack_force,
        "rack_displacement_mm": 1e3 * cycle.displacement,
        "rack_velocity_m_s": cycle.velocity,
    }
    out |= {
        f"pinion_force_{k}_kN": 1e-3 * column
        for k, column in zip(EACH, cycle.pinion_forces.T, strict=True)
    }
    return out | {f"share_{k}": column for k, column in zip(EACH, cycle.shares.T, strict=True)}


def _static(design: CascadeDesign) -> Table:
    """Load shares at rest against the rack force."""
    force = np.linspace(0.0, design.load.peak, 201)[1:]
    out = {"rack_force_kN": force}
    for direction in DIRECTIONS:
        shares = static_sharing(design, direction).shares(1e3 * force)
        out |= {f"{direction}_{k}": column for k, column in zip(EACH, shares.T, strict=True)}
    equal = static_sharing(design, "B", equal_units=True).shares(1e3 * force)
    return out | {"B_equal_odd": equal[:, 0], "B_equal_even": equal[:, 1]}


def _flex_unit(design: CascadeDesign) -> Table:
    """The mean curve of the flexible units."""
    units, section = FlexUnits.of(design), design.flex_unit
    deformation = np.linspace(0.0, CURVE_END * section.linear_above, 101)
    twist = deformation / section.radius
    return {
        "deformation_mm": deformation,
        "torque_Nm": units.torque(twist),
        "stiffness_Nm_per_deg": units.tangent(twist) * np.pi / 180.0,
    }


def _spearman(
    design: CascadeDesign, stacks: dict[str, tuple[np.ndarray, dict[str, float]]]
) -> Table:
    rows = [
        (kind, name, 1e6 * limit, stacks[kind][1][name])
        for kind in MESH_COUNTS
        for name, limit in contributions(design, kind).items()
    ]
    return {
        k: np.array(c)
        for k, c in zip(("mesh", "tolerance", "limit_um", "rank"), zip(*rows, strict=True))
    }


def _population(shares: PopulationShares) -> Table:
    out: dict[str, np.ndarray] = {"gearbox": np.arange(1, len(shares.static) + 1)}
    for name, values in (
        ("static", shares.static),
        ("mean", shares.mean),
        ("largest", shares.largest),
    ):
        out |= {f"{name}_{k}": column for k, column in zip(EACH, values.T, strict=True)}
    return out
