"""Coupling of the lines of a flank: none for loads that the elements see, symmetric, half spaces
for the rest."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest
from scipy.integrate import quad

from support.crowned_block import pressed_crown
from swgpar.contact.cells import Stations
from swgpar.contact.contact_lines import FlankCompliance
from swgpar.contact.layer_half_space import among_lines
from swgpar.contact.line_coupling import LineCoupling
from swgpar.flank_pressure.indentation import indentation

NODES = np.array([-3.0, -2.0, -0.8, 0.4, 1.5, 3.0])


def lines() -> tuple[np.ndarray, np.ndarray]:
    """Places and shares (mm) of two lines on each layer."""
    stations, thickness = Stations.of(2, False), np.diff(NODES)[:, None]
    z = NODES[:-1, None] + thickness * stations.place
    return z.ravel(), (thickness * stations.share).ravel()


def coupling() -> LineCoupling:
    """Of the crowned block's flank, with other layers."""
    missing = pressed_crown(6, 0.0).blocks.flanks.law.missing[0]
    return LineCoupling(missing, NODES, *lines())


def test_loads_that_are_linear_over_the_layers_do_not_couple() -> None:
    table, (z, length) = coupling().table, lines()
    rng = np.random.default_rng(3)
    load = np.sqrt(length) * np.interp(z, NODES, rng.uniform(0.0, 1.0, len(NODES)))
    left = np.einsum("lmab,m->lab", table, load)
    assert np.abs(left).max() < 1e-12 * np.abs(table).max()
    assert np.allclose(table, table.transpose(1, 0, 3, 2), rtol=0.0, atol=1e-12 * table.max())


def test_mean_of_the_half_space_over_shares_of_lines() -> None:
    """Against quadrature, at a distance along the profile."""
    (z, length), s = lines(), 0.3
    found = among_lines(np.array(s), z, length)
    ends = z[0] - 0.5 * length[0] + np.append(0.0, np.cumsum(length))

    def line(at: float, k: int) -> float:
        return float(np.diff(np.arcsinh((ends[k : k + 2] - at) / s))[0])

    for one, other in ((0, 0), (1, 0), (2, 7)):
        exact = quad(line, ends[one], ends[one + 1], args=(other,))[0]
        exact /= np.sqrt(length[one] * length[other])
        exact += 2.0 * np.log(s) * (one == other)
        assert found[one, other] == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("first", [0.03, 0.4])
def test_compliance_of_cells_is_symmetric_and_positive(first: float) -> None:
    """On neighbouring lines, wherever the cells lie on the profile and whatever their width."""
    both = coupling()
    missing = pressed_crown(6, 0.0).blocks.flanks.law.missing[0]
    middle = 0.5 * (missing.s[0] + missing.s[-1]) + first
    edges = middle + np.linspace(0.0, 0.09, 13)
    edges = np.unique(
        np.concatenate([edges, missing.s[np.abs(missing.s - middle - 0.045) < 0.045]])
    )
    number, n = np.arange(2, 6), len(edges) - 1
    line = np.repeat(number, n)
    out = np.zeros((len(line), len(line)))
    compliance = FlankCompliance(missing, both)
    compliance.add(line, np.tile(edges[:-1], 4), np.tile(edges[1:], 4), out)
    values = np.linalg.eigvalsh(out)
    assert np.abs(out - out.T).max() < 1e-12 * np.abs(out).max()
    assert values[0] > 1e-3 * values[-1]


def test_a_uniform_load_indents_as_in_the_section() -> None:
    """Far from the ends of a wide face every station yields alike, and the differences along the
    profile are those of the Green's function of the section."""
    n, z = 3, np.linspace(-60.0, 60.0, 81)
    s = np.array([0.0, 0.2, 0.4])
    green = np.array([[5.0, 3.0, 2.0], [3.0, 5.0, 3.0], [2.0, 3.0, 5.0]])

    class Missing:
        def __init__(self) -> None:
            self.s, self.green, self.logarithm = s, green, 1e-3

    force = np.zeros((n, len(z)))
    force[0] = 0.5 * (np.append(np.diff(z), 0.0) + np.append(0.0, np.diff(z)))
    found = indentation(cast(Any, Missing()), z, force)
    middle = slice(35, 46)
    assert np.ptp(found[:, middle], axis=1).max() < 1e-3
    apart = found[:, 40] - found[0, 40]
    assert apart == pytest.approx(green[:, 0] - green[0, 0], abs=1e-4)
