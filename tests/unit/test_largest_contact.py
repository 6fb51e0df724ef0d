"""The largest pressure of the flanks is the largest of all pairs, on edges too."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import swgpar
from support.paths import DRIVERS
from swgpar.answers.answer import NO_ESTIMATE, NO_LIMIT, Answer
from swgpar.drive_results.report_checks import HELPS, checks
from swgpar.evaluation.contact_error_shares import UNKNOWN, ContactErrorShares
from swgpar.evaluation.largest_contact import POWERS, largest_contact
from swgpar.flank_pressure.pair_contact import PairContact
from swgpar.results.history import Row
from swgpar.systems.drive import DRIVE

INVOLUTE = (
    "load.torque=10",
    "drive.teeth_fs=200",
    "drive.teeth_rg=202",
    "drive.module=0.5",
    "flexible_spline.rim=0.6",
    'wave_generator.type="harmonic"',
    'flexible_spline.profile={ type = "involute", cutter_radius = 0.1 }',
    'ring_gear.profile={ type = "involute", cutter_radius = 0.1, cutter_teeth = 150 }',
    "ring_gear.rim=5",
    "steps.rotation=0",
    "output.contact_errors=false",
    "steps.samples=0",
)
"""Involutes whose tips carry most of the load."""


def row(pressure: float, force: float, edge_place: str = "", increment: int = 1) -> Row:
    contact = PairContact(
        tooth=7,
        flank="clockwise",
        ring_tooth=7,
        angle_deg=0.0,
        force_N=force,
        force_share=0.5,
        torque_Nmm=0.0,
        pressure_MPa=pressure,
        shear_MPa=0.3 * pressure,
        line_load_Nmm=0.1 * force,
        half_width_mm=0.02,
        radius_mm=50.0,
        z_mm=0.0,
        edge=int(bool(edge_place)),
        edge_place=edge_place,
    )
    return {"increment": increment, "step": 3, "wg_angle_deg": 0.0, **contact.row()}


def answers(*rows: Row, errors: ContactErrorShares = UNKNOWN) -> dict[str, Answer]:
    contact = largest_contact(rows, errors)
    assert contact is not None
    return {one.name: one for one in contact.answers()}


def test_a_pair_on_an_edge_is_the_largest_without_a_limit() -> None:
    found = answers(row(17.0, 42.0), row(900.0, 107.0, "tip of the ring gear"))
    assert found["contact.pressure"].value == 900.0 and found["contact.force"].value == 107.0
    assert found["contact.pressure_off_edges"].value == 17.0
    assert found["contact.edge_force"].value == 107.0 and found["contact.on_edge"].value == 1.0
    assert found["contact.pressure"].no_error == found["contact.shear"].no_error == NO_LIMIT
    assert found["contact.pressure_off_edges"].no_error == NO_ESTIMATE
    assert found["contact.pressure"].remark.startswith("107 N on the tip of the ring gear: ")
    assert not found["contact.pressure_off_edges"].remark


def test_off_edges_the_two_are_one() -> None:
    found = answers(row(600.0, 200.0), row(17.0, 42.0))
    assert found["contact.pressure"].value == found["contact.pressure_off_edges"].value == 600.0
    assert found["contact.pressure"].no_error == NO_ESTIMATE
    assert found["contact.edge_force"].value == 0.0


def test_another_pair_on_an_edge_leaves_no_estimate() -> None:
    """Its pressure grows with every finer mesh: that of all pairs has none. That off edges has."""
    errors = ContactErrorShares(pressure=0.02, pressure_off_edges=0.02)
    found = answers(row(731.0, 515.0), row(726.0, 458.0, "tip of the ring gear"), errors=errors)
    assert found["contact.pressure"].value == found["contact.pressure_off_edges"].value == 731.0
    assert found["contact.pressure"].no_error == NO_ESTIMATE
    assert found["contact.pressure"].remark.startswith(
        "another pair lies on an edge, with up to 458"
    )
    off_edges = found["contact.pressure_off_edges"]
    assert off_edges.error == pytest.approx(0.02 * 731.0) and not off_edges.remark
    without = answers(row(731.0, 515.0), row(726.0, 458.0), errors=errors)
    assert without["contact.pressure"].error == off_edges.error


def test_errors_of_what_the_pair_has_beside_follow_on_lines() -> None:
    """In the plane; elsewhere another pair may have the largest pressure on the next mesh."""
    for on_lines in (True, False):
        errors = ContactErrorShares(pressure=0.03, on_lines=on_lines)
        found = answers(row(731.0, 515.0), row(700.0, 458.0), errors=errors)
        share = found["contact.pressure"].error / 731.0
        assert share == pytest.approx(0.03)
        for name, power in POWERS.items():
            expected = power * share * found[name].value if on_lines else None
            assert found[name].error == (expected and pytest.approx(expected))
            assert found[name].no_error == ("" if on_lines else NO_ESTIMATE)
    edge = answers(
        row(731.0, 515.0),
        row(726.0, 458.0, "tip of the ring gear"),
        errors=ContactErrorShares(pressure=0.03, on_lines=True),
    )
    assert all(edge[name].no_error == NO_ESTIMATE for name in POWERS)


def test_what_is_not_known_is_told_with_its_force() -> None:
    """A pair whose pressure could not be computed may have the largest; a very small one is left
    out."""
    unknown = answers(row(600.0, 200.0), row(np.nan, 120.0), row(np.nan, 1.0))
    assert "a pair with 120 N could not be computed" in unknown["contact.pressure"].remark
    small = answers(row(600.0, 200.0), row(np.nan, 1.0))
    assert not small["contact.pressure"].remark
    none = answers(row(np.nan, 120.0))
    assert none["contact.pressure"].value is None
    assert none["contact.pressure"].remark.startswith(NO_ESTIMATE)
    edges = answers(row(900.0, 107.0, "end of the face width"))
    assert edges["contact.pressure_off_edges"].value is None
    assert "107 N" in edges["contact.pressure_off_edges"].remark
    assert largest_contact([]) is None


@pytest.fixture(scope="module")
def involute() -> swgpar.DriveResult:
    design = swgpar.load_design(DRIVERS / "plane_half_turn.toml", INVOLUTE)
    return swgpar.run(design, mesh="plane_coarse", progress=False)


def test_involutes_on_their_tips(involute: swgpar.DriveResult) -> None:
    """Every pair that carries a tenth of the largest force lies on an edge."""
    contact, pairs = involute.summary.contact, involute.pairs
    assert pairs["force_N"][pairs["edge"] == 0].max(initial=0.0) < 0.1 * pairs["force_N"].max()
    assert contact.largest.pressure_MPa == np.nanmax(pairs["pressure_MPa"])
    assert contact.largest.edge_place.startswith("tip of the")
    assert contact.edge_force_N == pairs["force_N"][pairs["edge"] == 1].max()
    verdicts = {check.name: check for check in checks(involute.summary, involute.history)}
    assert verdicts["edge contact"].good is False
    assert verdicts["edge contact"].text.endswith("; " + HELPS["tip of"])
    inside = replace(contact.largest, edge=0, edge_place="")
    off = replace(contact, largest=inside, off_edges=inside)
    other: dict[str, Any] = {
        check.name: check
        for check in checks(replace(involute.summary, contact=off), involute.history)
    }
    assert other["edge contact"].good and "edges carry up to" in other["edge contact"].text


def test_an_edge_is_no_objective(involute: swgpar.DriveResult) -> None:
    measured = DRIVE.measure(involute)
    assert "contact.pressure" in measured.values and "contact.pressure" in measured.unbounded
    assert "contact.pressure_off_edges" not in measured.unbounded
