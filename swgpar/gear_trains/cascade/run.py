"""All results of a cascade gearbox."""

from __future__ import annotations

from functools import partial

import numpy as np
from mpi4py import MPI

from swgpar.gear_trains.cascade.design import CascadeDesign
from swgpar.gear_trains.cascade.dynamics import natural_frequencies
from swgpar.gear_trains.cascade.flex_unit import FlexUnits
from swgpar.gear_trains.cascade.layout import DOFS
from swgpar.gear_trains.cascade.load_cycle import LoadCycle, braked_load_shares, one_load_cycle
from swgpar.gear_trains.cascade.population import BLOCK_SIZE, PopulationShares, block_shares
from swgpar.gear_trains.cascade.quantities import RANKED_TOLERANCES
from swgpar.gear_trains.cascade.static_sharing import (
    MESH_COUNTS,
    Direction,
    even_pinion_mask,
    first_share_crossing,
    static_sharing,
)
from swgpar.gear_trains.cascade.tolerance_stack_up import contributions, sample_stack_up
from swgpar.gear_trains.published import number_label
from swgpar.gear_trains.result import Computed
from swgpar.log import logger
from swgpar.results.table import Columns
from swgpar.vibration.sampling import Tasks, block_sizes, run_tasks

DIRECTIONS: tuple[Direction, ...] = ("B", "A")

CURVE_END = 2.5
"""End of the table of the flexible units, over the deformation above which they are linear."""


def compute(design: CascadeDesign, comm: MPI.Comm) -> Computed:
    """All results of a design, the same on all ranks; collective."""
    logger.info(
        "cascade gearbox: %d degrees of freedom, %d tolerance samples, %d gearboxes with errors; "
        "%d ranks",
        DOFS,
        design.tolerances.samples,
        design.population.gearboxes,
        comm.size,
    )
    blocks = enumerate(block_sizes(design.population.gearboxes, BLOCK_SIZE))
    groups: Tasks = {
        "cycle": [partial(one_load_cycle, design)],
        "braked": [partial(braked_load_shares, design, side) for side in DIRECTIONS],
        "stack_up": [partial(sample_stack_up, design, kind) for kind in MESH_COUNTS],
        "population": [partial(block_shares, design, block, size) for block, size in blocks],
    }
    done, seconds = run_tasks(comm, groups)
    cycle, stacks = done["cycle"][0], dict(zip(MESH_COUNTS, done["stack_up"], strict=True))
    shares = PopulationShares(
        *(
            np.concatenate([getattr(part, kind) for part in done["population"]])
            for kind in ("static", "mean", "largest")
        )
    )
    limit = design.load.largest_share
    at_rest = first_share_crossing(static_sharing(design, "B"), 1e3 * design.load.peak)
    values: dict[str, float | list[float]] = {
        "spearman_rack_pinion": [stacks["rack_pinion"][1][name] for name in RANKED_TOLERANCES],
        "first_crossing_static": 1e-3 * at_rest,
        "first_crossing_dynamic": 1e-3 * cycle.first_crossing(),
        **{f"braked_{side}": b.tolist() for side, b in zip(DIRECTIONS, done["braked"])},
        "overloaded_static": float((shares.static > limit).any(axis=1).sum()),
        "overloaded_dynamic": float((shares.largest > limit).any(axis=1).sum()),
        "largest_static_share": float(shares.static.max()),
        "largest_dynamic_mean_share": float(shares.mean.max()),
        "largest_dynamic_share": float(shares.largest.max()),
        "natural_frequencies": natural_frequencies(design).tolist(),
    }
    for kind in ("rack_pinion", "g1_g1"):
        values[f"largest_error_{kind}"] = 1e6 * float(np.abs(stacks[kind][0]).max())
    tables = {
        "static": _static(design),
        "flex_unit": _flex_unit(design),
        "spearman": _spearman(design, stacks),
        "stack_up": {f"{kind}_um": 1e6 * samples for kind, (samples, _) in stacks.items()},
        "population": {
            "gearbox": np.arange(1, len(shares.static) + 1),
            **_by_pinion("static_", shares.static),
            **_by_pinion("mean_", shares.mean),
            **_by_pinion("largest_", shares.largest),
        },
    }
    values |= _shares_at_forces(design, cycle)
    return Computed(_history(cycle), tables, values, seconds)


def _by_pinion(name: str, values: np.ndarray, unit: str = "") -> dict[str, np.ndarray]:
    """Columns of values (n, 8)."""
    return {f"{name}{k}{unit}": column for k, column in enumerate(values.T, start=1)}


def _shares_at_forces(design: CascadeDesign, cycle: LoadCycle) -> dict[str, list[float]]:
    """Load shares at the rack forces of the design, at rest and in motion."""
    even, values = even_pinion_mask(), {}
    for force in design.load.forces:
        name = number_label(force)
        for direction in DIRECTIONS:
            shares = static_sharing(design, direction).shares(1e3 * force)
            values[f"static_{direction}_{name}"] = shares.tolist()
        equal = static_sharing(design, "B", equal_units=True).shares(1e3 * force)
        values[f"static_equal_B_{name}"] = [equal[~even].mean(), equal[even].mean()]
        moving = cycle.shares_at(1e3 * force)
        values[f"dynamic_B_{name}"] = moving.tolist()
        values[f"dynamic_mean_B_{name}"] = [moving[~even].mean(), moving[even].mean()]
    return values


def _history(cycle: LoadCycle) -> Columns:
    return {
        "time_s": cycle.time,
        "rack_force_kN": 1e-3 * cycle.rack_force,
        "rack_displacement_mm": 1e3 * cycle.displacement,
        "rack_velocity_m_s": cycle.velocity,
        **_by_pinion("pinion_force_", 1e-3 * cycle.pinion_forces, "_kN"),
        **_by_pinion("share_", cycle.shares),
    }


def _static(design: CascadeDesign) -> Columns:
    """Load shares at rest against the rack force."""
    force = np.linspace(0.0, design.load.peak, 201)[1:]
    table = {"rack_force_kN": force}
    for direction in DIRECTIONS:
        table |= _by_pinion(f"{direction}_", static_sharing(design, direction).shares(1e3 * force))
    equal = static_sharing(design, "B", equal_units=True).shares(1e3 * force)
    return table | {"B_equal_odd": equal[:, 0], "B_equal_even": equal[:, 1]}


def _flex_unit(design: CascadeDesign) -> Columns:
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
) -> Columns:
    rows = [
        (kind, name, 1e6 * limit, stacks[kind][1][name])
        for kind in MESH_COUNTS
        for name, limit in contributions(design, kind).items()
    ]
    names = "mesh", "tolerance", "limit_um", "rank"
    return {name: np.array(column) for name, column in zip(names, zip(*rows, strict=True))}
