"""The cascade gearbox against the source's tables, closed forms and independent formulations."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from support.paths import DRIVERS
from swgpar import load_design
from swgpar.gear_trains.cascade.design import CascadeDesign
from swgpar.gear_trains.cascade.dynamics import Gearbox, natural_frequencies, no_errors
from swgpar.gear_trains.cascade.flex_unit import FlexUnits
from swgpar.gear_trains.cascade.layout import (
    DOFS,
    FLYWHEEL,
    RACK,
    masses,
    meshes,
    rigid_displacements,
    shafts,
)
from swgpar.gear_trains.cascade.load_cycle import LoadCycle, braked_load_shares, one_load_cycle
from swgpar.gear_trains.cascade.population import (
    block_shares,
    random_errors,
    static_shares,
    steady_velocities,
)
from swgpar.gear_trains.cascade.run import RANKED_TOLERANCES
from swgpar.gear_trains.cascade.static_sharing import (
    MESH_COUNTS,
    first_share_crossing,
    path_gap_angles,
    static_sharing,
)
from swgpar.gear_trains.cascade.tolerance_stack_up import contributions, sample_stack_up

DRIVER = DRIVERS / "cascade.toml"


@pytest.fixture(scope="module")
def design() -> CascadeDesign:
    return load_design(DRIVER)


@pytest.fixture(scope="module")
def period(design: CascadeDesign) -> LoadCycle:
    return one_load_cycle(design)


def difference(computed: np.ndarray, published: list[float]) -> np.ndarray:
    return computed / np.array(published) - 1.0


# --- at rest


@pytest.mark.parametrize("quantity", ["B_120", "B_207", "B_247", "A_23", "B_23"])
def test_static_shares(design: CascadeDesign, quantity: str) -> None:
    """Tables 7 and 10. Published shares add up to 0.9971 at all loads, these to one: 0.3 % of the
    difference."""
    direction, force = quantity.split("_")
    shares = static_sharing(design, direction).shares(1e3 * float(force))
    assert shares.sum() == pytest.approx(1.0, abs=1e-12)
    off = difference(shares, design.published[f"static_{quantity}"])
    if (
        quantity == "B_23"
    ):  # pinion 1 of Table 10 contradicts its ratio in Table 3 against pinions 3, 5 and 7
        assert off[0] == pytest.approx(0.021, abs=0.002)
        off = off[1:]
    assert np.abs(off).max() < 0.005


@pytest.mark.parametrize("force", [120, 207, 247])
def test_static_shares_with_equal_units(design: CascadeDesign, force: int) -> None:
    shares = static_sharing(design, "B", equal_units=True).shares(1e3 * force)
    assert np.ptp(shares[::2]) < 1e-12 and np.ptp(shares[1::2]) < 1e-12
    assert np.abs(difference(shares[:2], design.published[f"static_equal_B_{force}"])).max() < 0.005
    level = static_sharing(design, "A", equal_units=True).shares(1e3 * force)
    assert level == pytest.approx(np.full(8, 0.125), abs=1e-12)


def test_static_crossing(design: CascadeDesign) -> None:
    """Printed 152 kN; interpolating Table 7 in 1 / F gives 146.8 kN."""
    computed = 1e-3 * first_share_crossing(static_sharing(design, "B"), 247e3)
    assert computed == pytest.approx(design.published["first_crossing_static"], rel=0.05)
    low, high = (np.array(design.published[f"static_B_{force}"]) for force in (120, 207))
    a, b = low[3] - low[4], high[3] - high[4]
    assert computed == pytest.approx(1.0 / (1 / 120 + a / (a - b) * (1 / 207 - 1 / 120)), rel=0.005)


def stiff(design: CascadeDesign, factor: float) -> CascadeDesign:
    """All gears and shafts stiffer, without tooth cycles; the flexible units as they are."""
    change: dict[str, object] = {
        kind: getattr(design, kind).model_copy(
            update={"stiffness": factor * getattr(design, kind).stiffness, "variation": 0.0}
        )
        for kind in MESH_COUNTS
    }
    harder = {name: factor * value for name, value in design.shafts.model_dump().items()}
    return design.model_copy(update={**change, "shafts": design.shafts.model_copy(update=harder)})


def equilibrium(design: CascadeDesign, errors: np.ndarray, force: float) -> np.ndarray:
    """Pinion forces where the elastic gearbox rests against its brake, by Newton's method from the
    rigid state."""
    gearbox, at_rest, free = (
        Gearbox(design, braked=True),
        np.zeros(DOFS),
        np.delete(np.arange(DOFS), FLYWHEEL),
    )
    ways = rigid_displacements(design)
    x = (ways - ways[FLYWHEEL] * (np.arange(DOFS) == FLYWHEEL)) * 2e-3 * np.linspace(1.0, 0.0, DOFS)
    for _ in range(200):
        residual = gearbox.kernel.forces(errors, x, at_rest)
        residual[RACK] -= force
        stiffness = gearbox.kernel.matrices(errors, x, at_rest)[0] + 1e-3 * np.eye(
            DOFS
        )  # gears between gaps float
        step = np.linalg.solve(stiffness[np.ix_(free, free)], residual[free])
        x[free] -= step * min(1.0, 1e-4 / np.abs(step).max())
        if np.abs(residual[free]).max() < 1e-6 * force and np.abs(step).max() < 1e-12:
            return gearbox.pinion_forces(x[None], at_rest[None])[0]
    raise AssertionError("no equilibrium")


@pytest.mark.parametrize("block", [None, 3, 4])
def test_rigid_gears_are_the_limit_of_stiff_ones(design: CascadeDesign, block: int | None) -> None:
    """The paths' gaps against the equilibrium of the 23 gears with all contacts, with and without
    random errors."""
    errors = no_errors()
    if block is not None:
        errors["amplitude"] = random_errors(design, block, 1)["amplitude"][0]
        errors["phase"] = 0.5 * np.pi  # sin = 1 where the driven gears stand
    by_kind = dict(
        zip(
            MESH_COUNTS,
            np.split(errors["amplitude"], np.cumsum(list(MESH_COUNTS.values()))[:-1]),
            strict=True,
        )
    )
    rigid = static_sharing(design, "B", errors=by_kind).shares(120e3)
    off = []
    for factor in (100.0, 1000.0):
        carried = equilibrium(stiff(design, factor), errors, 120e3)
        assert carried.sum() == pytest.approx(120e3, rel=1e-5)
        off.append(np.abs(carried / carried.sum() - rigid).max())
    assert off[1] < 2e-5
    if (
        block is None
    ):  # with errors a floor is left: the driven gears turn a little on the way into contact
        assert off[0] / off[1] == pytest.approx(10.0, rel=0.1)


def test_a_pinion_carries_when_its_own_path_is_closed(design: CascadeDesign) -> None:
    sharing = static_sharing(design, "B")
    gap = path_gap_angles(design, "B")
    assert gap[1] - gap[0] == pytest.approx(1e-3 * design.g1_g1.gap_B / design.radius("g1"))
    below = sharing.forces(np.array(gap[1] * design.radius("pinion") * 0.999))
    assert (below[::2] > 0.0).all() and (below[1::2] == 0.0).all()
    assert np.ptp(path_gap_angles(design, "A")) < 1e-15


def test_flex_unit(design: CascadeDesign) -> None:
    units = FlexUnits.of(design)
    twist, h = np.linspace(-2.0, 2.0, 41) * units.end, 1e-7
    slope = (units.torque(twist + h) - units.torque(twist - h)) / (2.0 * h)
    np.testing.assert_allclose(slope, units.tangent(twist), rtol=1e-6)
    assert units.tangent(np.array([units.end, 3.0 * units.end])) == pytest.approx(
        575.0 * 180.0 / np.pi
    )
    gearbox = Gearbox(design)
    x = np.zeros((1, DOFS))
    x[0, 1:9] = 0.7 * units.end * design.radius("pinion")
    expected = units.ratios * units.torque(0.7 * units.end) / design.radius("pinion")
    np.testing.assert_allclose(
        gearbox.pinion_forces(x, np.zeros((1, DOFS)))[0], expected, rtol=1e-13
    )


# --- tolerances


def test_spearman_ranks(design: CascadeDesign) -> None:
    """Table 2, and the closed form of Spearman's rank between a normal variable and a sum that
    holds it."""
    _, ranks = sample_stack_up(design, "rack_pinion")
    published = design.published["spearman_rack_pinion"]
    assert (
        np.abs(
            [ranks[name] - there for name, there in zip(RANKED_TOLERANCES, published, strict=True)]
        ).max()
        < 0.05
    )
    for kind in MESH_COUNTS:
        limits = contributions(design, kind)
        samples, ranks = sample_stack_up(design, kind)
        total = np.sqrt(sum(limit**2 for limit in limits.values()))
        noise = 4.0 / np.sqrt(design.tolerances.samples)
        assert samples.std() == pytest.approx(total / design.tolerances.limit, rel=noise)
        for name, limit in limits.items():
            assert ranks[name] == pytest.approx(
                6.0 / np.pi * np.arcsin(0.5 * limit / total), abs=noise
            )


# --- in motion


def reference_forces(
    design: CascadeDesign, errors: np.ndarray, x: np.ndarray, v: np.ndarray
) -> np.ndarray:
    """The forces of all gears, written down with vectors instead of loops."""
    out = np.zeros(DOFS)
    m = meshes(design)
    angle = x[m["driven"]] / m["driven_radius"] + errors["phase"]
    p = x[m["driver"]] - x[m["driven"]] - errors["amplitude"] * np.sin(angle)
    rate = (
        v[m["driver"]]
        - v[m["driven"]]
        - errors["amplitude"] * np.cos(angle) * v[m["driven"]] / m["driven_radius"]
    )
    g = np.maximum(p - m["gap_B"], 0.0) + np.minimum(p + m["gap_A"], 0.0)
    k = m["stiffness"] * (
        1.0 + m["variation"] * np.sin(2.0 * x[m["driven"]] / m["module"] + errors["tooth_phase"])
    )
    s = np.clip(np.abs(g) / (1e-6 * design.damping.contact_ramp), 0.0, 1.0)
    f = k * g + m["damping"] * (3.0 * s**2 - 2.0 * s**3) * rate
    np.add.at(out, m["driver"], f)
    np.add.at(out, m["driven"], -f)
    s = shafts(design)
    twist = x[s["first"]] / s["first_radius"] - x[s["second"]] / s["second_radius"]
    units = FlexUnits.of(design)
    torque = np.concatenate(
        [units.ratios * units.torque(twist[:8]), s["stiffness"][8:] * twist[8:]]
    )
    torque += s["damping"] * (
        v[s["first"]] / s["first_radius"] - v[s["second"]] / s["second_radius"]
    )
    np.add.at(out, s["first"], torque / s["first_radius"])
    np.add.at(out, s["second"], -torque / s["second_radius"])
    out[FLYWHEEL] += design.flywheel.generator / design.radius("g4") ** 2 * v[FLYWHEEL]
    return out


def test_kernel(design: CascadeDesign) -> None:
    """Forces against the vectors above; matrices are symmetric, and the forces' derivatives where
    nothing cycles."""
    random = np.random.default_rng(2)
    errors = random_errors(design, 0, 1)[0]
    gearbox = Gearbox(design)
    for _ in range(20):
        x, v = 3e-4 * random.standard_normal(DOFS), 0.1 * random.standard_normal(DOFS)
        force = gearbox.kernel.forces(errors, x, v)
        np.testing.assert_allclose(
            force, reference_forces(design, errors, x, v), atol=1e-10 * np.abs(force).max()
        )
    smooth = Gearbox(stiff(design, 1.0))
    x, v, h = 3e-4 * random.standard_normal(DOFS), np.zeros(DOFS), 1e-9
    for matrix, in_ways in zip(
        smooth.kernel.matrices(no_errors(), x, v), (True, False), strict=True
    ):
        numeric = np.empty((DOFS, DOFS))
        for j in range(DOFS):
            e = h * (np.arange(DOFS) == j)
            ends = [(x + s * e, v) if in_ways else (x, v + s * e) for s in (1.0, -1.0)]
            plus, minus = (smooth.kernel.forces(no_errors(), *end) for end in ends)
            numeric[:, j] = (plus - minus) / (2.0 * h)
        assert np.abs(matrix - matrix.T).max() == 0.0
        np.testing.assert_allclose(matrix, numeric, atol=1e-5 * np.abs(matrix).max())


def test_natural_frequencies(design: CascadeDesign) -> None:
    """Against the kernel's matrix; 19 of 23 are different with equal units (Table 9 lists 11), the
    first is zero."""
    frequencies = natural_frequencies(design)
    gearbox = Gearbox(stiff(design, 1.0))
    ways = (
        5e-3
        * np.linspace(2.0, 1.0, DOFS)
        * rigid_displacements(design)
        * np.r_[np.ones(9), 0.1 * np.ones(14)]
    )
    stiffness, _ = gearbox.kernel.matrices(no_errors(), ways, np.zeros(DOFS))
    root = np.sqrt(masses(design))
    squares = np.linalg.eigvalsh(stiffness / root / root[:, None])
    np.testing.assert_allclose(
        np.sqrt(np.maximum(squares, 0.0))[1:] / (2.0 * np.pi), frequencies[1:], rtol=1e-8
    )
    assert frequencies[0] < 1e-3 * frequencies[1]
    units = design.flex_unit.model_copy(update={"ratio": [1.0] * 8})
    equal = natural_frequencies(design.model_copy(update={"flex_unit": units}))
    assert 1 + (np.diff(equal) > 1e-9 * equal[1:]).sum() == 19


def test_implicit_steps_are_of_second_order(design: CascadeDesign) -> None:
    """Against SciPy's integrator, from a state in contact under a growing force: shares in smooth
    motion."""
    calm = stiff(design, 1.0)
    gearbox = Gearbox(calm)

    def force(t: np.ndarray) -> np.ndarray:
        return 100e3 + 50e3 * np.sin(20.0 * np.asarray(t))

    closed = {
        kind: getattr(calm, kind).model_copy(update={"gap_A": 0.0, "gap_B": 0.0})
        for kind in MESH_COUNTS
    }
    gearbox = Gearbox(calm.model_copy(update=closed))
    start, end = steady_velocities(calm), 0.02
    x, v = gearbox.integrate(force, start, np.array([0.0, end]), rtol=1e-10)
    off = []
    for count in (200, 400, 800):
        _, x_end, _ = gearbox.simulate(force, start, end / count, count)
        off.append(np.abs(x_end - x[-1]).max())
    assert off[-1] < 1e-7
    for coarse, fine in itertools.pairwise(off):
        assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.3)


def test_dynamic_shares(design: CascadeDesign, period: LoadCycle) -> None:
    """Table 8: means of odd and even pinions within 3 %; the crossing within 5 % of 160 kN."""
    for force in (120, 207, 247):
        shares = period.shares_at(1e3 * force)
        means = np.array([shares[::2].mean(), shares[1::2].mean()])
        assert np.abs(difference(means, design.published[f"dynamic_mean_B_{force}"])).max() < 0.01
        assert np.abs(difference(shares, design.published[f"dynamic_B_{force}"])).max() < 0.03
    assert 1e-3 * period.first_crossing() == pytest.approx(
        design.published["first_crossing_dynamic"], rel=0.05
    )
    in_a = period.shares[(period.rack_force < -0.9 * period.rack_force.max())]
    assert np.abs(in_a.mean(axis=0) / static_sharing(design, "A").shares(247e3) - 1.0).max() < 0.01


@pytest.mark.parametrize("direction", ["B", "A"])
def test_braked_shares(design: CascadeDesign, direction: str) -> None:
    """The dynamic column of Table 10; small shares within 1.5 % as mesh stiffnesses are not
    given."""
    off = difference(braked_load_shares(design, direction), design.published[f"braked_{direction}"])
    assert np.abs(off).max() < 0.015


def test_population(design: CascadeDesign) -> None:
    """None overloaded; errors spread the shares, more at rest (a constant error) than as means over
    a turn."""
    shares = block_shares(design, 0, 25)
    assert max(shares.static.max(), shares.largest.max()) < 0.15
    assert (shares.static.std(axis=0) > shares.mean.std(axis=0)).all()
    many = static_shares(design, random_errors(design, 1, 100_000))
    assert many.max() < 0.15
    noise = many.std(axis=0) / np.sqrt(len(many))
    assert (
        np.abs((many.mean(axis=0) - static_sharing(design, "B").shares(247e3)) / noise).max() < 4.0
    )
