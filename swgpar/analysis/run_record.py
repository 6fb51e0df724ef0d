"""What a run keeps of its increments beside the fields. All of it is in the checkpoint."""

from __future__ import annotations

from dataclasses import dataclass, field

from swgpar.evaluation.bearing_loads import ComplianceShares
from swgpar.evaluation.contact_error_shares import UNKNOWN, ContactErrorShares
from swgpar.evaluation.frequencies import NaturalMode
from swgpar.evaluation.period_ranges import CoarsePeriod
from swgpar.evaluation.ratcheting import TorquePoint
from swgpar.evaluation.slip_error import SlipCheck
from swgpar.largest_stress.accuracy import Accuracy
from swgpar.largest_stress.places import Place
from swgpar.largest_stress.root_stress import RootStress
from swgpar.largest_stress.wall_stress import CoarseWall, WallStress
from swgpar.results.history import Row


@dataclass
class RunRecord:
    """Record of a run up to the present increment.

    A field has a type that is read back from JSON: numbers, texts, lists, dicts, dataclasses.

    Attributes
    ----------
    rows : history of the increments computed so far
    starts_loaded : whether the history begins with the loaded state
    accuracy : what was asked for and reached, if an accuracy was asked for
    root_stress, wall_stress : of the loaded state, once they are resolved
    places : of the largest nodal averages of stress under load, by column of the history
    loaded : MPa, the averages of the loaded state by the names of `places`
    coarse_wall : stresses of the wall on a coarser mesh; None where they are not known
    contact_errors : by coarser meshes, of what contacts of flanks give
    coarse_period : curves over the sampled period on a coarser mesh
    pairs, contact_lines : rows of pairs.csv and contact_lines.csv
    cam_forces : N, of all increments, with [losses]
    torque_points : states of a prescribed rotation of the output, with [ratcheting] all of them
    slip_checks : increments with friction whose last step was taken again in halves
    turns : rows of transmission_error.csv
    balls : rows of balls.csv, the loads of a bearing's balls
    bolts : rows of bolts.csv
    race_stress : largest stresses of the outer race under load, MPa
    housing : largest values under load, by fields of `HousingStresses`
    bearing_shares : of the bearing in the compliance of the loaded state
    bearing_errors : by coarser meshes, shares of what the bearing gives, by names of answers
    modes : natural modes of the loaded state
    components : of the nodal fields in files, by body and name
    """

    rows: list[Row] = field(default_factory=list)
    starts_loaded: bool = False
    accuracy: Accuracy | None = None
    root_stress: RootStress | None = None
    wall_stress: WallStress | None = None
    places: dict[str, Place] = field(default_factory=dict)
    loaded: dict[str, float] = field(default_factory=dict)
    coarse_wall: CoarseWall | None = None
    contact_errors: ContactErrorShares = UNKNOWN
    coarse_period: CoarsePeriod | None = None
    pairs: list[Row] = field(default_factory=list)
    contact_lines: list[Row] = field(default_factory=list)
    cam_forces: list[float] = field(default_factory=list)
    torque_points: list[TorquePoint] = field(default_factory=list)
    slip_checks: list[SlipCheck] = field(default_factory=list)
    turns: list[Row] = field(default_factory=list)
    balls: list[Row] = field(default_factory=list)
    bolts: list[Row] = field(default_factory=list)
    race_stress: dict[str, float] = field(default_factory=dict)
    housing: dict[str, float] = field(default_factory=dict)
    bearing_shares: dict[str, ComplianceShares] = field(default_factory=dict)
    bearing_errors: dict[str, float] = field(default_factory=dict)
    modes: list[NaturalMode] = field(default_factory=list)
    components: dict[str, dict[str, int]] = field(default_factory=dict)
