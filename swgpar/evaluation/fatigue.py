"""Fatigue of the flexible spline over a turn of the wave generator or a load program, from the
stress of every node."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.evaluation.fatigue_criteria import (
    CriticalPlane,
    critical_plane,
    crossland,
    damage,
    fatigue_limits,
    goodman,
    normal_stress,
)
from swgpar.evaluation.safety_and_life import (
    CRITERIA,
    LeastSafety,
    Life,
    RegionSafety,
    SafetyAndLife,
)
from swgpar.evaluation.stress_cycle import StressCycle
from swgpar.evaluation.stress_factors import StressFactor
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.stress import principal
from swgpar.largest_stress.places import APART_DISTANCE, near_contact
from swgpar.load.load_states import Stage
from swgpar.model.regions import warning_of
from swgpar.results.sector_fields import SectorFields

LARGEST = 1000.0
"""Largest safety factor in the fields."""

ROOT, CONTACT = "tooth root", "flank under contact"

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")

SAME = 1e-6
"""Relative difference below which two utilisations are equal."""


@dataclass(frozen=True)
class FatigueResult:
    """Fatigue of a run.

    found : safety factors and life;  sector : nodal fields
    cycle : columns of fatigue_cycle.csv, the stress where Goodman's safety is the least
    """

    found: SafetyAndLife
    sector: SectorFields
    cycle: dict[str, np.ndarray]


def evaluate_fatigue(
    cycle: StressCycle, factors: Mapping[str, StressFactor], root: StressFactor | None = None
) -> FatigueResult:
    """Safety factors of every node of a sector from its stress over the cycle; collective.

    In a load program, and with bolts, the least of all sectors stand for a node.

    factors : on nodal stresses, by region;  root : that of the teeth, None without windows
    """
    model = cycle.model
    comm, fatigue = model.comm, model.design.fatigue
    regions, warnings = _regions(cycle)
    scale, mises = np.ones(len(regions)), np.ones(len(regions))
    for region, one in factors.items():
        scale[regions == region] = one.factor
        mises[regions == region] = one.factor if one.mises is None else one.mises
    mine, stress = cycle.history()
    of_yield = mises[mine] * principal(stress)[2].max(axis=0) / fatigue.yield_strength
    stress *= scale[mine][:, None]
    plane = critical_plane(stress, fatigue, model.design.drive.model == "plane")
    utilisation = {
        "goodman": plane.utilisation,
        "crossland": crossland(stress, fatigue),
        "yield": of_yield,
    }
    own = _largest(
        len(cycle.nodes), mine, {**utilisation, "amplitude": plane.amplitude, "mean": plane.mean}
    )
    parts = comm.allgather(own)
    joined = {name: np.concatenate([part[name] for part in parts]) for name in own}
    nodal = _largest(len(cycle.nodes), np.tile(np.arange(len(cycle.nodes)), len(parts)), joined)
    sound = warnings == ""
    least = {name: _first_largest(np.where(sound, nodal[name], -1.0)) for name in CRITERIA}
    history, normal = _history_at(comm, mine, stress, plane, least["goodman"])
    values = normal_stress(history[:, None], normal[None])[:, 0]
    half = _change_by_half(values, cycle, 1.0 / nodal["goodman"][least["goodman"]])
    scaled = factors.get(str(regions[least["goodman"]]))
    found = SafetyAndLife(
        least={name: _place(cycle, name, least[name], nodal, regions) for name in CRITERIA},
        regions=_by_region(nodal, regions, warnings),
        normal=tuple(normal.tolist()),
        mesh_error=float(scaled.error / scaled.factor / nodal["goodman"][least["goodman"]])
        if scaled is not None and scaled.error is not None
        else None,
        sampling_error=half,
        root_factor=None if root is None else root.factor,
        root_factor_error=None if root is None else root.error,
        factors={region: one.factor for region, one in factors.items()},
        windows=model.design.bearing is None and not cycle.sequence.points,
        life=_life(
            damage(values, fatigue),
            None if cycle.sequence.points else cycle.angle,
            model.design.load.input_speed,
        ),
        phases=len(values),
        fatigue_limit_of_the_part_MPa=float(fatigue_limits(fatigue)[0]),
    )
    table = {
        **_when(cycle, len(values)),
        **dict(zip(COMPONENTS, history.T, strict=True)),
        "normal_stress_MPa": values,
    }
    return FatigueResult(found, _sector(cycle, nodal, regions), table)


def _life(damage_of_cycle: float, angle: float | None, input_speed: float) -> Life:
    """angle : rad, of the wave generator over the cycle; None over a load program

    input_speed : 1/min
    """
    life = 1.0 / damage_of_cycle if damage_of_cycle > 0.0 else None
    finite = np.isfinite(damage_of_cycle)
    if angle is None:
        return Life(damage_per_program=damage_of_cycle if finite else None, life_programs=life)
    cycles = 2.0 * np.pi / angle
    turns = None if life is None else life / cycles
    return Life(
        damage_per_turn=cycles * damage_of_cycle if finite else None,
        life_turns=turns,
        life_hours=None if turns is None else turns / (60.0 * input_speed),
        cycles_per_turn=cycles,
    )


def _when(cycle: StressCycle, count: int) -> dict[str, np.ndarray]:
    """Columns that say when the values of a cycle are: wave-generator angles, in a load program its
    steps too."""
    if not cycle.sequence.points:
        return {"wg_angle_deg": np.degrees(cycle.angle) * np.arange(count) / count}
    angles = np.array([point.angle for point in cycle.sequence.points])
    return {"step": int(Stage.LOAD) + np.arange(count), "wg_angle_deg": angles}


def _regions(cycle: StressCycle) -> tuple[np.ndarray, np.ndarray]:
    """Region and warning (n,) of the kept nodes; collective."""
    geometry, mesh = cycle.model.geometry, cycle.body.layout.mesh
    touched = np.zeros(len(mesh.coords), dtype=bool)
    touched[cycle.nodes] = cycle.model.comm.allreduce(cycle.touched.astype(int), op=MPI.SUM) > 0
    near = near_contact(mesh, touched[None], APART_DISTANCE * geometry.module)[0]
    names = cycle.model.regions[FLEXIBLE_SPLINE][False]
    regions, warnings = [], []
    for node in cycle.nodes:
        region = str(names[node])
        if near[node] and region != ROOT:
            region = CONTACT
        regions.append(region)
        warnings.append(warning_of(geometry, region, mesh.coords[node]))
    return np.array(regions), np.array(warnings)


def _first_largest(values: np.ndarray) -> int:
    """Index of the largest of the values (n,), of equal ones the first.

    Both sides of a sector have the same nodes: round-off must not choose between them.
    """
    return int(np.flatnonzero(values >= values.max() - SAME * abs(values.max()))[0])


def _largest(n: int, index: np.ndarray, columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Largest utilisations of n nodes, amplitude and mean where that by Goodman is the largest; -1
    without values.

    index : (m,) nodes of the values in columns (m,), of which a node may have several
    """
    out = {name: np.full(n, -1.0) for name in columns}
    for name in CRITERIA:
        np.maximum.at(out[name], index, columns[name])
    upward = np.argsort(columns["goodman"], kind="stable")  # of several values the last one is kept
    for name in ("amplitude", "mean"):
        out[name][index[upward]] = columns[name][upward]
    return out


def _history_at(
    comm: MPI.Comm, mine: np.ndarray, stress: np.ndarray, plane: CriticalPlane, node: int
) -> tuple[np.ndarray, np.ndarray]:
    """Stress (n_phases, 6) MPa and normal (3,) of the critical plane at a node, on every rank;
    collective.

    Of several histories at the node it is that with the largest utilisation.
    """
    found, part = np.flatnonzero(mine == node), None
    if len(found):
        at = found[_first_largest(plane.utilisation[found])]
        part = float(plane.utilisation[at]), stress[:, at], plane.normal[at]
    parts = [one for one in comm.allgather(part) if one is not None]
    _, history, normal = parts[_first_largest(np.array([utilisation for utilisation, *_ in parts]))]
    return history, normal


def _change_by_half(values: np.ndarray, cycle: StressCycle, safety: float) -> float | None:
    """Largest change of Goodman's safety with one or the other half of the angles.

    None for a load program.
    """
    if cycle.sequence.points:
        return None
    halves = [values[first::2] for first in (0, 1)]
    high = np.array([half.max() for half in halves])
    low = np.array([half.min() for half in halves])
    utilisation = goodman(0.5 * (high - low), 0.5 * (high + low), cycle.model.design.fatigue)
    return float(np.abs(1.0 / utilisation - safety).max())


def _place(
    cycle: StressCycle, criterion: str, k: int, nodal: dict[str, np.ndarray], regions: np.ndarray
) -> LeastSafety:
    """Safety by a criterion at a node and where it is."""
    mesh = cycle.body.layout.mesh
    x, y, z = mesh.coords[cycle.nodes[k]]
    return LeastSafety(
        safety=_safety(nodal[criterion][k]),
        amplitude_MPa=float(nodal["amplitude"][k]),
        mean_MPa=float(nodal["mean"][k]),
        region=str(regions[k]),
        radius=float(np.hypot(x, y)),
        z=0.0 if mesh.plane else float(z),
        angle_deg=float(np.degrees(np.arctan2(-x, y))),
    )


def _safety(utilisation: float) -> float:
    return float(min(LARGEST, 1.0 / max(utilisation, 1e-300)))


def _by_region(
    nodal: dict[str, np.ndarray], regions: np.ndarray, warnings: np.ndarray
) -> dict[str, RegionSafety]:
    """Least safety factors of every region, with the warnings that belong to it."""
    found = {}
    for region in dict.fromkeys(regions.tolist()):
        here = np.flatnonzero(regions == region)
        at = here[_first_largest(nodal["goodman"][here])]
        found[region] = RegionSafety(
            safety={name: _safety(nodal[name][here].max()) for name in CRITERIA},
            amplitude_MPa=float(nodal["amplitude"][at]),
            mean_MPa=float(nodal["mean"][at]),
            warning=str(warnings[at]),
        )
    return found


def _sector(cycle: StressCycle, nodal: dict[str, np.ndarray], regions: np.ndarray) -> SectorFields:
    """Fields of all nodes of the sector. `region` numbers the regions in the order of
    `SafetyAndLife.regions`."""
    mesh = cycle.body.layout.mesh
    index = np.zeros(len(mesh.coords), dtype=int)
    index[cycle.nodes] = np.arange(len(cycle.nodes))
    if mesh.lower_nodes is not None:
        index = index[mesh.lower_nodes]
    names = list(dict.fromkeys(regions.tolist()))
    fields = {
        f"safety_{name}": np.minimum(LARGEST, 1.0 / np.clip(nodal[name], 1e-300, None))
        for name in CRITERIA
    }
    fields |= {name: nodal[name] for name in ("amplitude", "mean")}
    fields["region"] = np.array([float(names.index(region)) for region in regions])
    return SectorFields(
        mesh.coords, mesh.hexes, {name: values[index] for name, values in fields.items()}
    )
