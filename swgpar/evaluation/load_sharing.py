"""How the touching pairs of flanks share the load over the rotation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from swgpar.answers.answer import AnswerGroup, AnswerKind, answer, evaluation, part_answers
from swgpar.evaluation.contact_error_shares import UNKNOWN, ContactErrorShares, error_of_largest
from swgpar.results.history import Row


@dataclass(frozen=True)
class Spread:
    """Mean, smallest and largest of a number over the increments."""

    mean: float
    smallest: float
    largest: float


def _pairs(name: str, words: str, part: str) -> AnswerKind:
    text = f"pairs of flanks in contact, {words} over the rotation"
    return AnswerKind(f"sharing.{name}", text, path=f"pairs.{part}", exact=True)


PAIRS = _pairs("pairs", "mean", "mean")
MOST_PAIRS = _pairs("largest_pairs", "most", "largest")
FEWEST_PAIRS = _pairs("smallest_pairs", "fewest", "smallest")
FORCE_SHARE = AnswerKind(
    "sharing.largest_force_share",
    "largest share of one tooth in the force of all pairs",
    error="force_share_error",
)


@evaluation
class LoadSharing(AnswerGroup):
    """Numbers of touching pairs of flanks and their largest shares of the load over the rotation.

    largest_line_load_Nmm : None where no contact is known
    opposing_torque_share : over the sum of all absolute values, mean
    torque_error : largest, over the sum of their absolute values
    force_share_error, force_error, line_load_error, lobe_share_error : None where they are not
    known
    """

    pairs: Spread = part_answers(PAIRS, MOST_PAIRS, FEWEST_PAIRS)
    teeth_share: Spread = answer(
        "sharing.teeth_share",
        "share of the flexible spline's teeth in contact, mean over the rotation",
        path="teeth_share.mean",
        exact=True,
    )
    largest_force_share: float = part_answers(FORCE_SHARE)
    largest_force_N: float = answer(
        "sharing.largest_force", "largest force of one pair", "N", error="force_error"
    )
    largest_line_load_Nmm: float | None = answer(
        "sharing.largest_line_load",
        "largest line load of one pair",
        "N/mm",
        error="line_load_error",
    )
    opposing_torque_share: float = answer(
        "sharing.opposing_torque_share",
        "share of torques that push against the others",
        detail=True,
    )
    torque_error: float = answer(
        "sharing.torque_error",
        "relative difference of the torques of pairs and teeth",
        detail=True,
        exact=True,
    )
    force_share_error: float | None = None
    force_error: float | None = None
    line_load_error: float | None = None
    largest_lobe_share: float | None = answer(
        "sharing.largest_lobe_share",
        "largest share of the pairs at one lobe in the force of all pairs",
        error="lobe_share_error",
        default=None,
    )
    lobe_share_error: float | None = None

    TITLE = "load sharing over the rotation"
    IN_PROGRAMS = False


def load_sharing(
    pairs: Sequence[Row],
    tooth_torque: Sequence[float],
    increments: Sequence[int],
    teeth: int,
    copies: int,
    lobes: int,
    errors: ContactErrorShares = UNKNOWN,
) -> LoadSharing | None:
    """Numbers of pairs and largest shares over increments; None without pairs in them.

    Parameters
    ----------
    pairs : rows of pairs.csv
    tooth_torque : N mm, of all teeth on the flexible spline, for all increments of the history
    increments : numbers of those that count, from 1
    teeth : of the flexible spline;  copies : how many times the modelled part makes the whole drive
    lobes : of the wave generator
    errors : by the mesh, where they are known
    """
    counts = []
    touching = []
    shares = []
    opposing = []
    differences = []
    lobe_shares = []
    chosen = [pair for pair in pairs if pair["increment"] in set(increments)]
    for increment in increments:
        here = [pair for pair in chosen if pair["increment"] == increment]
        tooth, share = (
            np.array([[pair["tooth"], pair["force_share"]] for pair in here]).reshape(-1, 2).T
        )
        torque = copies * np.array([pair["torque_Nmm"] for pair in here])
        counts.append(copies * len(here))
        touching.append(copies * len(np.unique(tooth)) / teeth)
        size = float(np.abs(torque).sum())
        if size > 0.0:
            shares.append(max(float(share[tooth == one].sum()) for one in np.unique(tooth)))
            lobe_shares.append(
                _largest_lobe_share(here, share, lobes) if copies == 1 else 1 / copies
            )
            opposing.append(0.5 * (size - abs(float(torque.sum()))) / size)
            differences.append(abs(float(torque.sum()) - tooth_torque[increment - 1]) / size)
    if not chosen:
        return None

    def largest(rows: Sequence[Row], name: str) -> float:
        return max((row[name] for row in rows if np.isfinite(row[name])), default=0.0)

    def error(name: str, share: float | None) -> float | None:
        return error_of_largest(chosen, partial(largest, name=name), share)

    loads = np.array([pair["line_load_Nmm"] for pair in chosen])
    return LoadSharing(
        pairs=_spread(counts),
        teeth_share=_spread(touching),
        largest_force_share=max(shares),
        largest_force_N=max(pair["force_N"] for pair in chosen),
        largest_lobe_share=max(lobe_shares),
        largest_line_load_Nmm=float(loads[np.isfinite(loads)].max())
        if np.isfinite(loads).any()
        else None,
        opposing_torque_share=float(np.mean(opposing)),
        torque_error=max(differences),
        force_share_error=error("force_share", errors.force_share),
        force_error=error("force_N", errors.force),
        line_load_error=error("line_load_Nmm", errors.force),
        lobe_share_error=None if copies == 1 else 0.0,
    )


def _largest_lobe_share(pairs: Sequence[Row], share: np.ndarray, lobes: int) -> float:
    """Share of the lobe that carries most.

    pairs : of an increment;  share : (n,) of their forces
    """
    angle = np.array([pair["angle_deg"] for pair in pairs])
    lobe = np.rint(angle * lobes / 360.0).astype(int) % lobes
    return float(np.bincount(lobe, share).max())


def _spread(values: Sequence[float]) -> Spread:
    return Spread(float(np.mean(values)), float(min(values)), float(max(values)))
