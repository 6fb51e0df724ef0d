"""All results of a cascade gearbox."""

from __future__ import annotations

from functools import partial

import numpy as np
from mpi4py import MPI

from swgpar.gear_trains.cascade.design import MESH_COUNTS, PINIONS, CascadeDesign, Direction
from swgpar.gear_trains.cascade.dynamics import natural_frequencies
from swgpar.gear_trains.cascade.flex_unit import FlexUnits
from swgpar.gear_trains.cascade.layout import DOFS
from swgpar.gear_trains.cascade.limit_loads import equal_limit_loads, limit_loads
from swgpar.gear_trains.cascade.load_cycle import LoadCycle, braked_load_shares, one_load_cycle
from swgpar.gear_trains.cascade.population import BLOCK_SIZE, PopulationShares, block_shares
from swgpar.gear_trains.cascade.quantities import RANKED_TOLERANCES
from swgpar.gear_trains.cascade.sorting import Sorting, sort_units
from swgpar.gear_trains.cascade.static_sharing import (
    even_pinion_mask,
    first_share_crossing,
    lateral_force,
    path_gap_angles,
    static_sharing,
)
from swgpar.gear_trains.cascade.tolerance_stack_up import contributions, sample_stack_up
from swgpar.gear_trains.published import number_label
from swgpar.gear_trains.result import Computed
from swgpar.log import logger, ranks_text
from swgpar.results.table import Columns
from swgpar.vibration.sampling import Tasks, block_sizes, run_tasks

DIRECTIONS: tuple[Direction, ...] = ("B", "A")

CURVE_END = 2.5
"""End of the table of the flexible units, over the deformation above which they are linear."""


def compute(design: CascadeDesign, comm: MPI.Comm) -> Computed:
    """All results of a design, the same on all ranks; collective."""
    logger.info(
        "cascade gearbox: %d degrees of freedom, %d tolerance samples, %d gearboxes with errors; "
        "%s",
        DOFS,
        design.tolerances.samples,
        design.population.gearboxes,
        ranks_text(comm.size),
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
        **_limit_loads(design),
    }
    for kind in ("rack_pinion", "g1_g1"):
        values[f"largest_error_{kind}"] = 1e6 * float(np.abs(stacks[kind][0]).max())
    sorting = sort_units(design)
    values["best_even_units"] = sorting.even_units[0].tolist()
    values["largest_share_best_units"] = float(sorting.largest[0])
    tables = {
        "static": _static(design),
        "gaps": _gaps(design),
        "flex_unit": _flex_unit(design),
        "sorting": _sorting(sorting),
        "spectrum": _spectrum(cycle),
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
    return Computed(_history(design, cycle), tables, values, seconds)


def _by_pinion(name: str, values: np.ndarray, unit: str = "") -> dict[str, np.ndarray]:
    """Columns of values (n, 8)."""
    return {f"{name}{k}{unit}": column for k, column in enumerate(values.T, start=1)}


def _limit_loads(design: CascadeDesign) -> dict[str, float | list[float]]:
    """Limit loads in kN, of each pinion and of the rack."""
    if (deformation := design.flex_unit.largest_deformation) is None:
        return {}
    found = {"equal": equal_limit_loads(design, deformation)}
    found |= {side: limit_loads(design, side, deformation) for side in DIRECTIONS}
    loads: dict[str, float | list[float]] = {}
    for name, forces in found.items():
        loads[f"limit_load_{name}"] = (1e-3 * forces).tolist()
        loads[f"limit_total_{name}"] = 1e-3 * float(forces.sum())
    return loads


def _shares_at_forces(design: CascadeDesign, cycle: LoadCycle) -> dict[str, float | list[float]]:
    """Load shares and lateral forces at the rack forces of the design, at rest and in motion."""
    even = even_pinion_mask()
    values: dict[str, float | list[float]] = {}
    for force in design.load.forces:
        name = number_label(force)
        for direction in DIRECTIONS:
            shares = static_sharing(design, direction).shares(1e3 * force)
            values[f"static_{direction}_{name}"] = shares.tolist()
            across = lateral_force(design, force * shares)
            values[f"lateral_{direction}_{name}"] = float(across)
        equal = static_sharing(design, "B", equal_units=True).shares(1e3 * force)
        values[f"static_equal_B_{name}"] = [equal[~even].mean(), equal[even].mean()]
        moving = cycle.shares_at(1e3 * force)
        values[f"dynamic_B_{name}"] = moving.tolist()
        values[f"dynamic_mean_B_{name}"] = [moving[~even].mean(), moving[even].mean()]
    return values


def _history(design: CascadeDesign, cycle: LoadCycle) -> Columns:
    return {
        "time_s": cycle.time,
        "rack_force_kN": 1e-3 * cycle.rack_force,
        "rack_displacement_mm": 1e3 * cycle.displacement,
        "rack_velocity_m_s": cycle.velocity,
        **_by_pinion("pinion_force_", 1e-3 * cycle.pinion_forces, "_kN"),
        **_by_pinion("share_", cycle.shares),
        "lateral_force_kN": 1e-3 * lateral_force(design, cycle.pinion_forces),
    }


def _static(design: CascadeDesign) -> Columns:
    """Load shares at rest against the rack force."""
    force = np.linspace(0.0, design.load.peak, 201)[1:]
    table = {"rack_force_kN": force}
    for direction in DIRECTIONS:
        shares = static_sharing(design, direction).shares(1e3 * force)
        table |= _by_pinion(f"{direction}_", shares)
        across = lateral_force(design, force[:, None] * shares)
        table[f"{direction}_lateral_force_kN"] = across
    equal = static_sharing(design, "B", equal_units=True).shares(1e3 * force)
    return table | {"B_equal_odd": equal[:, 0], "B_equal_even": equal[:, 1]}


def _gaps(design: CascadeDesign) -> Columns:
    """Gaps on the paths of the pinions, at the pitch line of the rack in mm.

    measured_… : differences of the gaps with which the pinions would carry measured load shares
    """
    at_rack = 1e3 * design.radius("pinion")
    table: dict[str, np.ndarray] = {"pinion": np.arange(1, PINIONS + 1)}
    for side in DIRECTIONS:
        table[f"{side}_mm"] = at_rack * path_gap_angles(design, side)
    for side in DIRECTIONS:
        for force in design.load.forces:
            name = f"static_{side}_{number_label(force)}"
            if (shares := design.measured.get(name)) is not None:
                carried = 1e3 * force * np.array(shares) / np.sum(shares)
                gaps = static_sharing(design, side).gaps_of(carried)
                table[f"measured_{name}_mm"] = at_rack * gaps
    return table


def _sorting(sorting: Sorting) -> Columns:
    """A row for each choice of the units of the even pinions, the best first."""
    return {
        **{f"pinion_{2 * k}": units for k, units in enumerate(sorting.even_units.T, start=1)},
        "largest_share": sorting.largest,
    }


def _spectrum(cycle: LoadCycle) -> Columns:
    """Amplitudes of rack force and pinion forces over the frequency, of one period."""
    count, period = len(cycle.time) - 1, cycle.time[-1]
    forces = np.column_stack([cycle.rack_force, cycle.pinion_forces])[:count]
    amplitudes = 2e-3 / count * np.abs(np.fft.rfft(forces, axis=0))[1 : count // 2]
    return {
        "frequency_Hz": np.arange(1, count // 2) / period,
        "rack_force_kN": amplitudes[:, 0],
        **_by_pinion("pinion_force_", amplitudes[:, 1:], "_kN"),
    }


def _flex_unit(design: CascadeDesign) -> Columns:
    """The curves of the flexible units: the mean one, and that of each pinion."""
    units, section = FlexUnits.of(design), design.flex_unit
    deformation = np.linspace(0.0, CURVE_END * section.linear_above, 101)
    twist = deformation / section.radius
    torque, stiffness = units.torque(twist), units.tangent(twist) * np.pi / 180.0
    return {
        "deformation_mm": deformation,
        "torque_Nm": torque,
        "stiffness_Nm_per_deg": stiffness,
        **_by_pinion("torque_", np.outer(torque, units.ratios), "_Nm"),
        **_by_pinion("stiffness_", np.outer(stiffness, units.ratios), "_Nm_per_deg"),
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
