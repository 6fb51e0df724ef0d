"""How the touching pairs of flanks share the load over the rotation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from swgpar.results.history import Row


def load_sharing(
    pairs: Sequence[Row], tooth_torque: Sequence[float], increments: Sequence[int], teeth: int, copies: int
) -> dict[str, Any] | None:
    """Numbers of pairs and largest shares over increments; None without pairs in them.

    Parameters
    ----------
    pairs : rows of pairs.csv
    tooth_torque : N mm, of all teeth on the flexible spline, for all increments of the history
    increments : numbers of those that count, from 1
    teeth : of the flexible spline;  copies : how many times the modelled part makes the whole drive

    Returns
    -------
    dict
        ``pairs`` and ``teeth_share`` (share of the teeth of the flexible spline that touch), each with ``mean``,
        ``smallest`` and ``largest``; ``largest_force_share`` of one tooth in the forces of all; ``largest_force_N`` and
        ``largest_line_load_Nmm`` of one pair; ``opposing_torque_share``, the torque of the pairs that push against the
        others over the sum of all absolute values, mean; ``torque_error``, the largest difference between the sum of
        the torques of the pairs and that of the teeth, over the sum of their absolute values
    """
    counts, touching, shares, opposing, errors = [], [], [], [], []
    chosen = [pair for pair in pairs if pair["increment"] in set(increments)]
    for increment in increments:
        here = [pair for pair in chosen if pair["increment"] == increment]
        tooth, share = np.array([[pair["tooth"], pair["force_share"]] for pair in here]).reshape(-1, 2).T
        torque = copies * np.array([pair["torque_Nmm"] for pair in here])
        counts.append(copies * len(here))
        touching.append(copies * len(np.unique(tooth)) / teeth)
        size = float(np.abs(torque).sum())
        if size > 0.0:
            shares.append(max(float(share[tooth == one].sum()) for one in np.unique(tooth)))
            opposing.append(0.5 * (size - abs(float(torque.sum()))) / size)
            errors.append(abs(float(torque.sum()) - tooth_torque[increment - 1]) / size)
    if not chosen:
        return None
    loads = np.array([pair["line_load_Nmm"] for pair in chosen])
    return {
        "pairs": _spread(counts),
        "teeth_share": _spread(touching),
        "largest_force_share": max(shares),
        "largest_force_N": max(pair["force_N"] for pair in chosen),
        "largest_line_load_Nmm": float(loads[np.isfinite(loads)].max()) if np.isfinite(loads).any() else None,
        "opposing_torque_share": float(np.mean(opposing)),
        "torque_error": max(errors),
    }


def _spread(values: Sequence[float]) -> dict[str, float]:
    return {"mean": float(np.mean(values)), "smallest": float(min(values)), "largest": float(max(values))}
