"""Summary of a run: its sizes, its evaluations, and the table of all answers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import get_args, get_type_hints

from swgpar.answers.answer import Answer, AnswerGroup, AnswerKind
from swgpar.answers.table import AnswerTable
from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.bearing_loads import BallLoads
from swgpar.evaluation.bolt_loads import BoltLoads
from swgpar.evaluation.frequencies import NaturalFrequencies
from swgpar.evaluation.housing_values import HousingStresses
from swgpar.evaluation.input_coupling import CouplingAtOutput
from swgpar.evaluation.largest_contact import LargestContact
from swgpar.evaluation.load_sharing import LoadSharing
from swgpar.evaluation.losses import DriveLosses
from swgpar.evaluation.numerics import Numerics
from swgpar.evaluation.output_bearing_loads import OutputBearingLoads
from swgpar.evaluation.program_results import ProgramStages
from swgpar.evaluation.ratcheting import RatchetingTorque
from swgpar.evaluation.rigid_clearance import RigidClearance
from swgpar.evaluation.rotation import Rotation
from swgpar.evaluation.safety_and_life import SafetyAndLife
from swgpar.evaluation.slip_error import SlipError
from swgpar.evaluation.step_values import StepValues
from swgpar.evaluation.stiffness import TorsionalStiffness
from swgpar.evaluation.strains import LargestStrains
from swgpar.evaluation.transmission_error import TransmissionError
from swgpar.largest_stress.accuracy import Accuracy
from swgpar.largest_stress.places import LargestStresses
from swgpar.largest_stress.root_stress import RootStress


@dataclass(frozen=True)
class BodySizes:
    """Sizes of a gear.

    nodes, elements, dofs : of the modelled part;  nodes_whole, elements_whole : of the whole gear
    quality : of its elements, "min_scaled_jacobian" among it
    """

    nodes: int
    elements: int
    dofs: int
    nodes_whole: int
    elements_whole: int
    quality: Mapping[str, float]


@dataclass(frozen=True, kw_only=True)
class DriveSummary(AnswerTable):
    """What a whole run gives: a mapping of answers by name, and what they are made of.

    recipe : the mesh recipe, by name or path
    bodies : sizes of each gear, by name
    nodes, elements : of the whole drive;  dofs : unknowns of the modelled part
    copies : how many times the model makes the drive: 1, 2 for a half, 3 for a third
    increments : increments in the history that were computed
    ranks : MPI ranks;  versions : of swgpar, Python, NumPy and PETSc
    wall_s : wall time of the run, s;  phases_s : by phase on the slowest rank
    peak_memory_MB_per_rank : largest memory of each rank
    ratio : speed ratio, input over output
    design : the whole design, defaults included

    The other fields are the evaluations, in the order in which answers are shown; None for what a
    run does not have.

    Examples
    --------
    >>> result.summary["mean.fs_s1"].value, result.summary["root.s1"].error
    >>> result.summary.root_stress.levels
    """

    recipe: str
    bodies: Mapping[str, BodySizes]
    nodes: int
    elements: int
    dofs: int
    copies: int
    increments: int
    ranks: int
    versions: Mapping[str, str]
    wall_s: float
    phases_s: Mapping[str, float]
    peak_memory_MB_per_rank: tuple[float, ...]
    ratio: float
    design: DriveDesign
    stiffness: TorsionalStiffness | None = None
    input_coupling: CouplingAtOutput | None = None
    ratcheting: RatchetingTorque | None = None
    program: ProgramStages | None = None
    root_stress: RootStress | None = None
    accuracy: Accuracy | None = None
    contact: LargestContact | None = None
    load_sharing: LoadSharing | None = None
    rotation: Rotation
    transmission_error: TransmissionError | None = None
    slip: SlipError | None = None
    fatigue: SafetyAndLife | None = None
    losses: DriveLosses | None = None
    bearing: BallLoads | None = None
    output_bearing: OutputBearingLoads | None = None
    bolts: BoltLoads | None = None
    frequencies: NaturalFrequencies | None = None
    housing: HousingStresses | None = None
    stresses: LargestStresses
    strains: LargestStrains | None = None
    steps: StepValues
    clearance: RigidClearance | None = None
    numerics: Numerics

    def groups(self) -> list[AnswerGroup]:
        """The evaluations that the run has, in the order of `ANSWER_GROUPS`."""
        found = (getattr(self, name) for name in ANSWER_GROUPS)
        return [group for group in found if group is not None]

    def not_asked_for(self) -> list[type[AnswerGroup]]:
        """Evaluations that need a section of the design which it does not have, or windows."""
        sections = [
            kind
            for kind in ANSWER_GROUPS.values()
            if kind.SECTION and getattr(self.design, kind.SECTION) is None
        ]
        return sections if self.design.output.root_stress else [*sections, RootStress]

    def answers(self) -> Iterator[Answer]:
        for group in self.groups():
            yield from group.answers()


ANSWER_GROUPS = {
    name: group
    for name, kind in get_type_hints(DriveSummary).items()
    for group in (kind, *get_args(kind))
    if isinstance(group, type) and issubclass(group, AnswerGroup)
}
"""Field of `DriveSummary` -> evaluation."""


def known_answers(design: DriveDesign) -> dict[str, AnswerKind]:
    """The answers that a run of a design has, by name, as far as they are known before it."""
    return {kind.name: kind for group in ANSWER_GROUPS.values() for kind in group.kinds(design)}
