"""Fatigue of the flexible spline over a turn of the wave generator or a load program: safety,
places, life."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from mpi4py import MPI

from swgpar.answers.answer import (
    AnswerGroup,
    AnswerKind,
    answer,
    evaluation,
    joined_error,
    part_answers,
    place_text,
)
from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.fatigue_criteria import (
    CriticalPlane,
    critical_plane,
    crossland,
    damage,
    fatigue_limits,
    goodman,
    normal_stress,
)
from swgpar.evaluation.stress_cycle import StressCycle
from swgpar.evaluation.stress_factors import StressFactor
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.stress import principal
from swgpar.largest_stress.places import APART_DISTANCE, near_contact
from swgpar.load.load_states import Stage
from swgpar.model.regions import warning_of
from swgpar.results.sector_fields import SectorFields

WARNING = (
    "the strengths in [fatigue] are the user's responsibility: the defaults are those of a steel "
    "like 30CrNiMo8 and "
    "replace no test of the part"
)

LARGEST = 1000.0
"""Largest safety factor in the fields."""

ROOT, CONTACT = "tooth root", "flank under contact"

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")
CRITERIA = {"goodman": "by Goodman", "crossland": "by Crossland", "yield": "against yield"}
"""Criteria of the safety, with words for them."""

SAME = 1e-6
"""Relative difference below which two utilisations are equal."""


@dataclass(frozen=True)
class LeastSafety:
    """The node with the least safety by a criterion.

    safety : the factor
    amplitude_MPa, mean_MPa : of the normal stress on Goodman's critical plane
    region, radius, z : mm, as of a `Place`;  angle_deg : from the middle of its tooth,
    counter-clockwise
    """

    safety: float
    amplitude_MPa: float
    mean_MPa: float
    region: str
    radius: float
    z: float
    angle_deg: float

    @property
    def place(self) -> str:
        """Words for the place."""
        return place_text(self.region, None, self.radius, self.z)


@dataclass(frozen=True)
class RegionSafety:
    """Least safety factors of a region.

    safety : by criterion
    amplitude_MPa, mean_MPa : where the safety by Goodman is the least;  warning : why it depends on
    the mesh
    """

    safety: Mapping[str, float]
    amplitude_MPa: float
    mean_MPa: float
    warning: str


@evaluation
class Life:
    """Damage and life by Basquin, in turns of the wave generator or in passages of the load
    program.

    Values of the other kind are None. Without damage the life is None, without end. Where the
    stress exceeds the tensile strength, the life is 0 and the damage None.
    """

    damage_per_turn: float | None = None
    life_turns: float | None = answer(
        "fatigue.life_turns", "life by Basquin, turns of the wave generator", default=None
    )
    life_hours: float | None = answer("fatigue.life_hours", "life by Basquin", "h", default=None)
    cycles_per_turn: float | None = None
    damage_per_program: float | None = None
    life_programs: float | None = answer(
        "fatigue.life_programs", "life by Basquin, passages of the load program", default=None
    )


@evaluation
class SafetyAndLife(AnswerGroup):
    """Least safety factors of the flexible spline and its life.

    least : by criterion, of `CRITERIA`;  regions : of every region by its name
    normal : (3,) of the critical plane, in the frame of the tooth (y radial)
    mesh_error : of Goodman's safety by the windows, None where they do not resolve its region or
    it is not known
    sampling_error : its change by half as many angles, None for an odd number of them
    root_factor, root_factor_error : None without windows
    factors : on nodal averages, by region that windows resolve
    windows : whether windows resolve the stress at the teeth where the design asks for it
    phases : of a cycle, or points of the load program
    """

    least: Mapping[str, LeastSafety] = part_answers(
        *(
            AnswerKind(
                f"fatigue.{name}",
                f"least safety factor {words}",
                path=f"least.{name}.safety",
                place=f"least.{name}.place",
                error="goodman_error" if name == "goodman" else "",
            )
            for name, words in CRITERIA.items()
        ),
        AnswerKind(
            "fatigue.amplitude",
            "amplitude of the normal stress where Goodman's safety is the least",
            "MPa",
            "least.goodman.amplitude_MPa",
        ),
        AnswerKind("fatigue.mean", "its mean", "MPa", "least.goodman.mean_MPa"),
    )
    regions: Mapping[str, RegionSafety]
    normal: tuple[float, float, float]
    mesh_error: float | None
    sampling_error: float | None
    life: Life
    root_factor: float | None = answer(
        "fatigue.root_factor",
        "factor of windows on stresses in the tooth root",
        error="root_factor_error",
    )
    root_factor_error: float | None
    windows: bool
    phases: int
    factors: Mapping[str, float] = field(default_factory=dict)
    fatigue_limit_of_the_part_MPa: float = answer(
        "fatigue.limit_of_the_part",
        "fatigue limit with surface and size factors",
        "MPa",
        detail=True,
        exact=True,
    )

    TITLE = "safety and life of the flexible spline"
    ASKED_BY = "[fatigue]"
    SECTION = "fatigue"

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        left_out = ("_turns", "_hours") if design.has_program else ("_programs",)
        return tuple(kind for kind in super().kinds(design) if not kind.name.endswith(left_out))

    @property
    def goodman_error(self) -> float | None:
        """Error of Goodman's safety; None where a part of it is not known."""
        return joined_error(self.mesh_error, self.sampling_error)

    def remarks(self) -> Iterator[str]:
        if self.life.life_turns is None and self.life.life_programs is None:
            yield "life by Basquin: without end"
        if not self.root_factor:
            missing = (
                ": set output.root_stress = true"
                if self.windows
                else ": there are no windows in this run"
            )
            yield f"stresses in the tooth root are nodal averages, up to 25 % low{missing}"
        yield WARNING


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

    In a load program the least of all sectors stand for a node.

    factors : on nodal stresses, by region;  root : that of the teeth, None without windows
    """
    model = cycle.model
    comm, fatigue = model.comm, model.design.fatigue
    regions, warnings = _regions(cycle)
    scale = np.ones(len(regions))
    for region, one in factors.items():
        scale[regions == region] = one.factor
    mine, stress = cycle.history()
    stress *= scale[mine][:, None]
    plane = critical_plane(stress, fatigue, model.design.drive.model == "plane")
    utilisation = {
        "goodman": plane.utilisation,
        "crossland": crossland(stress, fatigue),
        "yield": principal(stress)[2].max(axis=0) / fatigue.yield_strength,
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

    None for an odd number of them, and for a load program.
    """
    if cycle.sequence.points or cycle.sequence.samples % 2:
        return None
    halves = values.reshape(-1, 2)
    high, low = halves.max(axis=0), halves.min(axis=0)
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
