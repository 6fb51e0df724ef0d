"""All computations of a cascade gearbox: what `swgpar run` and `swgpar check` do with one."""

from __future__ import annotations

from functools import partial

import numpy as np
from mpi4py import MPI

from swgpar.gear_trains.cascade.design import PINIONS, CascadeDesign
from swgpar.gear_trains.cascade.dynamics import natural_frequencies
from swgpar.gear_trains.cascade.flex_unit import FlexUnits
from swgpar.gear_trains.cascade.layout import DOFS, FLYWHEEL, masses, rigid_displacements
from swgpar.gear_trains.cascade.load_cycle import LoadCycle, braked_load_shares, one_load_cycle
from swgpar.gear_trains.cascade.population import PopulationShares, population_tasks
from swgpar.gear_trains.cascade.static_sharing import (
    MESH_COUNTS,
    even_pinion_mask,
    first_crossing,
    path_gap_angles,
    static_sharing,
)
from swgpar.gear_trains.cascade.tolerance_stack_up import contributions, stack_up_tasks, standard_deviation
from swgpar.gear_trains.published import Quantities, number_label
from swgpar.gear_trains.result import Table, TrainResult
from swgpar.gear_trains.sampling import run_tasks
from swgpar.log import logger

EACH = [f"{k}" for k in range(1, PINIONS + 1)]
CURVE_END = 2.5
"""Of the table of the flexible units, over the deformation from which they are linear."""

RANKED_TOLERANCES = (
    "pitch deviation pinion",
    "runout pinion",
    "pitch deviation rack",
    "runout rack",
    "position pinion",
)
RANKED_TOLERANCES = (*RANKED_TOLERANCES, "axle angle pinion")
"""Tolerances of the rack and the pinions, in the order of Table 2."""


def quantities(design: CascadeDesign) -> Quantities:
    """What can be compared with published values."""
    known = {
        "spearman_rack_pinion": (f"Spearman's ranks of {', '.join(RANKED_TOLERANCES)}", len(RANKED_TOLERANCES)),
        "largest_error_rack_pinion": ("largest sample of the stack-up of rack and pinion (µm)", 1),
        "largest_error_g1_g1": ("largest sample of the stack-up of two G1 (µm)", 1),
        "first_crossing_static": ("lowest rack force at which load shares cross at rest, direction B (kN)", 1),
        "first_crossing_dynamic": ("lowest rack force at which load shares cross in motion, direction B (kN)", 1),
        "braked_B": ("load shares in motion against the brake, direction B", PINIONS),
        "braked_A": ("load shares in motion against the brake, direction A", PINIONS),
        "overloaded_static": ("overloaded gearboxes at rest", 1),
        "overloaded_dynamic": ("gearboxes overloaded at any moment of the hold", 1),
        "largest_static_share": ("largest load share at rest of all gearboxes with errors", 1),
        "largest_dynamic_mean_share": ("largest mean load share in motion of all gearboxes with errors", 1),
        "largest_dynamic_share": ("largest load share at any moment of the hold, of all gearboxes with errors", 1),
        "natural_frequencies": ("natural frequencies, the first that of the free turning (Hz)", DOFS),
    }
    for force in design.load.forces:
        name = number_label(force)
        known[f"static_B_{name}"] = (f"load shares at rest at {force:g} kN, direction B", PINIONS)
        known[f"static_A_{name}"] = (f"load shares at rest at {force:g} kN, direction A", PINIONS)
        known[f"static_equal_B_{name}"] = (f"at {force:g} kN of odd and even pinions with equal flexible units", 2)
        known[f"dynamic_B_{name}"] = (f"load shares in motion at {force:g} kN, direction B", PINIONS)
        known[f"dynamic_mean_B_{name}"] = (f"load shares in motion at {force:g} kN, means of odd and even pinions", 2)
    return known


def derived(design: CascadeDesign) -> dict[str, float]:
    """What follows from the design file at once, for `swgpar check`."""
    units, displacements, mass = FlexUnits.of(design), rigid_displacements(design), masses(design)
    frequencies = natural_frequencies(design)
    out = {
        "speed of the flywheel over the pinions": design.ratio,
        "pitch radius of the pinions (mm)": 1e3 * design.radius("pinion"),
        "mass moved at the rack (kg)": float(mass @ displacements**2),
        "mass of the flywheel at the rack (kg)": float(mass[FLYWHEEL] * displacements[FLYWHEEL] ** 2),
        "stiffness of a flexible unit at the pinion (N/mm)": 1e-3 * units.stiffness / design.radius("pinion") ** 2,
        "gap of odd pinions in direction B (mm)": 1e3 * path_gap_angles(design, "B")[0] * design.radius("pinion"),
        "gap of even pinions in direction B (mm)": 1e3 * path_gap_angles(design, "B")[1] * design.radius("pinion"),
        "lowest natural frequency (Hz)": frequencies[1],
        "highest natural frequency (Hz)": frequencies[-1],
    }
    for kind in MESH_COUNTS:
        out[f"standard deviation of {kind} errors (µm)"] = 1e6 * standard_deviation(design, kind)
    return {name: float(value) for name, value in out.items()}


def compute(design: CascadeDesign, comm: MPI.Comm) -> TrainResult:
    """All results of a design, the same on all ranks; collective."""
    first = [
        partial(one_load_cycle, design),
        partial(braked_load_shares, design, "B"),
        partial(braked_load_shares, design, "A"),
    ]
    tolerances, gearboxes = stack_up_tasks(design), population_tasks(design)
    logger.info(
        "cascade gearbox: %d degrees of freedom, %d tolerance samples, %d gearboxes with errors; %d ranks",
        DOFS,
        design.tolerances.samples,
        design.population.gearboxes,
        comm.size,
    )
    done = run_tasks(comm, [*first, *tolerances, *gearboxes])
    period, braked_b, braked_a = done[:3]
    stacks = dict(zip(MESH_COUNTS, done[3 : 3 + len(tolerances)], strict=True))
    parts: list[PopulationShares] = done[3 + len(tolerances) :]
    shares = PopulationShares(*(np.concatenate([getattr(p, k) for p in parts]) for k in ("static", "mean", "largest")))

    limit = 1.0 / PINIONS + design.load.overload
    even = even_pinion_mask()
    values: dict[str, float | list[float]] = {
        "spearman_rack_pinion": [stacks["rack_pinion"][1][name] for name in RANKED_TOLERANCES],
        "first_crossing_static": 1e-3 * first_crossing(static_sharing(design, "B"), 1e3 * design.load.peak),
        "first_crossing_dynamic": 1e-3 * period.first_crossing(),
        "braked_B": braked_b.tolist(),
        "braked_A": braked_a.tolist(),
        "overloaded_static": float((shares.static > limit).any(axis=1).sum()),
        "overloaded_dynamic": float((shares.largest > limit).any(axis=1).sum()),
        "largest_static_share": float(shares.static.max()),
        "largest_dynamic_mean_share": float(shares.mean.max()),
        "largest_dynamic_share": float(shares.largest.max()),
        "natural_frequencies": natural_frequencies(design).tolist(),
    }
    for kind in ("rack_pinion", "g1_g1"):
        values[f"largest_error_{kind}"] = 1e6 * float(np.abs(stacks[kind][0]).max())
    for force in design.load.forces:
        name = number_label(force)
        for direction in ("B", "A"):
            values[f"static_{direction}_{name}"] = static_sharing(design, direction).shares(1e3 * force).tolist()
        equal = static_sharing(design, "B", equal_units=True).shares(1e3 * force)
        values[f"static_equal_B_{name}"] = [equal[~even].mean(), equal[even].mean()]
        moving = period.shares_at(1e3 * force)
        values[f"dynamic_B_{name}"] = moving.tolist()
        values[f"dynamic_mean_B_{name}"] = [moving[~even].mean(), moving[even].mean()]
    tables = {
        "static": _static(design),
        "flex_unit": _flex_unit(design),
        "spearman": _spearman(design, stacks),
        "stack_up": {f"{kind}_um": 1e6 * samples for kind, (samples, _) in stacks.items()},
        "population": _population(shares),
    }
    return TrainResult(_history(period), tables, values, {"overload_limit": limit})


def _history(period: LoadCycle) -> Table:
    out = {
        "time_s": period.time,
        "rack_force_kN": 1e-3 * period.rack_force,
        "rack_way_mm": 1e3 * period.displacement,
        "rack_velocity_m_s": period.velocity,
    }
    out |= {f"pinion_force_{k}_kN": 1e-3 * column for k, column in zip(EACH, period.pinion_forces.T, strict=True)}
    return out | {f"share_{k}": column for k, column in zip(EACH, period.shares.T, strict=True)}


def _static(design: CascadeDesign) -> Table:
    """Load shares at rest against the rack force."""
    force = np.linspace(0.0, design.load.peak, 201)[1:]
    out = {"rack_force_kN": force}
    for direction in ("B", "A"):
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


def _spearman(design: CascadeDesign, stacks: dict[str, tuple[np.ndarray, dict[str, float]]]) -> Table:
    rows = [
        (kind, name, 1e6 * limit, stacks[kind][1][name])
        for kind in MESH_COUNTS
        for name, limit in contributions(design, kind).items()
    ]
    return {k: np.array(c) for k, c in zip(("mesh", "tolerance", "limit_um", "rank"), zip(*rows, strict=True))}


def _population(shares: PopulationShares) -> Table:
    out: dict[str, np.ndarray] = {"gearbox": np.arange(1, len(shares.static) + 1)}
    for name, values in (("static", shares.static), ("mean", shares.mean), ("largest", shares.largest)):
        out |= {f"{name}_{k}": column for k, column in zip(EACH, values.T, strict=True)}
    return out
