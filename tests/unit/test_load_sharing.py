"""Load sharing over the rotation, as a run reports it."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.answers.answer import declared_answers
from swgpar.evaluation.load_sharing import LoadSharing, Spread, load_sharing
from swgpar.systems.drive import DRIVE


def pair(
    increment: int, tooth: int, share: float, torque: float, line_load: float = np.nan
) -> dict[str, float]:
    return {
        "increment": increment,
        "tooth": tooth,
        "force_share": share,
        "force_N": 100.0 * share,
        "torque_Nmm": torque,
        "line_load_Nmm": line_load,
    }


def test_numbers_and_shares() -> None:
    """Half a drive of 40 teeth: three pairs on two teeth, then one."""
    pairs = [
        pair(1, 5, 0.9, 1e6),
        pair(2, 0, 0.2, 30.0, 4.0),
        pair(2, 0, 0.1, -10.0),
        pair(2, 1, 0.2, 20.0),
        pair(3, 1, 0.5, 40.0, 3.0),
    ]
    found = load_sharing(pairs, [0.0, 80.0, 79.0], (2, 3), teeth=40, copies=2, lobes=2)
    assert found.pairs == Spread(mean=4.0, smallest=2.0, largest=6.0)
    assert asdict(found.teeth_share) == pytest.approx(
        {"mean": 0.075, "smallest": 0.05, "largest": 0.1}
    )
    assert found.largest_force_share == found.largest_lobe_share == 0.5
    assert found.largest_force_N == 50.0 and found.largest_line_load_Nmm == 4.0
    assert found.opposing_torque_share == pytest.approx(0.5 * 20.0 / 120.0)
    assert found.torque_error == pytest.approx(1.0 / 80.0)
    assert load_sharing(pairs, [0.0] * 4, (4,), teeth=40, copies=2, lobes=2) is None


def test_lobes_of_the_whole_drive() -> None:
    """Three lobes: pairs beside the first one, on both sides of the second one, none at the
    third."""
    places = (-50.0, 10.0, 70.0, 170.0, -175.0)
    shares = (0.1, 0.2, 0.15, 0.25, 0.3)
    pairs = [
        {**pair(1, k, share, 1.0), "angle_deg": place}
        for k, (place, share) in enumerate(zip(places, shares, strict=True))
    ]
    found = load_sharing(pairs, [5.0], (1,), teeth=30, copies=1, lobes=3)
    # 170 is nearer to 120 than to -120, -175 is 65 from -120
    assert found.largest_lobe_share == pytest.approx(0.4) and found.lobe_share_error is None
    two = load_sharing(pairs, [5.0], (1,), teeth=30, copies=1, lobes=2)
    assert two.largest_lobe_share == pytest.approx(0.55)


def test_a_run_reports_it() -> None:
    result = swgpar.run(
        swgpar.load_design(DESIGN, [*PLANE, "steps.samples=2", "steps.rotation=9"]), RECIPE
    )
    found, rows = result.summary.load_sharing, result.summary.increments
    history = {name: values[:rows][-2:] for name, values in result.history.items()}
    assert found.pairs.mean == history["pairs_in_contact"].mean()
    assert found.pairs.largest == history["pairs_in_contact"].max()
    assert 0.0 < found.largest_force_share <= 0.5
    assert found.torque_error < 1e-9
    values = DRIVE.measure(result).values
    assert {kind.name for kind in declared_answers(LoadSharing)} <= set(values) and values[
        "sharing.pairs"
    ] == found.pairs.mean
    assert "load_sharing" in result.plot.names
    assert [axes.get_ylabel() for axes in result.plot.load_sharing().axes] == [
        "share of the force (%)",
        "pairs in contact",
    ]
