"""Flanks of the contact between the nodes of their profiles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import swgpar
from support.paths import DATA, DRIVERS, REFERENCE
from swgpar.contact.flank_curve import TERMS, above_cubics
from swgpar.contact.flank_faces import SAMPLES, flank_faces, lagrange
from swgpar.geometry.micro_geometry import FlankCrowning
from swgpar.meshing import build_sector_meshes, load_recipe
from swgpar.profiles.flank import ToothProfile

CONJUGATE = DATA / "public" / "sw50_pancake_conj.toml"


def largest_distance(profile: ToothProfile, s: np.ndarray, bulge: np.ndarray) -> float:
    """Of the curve through the nodes at s (n,) mm from the exact profile, mm.

    bulge : (n - 1, `TERMS`, 2) mm, above the cubics
    """
    t, points, slopes = np.linspace(0.0, 1.0, 51)[:, None], profile.point(s), profile.tangent(s)
    terms = (t * (1.0 - t)) ** 2 * np.vander(t[:, 0] - 0.5, TERMS, increasing=True)
    distances = []
    for i, length in enumerate(np.diff(s)):
        curve = (1.0 - 3.0 * t**2 + 2.0 * t**3) * points[i]
        curve = curve + (3.0 * t**2 - 2.0 * t**3) * points[i + 1]
        curve = curve + length * (t - 2.0 * t**2 + t**3) * slopes[i]
        curve = curve + length * (t**3 - t**2) * slopes[i + 1] + terms @ bulge[i]
        foot = s[i] + length * t[:, 0]
        for _ in range(10):
            along = np.sum((curve - profile.point(foot)) * profile.tangent(foot), axis=1)
            foot = np.clip(foot + along, s[i], s[i + 1])
        distances.append(np.sum((curve - profile.point(foot)) * profile.normal(foot), axis=1))
    return float(np.abs(distances).max())


@pytest.mark.parametrize("path", [REFERENCE, DRIVERS / "three_lobes.toml", CONJUGATE])
def test_the_curve_is_the_exact_flank(path: Path) -> None:
    """To a hundredth of a micrometre on the fewest elements; a cubic is half of one off."""
    geometry = swgpar.load_design(path).geometry
    recipe = load_recipe("plane_coarse" if geometry.model == "plane" else "forces")
    mesh = build_sector_meshes(geometry, recipe)["ring_gear"]
    bulge = above_cubics(mesh.profile, mesh.flanks[0].s)
    assert largest_distance(mesh.profile, mesh.flanks[0].s, bulge) < 1e-5
    assert largest_distance(mesh.profile, mesh.flanks[0].s, np.zeros_like(bulge)) > 3e-4


def test_heights_of_s_shaped_flanks_are_exact() -> None:
    """To a hundredth of a micrometre on the fewest elements; five samples are 0.05 of one off."""
    design = swgpar.new(ratio=50, diameter=64.0, torque=10.0, model="plane")
    mesh = build_sector_meshes(design.geometry, load_recipe("plane_coarse"))["flexible_spline"]
    profile, s, places = mesh.profile, mesh.flanks[0].s, np.linspace(0.0, 1.0, 101)

    def heights(element: int, t: np.ndarray) -> np.ndarray:
        """Of the exact flank over the element between two nodes, mm."""
        along = s[element] + (s[element + 1] - s[element]) * t
        chord = profile.point(s[element : element + 2])
        facet = (1.0 - t)[:, None] * chord[0] + t[:, None] * chord[1]
        return np.sum((profile.point(along) - facet) * profile.normal(along), axis=1)

    for element in range(len(s) - 1):
        interpolated = lagrange(places) @ heights(element, SAMPLES)
        assert np.abs(interpolated - heights(element, places)).max() < 1e-5


def test_heights_of_neighbours_meet_at_their_node() -> None:
    """A step of 0.7 nm at a node between a tip arc and a long element once made a pressure of
    757 MPa where 233 are true."""
    design = swgpar.new(ratio=50, diameter=64.0, torque=10.0, model="plane")
    mesh = build_sector_meshes(design.geometry, load_recipe("plane_coarse"))["flexible_spline"]
    grid = mesh.flanks[0]
    faces = flank_faces(mesh, grid, FlankCrowning())
    at_ends = lagrange(np.array([0.0, 1.0])) @ faces.offset
    assert np.abs(at_ends).max() < 1e-12
    assert np.abs(faces.offset).max() > 1e-3
