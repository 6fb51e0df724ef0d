"""The elastic ring: curved beams against closed forms, a solid toothed ring, and moving loads
against other schemes."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import block_diag, bmat, coo_matrix
from scipy.sparse.linalg import eigsh

from support.element_mesh import ElementMesh
from support.paths import DRIVERS
from swgpar import load_design
from swgpar.gear_trains.ring.design import RingDesign
from swgpar.gear_trains.ring.moving_load import MovingLoads, middle_node
from swgpar.gear_trains.ring.run import distinct_frequencies
from swgpar.meshing import build_sector_meshes, load_recipe
from swgpar.vibration.curved_beam import BeamSection, Ring, free_frequencies
from swgpar.vibration.dominant_cycles import dominant_cycles
from swgpar.vibration.gear_mesh_system import GearMeshSystem
from swgpar.vibration.modal_stepping import ModalStepper
from swgpar.vibration.sampling import random_stream

MOVING, MODES = DRIVERS / "ring_moving_load.toml", DRIVERS / "ring_modes.toml"
SUPPORTED = DRIVERS / "ring_supported.toml"


@pytest.fixture(scope="module")
def bolted() -> RingDesign:
    return load_design(MOVING)


def changed(design: RingDesign, section: str, **values: object) -> RingDesign:
    return design.model_copy(update={section: getattr(design, section).model_copy(update=values)})


def free(design: RingDesign, elements: int) -> RingDesign:
    return changed(design, "ring", elements=elements).model_copy(
        update={"supports": None, "moving_load": None, "teeth": None}
    )


# --- modes


def test_free_ring(bolted: RingDesign) -> None:
    """Bending modes to 0.1 % of the closed form with 36 elements; three rigid motions.

    The order in the size of elements is four; two where shear within elements prevails.
    """
    section = bolted.beam_section()
    without_shear = replace(section, shear=1e6 * section.shear)
    for used, orders in ((section, (2.0, 4.1)), (without_shear, (3.7, 4.1))):
        exact = np.array([free_frequencies(used, n)[0] for n in range(2, 6)])
        pairs, sizes = [3, 5, 7, 9], (18, 36, 72)
        errors = [Ring(used, size).modes()[0][pairs] / exact - 1.0 for size in sizes]
        assert (errors[1] > 0.0).all() and errors[1].max() < 1e-3
        for coarse, fine in itertools.pairwise(errors):
            # the error of the first mode is near that of the eigenvalue solver
            order = np.log2(coarse / fine)[1:]
            assert (order > orders[0]).all() and (order < orders[1]).all(), order
    frequencies, _ = free(bolted, 36).elastic_ring().modes()
    assert (frequencies[:3] < 1e-3 * frequencies[3]).all()


def test_free_ring_is_the_thin_ring() -> None:
    """Bending of a thin ring: n (n² - 1) / sqrt(n² + 1) times sqrt(E I / (density A R⁴)) (Hoppe);
    stretching: sqrt(n² + 1) times sqrt(E / (density R²))."""
    thin = BeamSection(1.0, 1.0, 1.0, 1.0, 1e-8, 1e-8, shear=1.0, coupling=0.0)
    for n in (2, 3, 4):
        hoppe = np.sqrt(thin.inertia) * n * (n * n - 1.0) / np.sqrt(n * n + 1.0)
        found = free_frequencies(thin, n)
        assert found[:2] == pytest.approx([hoppe, np.sqrt(n * n + 1.0)], rel=1e-6)


@pytest.mark.parametrize("inner", [515.0, 300.0])
def test_load_within_an_element(bolted: RingDesign, inner: float) -> None:
    """Interpolation and flexibility between the nodes: the displacement under a load at any place
    is the same with 6, 18 and 66 elements."""
    design = changed(bolted, "ring", inner_radius=inner)
    for place in (0.0, 0.1, 0.35, 1.0, 3.3):
        found = []
        for elements in (6, 18, 66):
            ring = changed(design, "ring", elements=elements).elastic_ring()
            rows = ring.interpolation(place)
            nodal = rows @ np.linalg.solve(ring.stiffness, rows.T)
            found.append(nodal + ring.flexibility_within(np.array([place]))[0])
        for coarse in found[:2]:
            assert coarse == pytest.approx(found[2], rel=1e-6, abs=1e-9 * np.abs(found[2]).max())


def test_inertia_of_a_turning_ring(bolted: RingDesign) -> None:
    """Polar moment of inertia of a thick ring, pi/2 density width (Ro⁴ - Ri⁴)."""
    design = free(changed(bolted, "ring", inner_radius=300.0), 12)
    ring, body = design.elastic_ring(), design.ring
    turn = np.tile([0.0, ring.section.radius, 1.0], 12)
    powers = (1e-3 * body.outer_radius) ** 4 - (1e-3 * body.inner_radius) ** 4
    exact = 0.5e-3 * np.pi * body.density * body.face_width * powers
    assert turn @ ring.mass @ turn == pytest.approx(exact, rel=1e-9)


def test_shape_functions_are_exact_at_rest(bolted: RingDesign) -> None:
    """Two opposite forces on a free ring: the same with 4 elements as with 64, and 0.14878 F R³ /
    (E I) when thin."""
    found = []
    for elements in (4, 16, 64):
        ring = changed(free(bolted, elements), "ring", inner_radius=519.0).elastic_ring()
        load = ring.interpolation(0.0)[0] + ring.interpolation(np.pi)[0]
        u = np.linalg.lstsq(ring.stiffness, load, rcond=1e-12)[0]
        s = ring.section
        found.append(
            (ring.interpolation(0.0)[0] + ring.interpolation(np.pi)[0])
            @ u
            * s.E
            * s.inertia
            / s.radius**3
        )
    assert found == pytest.approx([found[0]] * 3, rel=1e-5)
    assert found[0] == pytest.approx(np.pi / 4.0 - 2.0 / np.pi, rel=1e-4)


def test_rigid_motions_cost_nothing(bolted: RingDesign) -> None:
    ring = free(bolted, 12).elastic_ring()
    assert np.abs(ring.stiffness - ring.stiffness.T).max() < 1e-9 * np.abs(ring.stiffness).max()
    angle = 2.0 * np.pi * np.arange(12) / 12
    along_x = np.stack([np.cos(angle), -np.sin(angle), 0.0 * angle], axis=1).ravel()
    turning = np.tile([0.0, 1.0, 1.0 / ring.section.radius], 12)
    for motion in (along_x, turning):
        assert np.abs(ring.stiffness @ motion).max() < 1e-8 * np.abs(ring.stiffness).max()
    mass = 2.0 * np.pi * ring.section.radius * ring.section.density * ring.section.area
    assert along_x @ ring.mass @ along_x == pytest.approx(mass, rel=1e-12)
    between = ring.interpolation(0.3)
    assert between[:2] @ along_x == pytest.approx([np.cos(0.3), -np.sin(0.3)], abs=1e-9)


def test_supported_ring() -> None:
    """Table 5.2 within 1 %, on supports deduced from it; the mode of three waves is single, the
    others are pairs."""
    design = load_design(SUPPORTED)
    section, ring = design.beam_section(), design.elastic_ring()
    unit = np.sqrt(
        section.density * section.area * section.radius**4 / (section.E * section.inertia)
    )
    found, _ = distinct_frequencies(design, 3)
    assert 2.0 * np.pi * found * unit == pytest.approx(
        design.published["dimensionless_frequencies"], rel=0.01
    )
    rate, _ = ring.modes()
    assert [(np.abs(rate / (2.0 * np.pi * f) - 1.0) < 1e-6).sum() for f in found] == [2, 1, 2]
    # the whole ring turns freely, but for round-off of the stiff springs; softer ones change
    # nothing
    assert rate[0] < 0.01 * rate[1]
    softer, _ = distinct_frequencies(changed(design, "supports", radial=1e9), 3)
    assert softer == pytest.approx(found, rel=1e-5)


def test_supported_ring_of_the_source() -> None:
    """The source's own column of Table 5.2 within 0.15 %: I / (A R²) = 0.002 and springs of 1e4 E I
    / R³, deduced."""
    section = BeamSection(1.0, 1.0, 1.0, 1.0, 2e-3, 2e-3, shear=1e9, coupling=0.0)
    ring = Ring(section, 60, (3, (1e4 * section.inertia, 0.0, 0.0)))
    rate = ring.modes()[0][[1, 3, 4]] / np.sqrt(section.inertia)
    assert rate == pytest.approx([1.640, 7.529, 10.205], rel=1.5e-3)


def toothed_ring(design: RingDesign, recipe: str) -> np.ndarray:
    """Bending frequencies in Hz of the toothed ring in plane stress, by this program's own mesh and
    elements.

    Pitch radius 176 mm: module 5.5 mm, the addendum one module, involute teeth of 20 degrees.
    """
    body = design.ring
    drive = load_design(
        DRIVERS / "plane_half_turn.toml",
        [
            "drive.module=5.5",
            "drive.teeth_rg=64",
            "drive.teeth_fs=60",
            "drive.addendum_coef=1.0",
            f"drive.dedendum_coef={(body.inner_radius - 176.0) / 5.5}",
            f"drive.face_width={body.face_width}",
            f"wave_generator.face_width={body.face_width}",
            "flexible_spline.rim=10.0",
            f"ring_gear.rim={body.outer_radius - body.inner_radius}",
            'flexible_spline.profile={ type = "involute", cutter_radius = 1.0 }',
            'ring_gear.profile={ type = "involute", cutter_radius = 1.0, cutter_teeth = 40 }',
            f"material.E={1e3 * body.E}",
            "material.nu=0.3",
            "load.torque=0",
        ],
    )
    sector = build_sector_meshes(drive.geometry, load_recipe(recipe))["ring_gear"]
    flat = np.flatnonzero(sector.lower_nodes == np.arange(len(sector.coords)))
    count, number = sector.n_sectors, np.full(len(sector.coords), -1)
    # nodes on the clockwise side belong to the sector before: that one's counter-clockwise side is
    # the same line
    shared = dict(zip(sector.cw_nodes.tolist(), sector.ccw_nodes.tolist(), strict=True))
    own = [n for n in flat.tolist() if n not in shared]
    number[own] = np.arange(len(own))
    points, quads = [], []
    for k in range(count):
        a = 2.0 * np.pi * k / count
        turn = np.array(
            [[np.cos(a), -np.sin(a), 0.0], [np.sin(a), np.cos(a), 0.0], [0.0, 0.0, 1.0]]
        )
        points.append(sector.coords[own] @ turn.T)
        before = (k - 1) % count
        place = number + k * len(own)
        for low, high in shared.items():
            place[low] = number[high] + before * len(own)
        quads.append(place[sector.elements])
    mesh = ElementMesh(
        np.concatenate(points), np.concatenate(quads), drive.material, body.face_width
    )
    stiffness = mesh.tangent(np.zeros_like(mesh.points))
    corner = mesh.points[mesh.elements][:, :, :2]
    mass = np.zeros((len(corner), 4, 4))
    for x, y in itertools.product((-(3.0**-0.5), 3.0**-0.5), repeat=2):
        shape = 0.25 * np.array(
            [(1 - x) * (1 - y), (1 + x) * (1 - y), (1 + x) * (1 + y), (1 - x) * (1 + y)]
        )
        slope = 0.25 * np.array([[y - 1, 1 - y, 1 + y, -1 - y], [x - 1, -1 - x, 1 + x, 1 - x]])
        area = np.abs(np.linalg.det(slope @ corner))
        mass += area[:, None, None] * np.outer(shape, shape)
    i, j = np.repeat(mesh.elements, 4, axis=1).ravel(), np.tile(mesh.elements, (1, 4)).ravel()
    scalar = coo_matrix((mass.ravel(), (i, j)), shape=2 * (len(mesh.points),)).tocsr()
    scalar *= 1e-12 * body.density * body.face_width
    axes = [stiffness[a::3][:, b::3] for a in (0, 1) for b in (0, 1)]
    k2, m2 = bmat([axes[:2], axes[2:]]).tocsc(), block_diag([scalar, scalar]).tocsc()
    squares = eigsh(k2, k=14, M=m2, sigma=-1e4, return_eigenvectors=False)
    rate = np.sqrt(np.sort(squares).clip(0.0)) / (2.0 * np.pi)
    return rate[3::2]


def test_tooth_masses_against_a_solid_ring() -> None:
    """Tooth masses without the teeth's stiffness: 3 to 9 % too low; the smooth ring to the pitch
    circle: half as high.

    The printed frequencies of the solid ring are those of the printed radii times 1.98 to 1.99. Two
    meshes, the coarse one within 0.6 % of the fine one. `pytest -s` prints the table of
    docs/verification/gear_trains.md.
    """
    design = load_design(MODES)
    coarse, solid = (toothed_ring(design, f"plane{level}")[:5] for level in ("_coarse", ""))
    with_masses, _ = distinct_frequencies(design, 5)
    smooth, _ = distinct_frequencies(
        changed(design, "ring", inner_radius=176.0).model_copy(update={"teeth": None}), 5
    )
    printed = np.array([590.0, 1650.0, 3129.0, 4977.0, 7166.0])
    rows = {
        "smooth": smooth,
        "masses": with_masses,
        "coarse": coarse,
        "solid": solid,
        "printed/solid": printed / solid,
    }
    for name, row in rows.items():
        print(f"{name:14s}", *(f"{value:9.3f}" for value in row))
    assert (coarse > solid).all() and (coarse / solid < 1.006).all()
    assert (with_masses / solid > 0.91).all() and (with_masses / solid < 0.97).all()
    assert (smooth / solid > 1.45).all()
    assert printed / solid == pytest.approx(np.full(5, 1.986), rel=0.005)


# --- moving loads


def small(bolted: RingDesign, **load: object) -> RingDesign:
    """A ring of 12 elements."""
    return changed(
        changed(bolted, "ring", elements=12), "moving_load", **{"revolutions": 1, **load}
    )


def test_moving_load_against_newmark(bolted: RingDesign) -> None:
    """Mean and covariance by the exact steps against the stochastic Newmark scheme with small ones,
    second order."""
    design = small(bolted, steps=36, damping_stiffness=1e-4)
    speed = 2000.0  # rad/s: the loads pass a support within a period of the ring
    loads, ring, load = MovingLoads(design), design.elastic_ring(), design.moving_load
    fine = MovingLoads(small(bolted, steps=3600, damping_stiffness=1e-4)).respond(speed)
    alpha = np.radians(load.pressure_angle)
    direction = np.array([np.sin(alpha), np.cos(alpha), 0.0])
    system = GearMeshSystem(
        mass=ring.mass,
        damping=load.damping_mass * ring.mass + load.damping_stiffness * ring.stiffness,
        stiffness=ring.stiffness,
        deflection_rows=lambda t: np.zeros((0, ring.size)),
        mesh_stiffness=lambda t: np.zeros(0),
        half_backlash=np.zeros(0),
        force=np.zeros(ring.size),
        noise=np.zeros((ring.size, load.loads)),
    )
    n, end, off = ring.size, 0.5 * np.pi / speed, []

    def places(t: float) -> np.ndarray:
        return np.array(
            [
                direction @ ring.interpolation(speed * t + 2.0 * np.pi * k / load.loads)
                for k in range(load.loads)
            ]
        )

    def force(t: float) -> np.ndarray:
        ahead = 2.0 * np.pi * np.arange(load.loads) / load.loads / speed
        return (load.force + load.harmonic * np.sin(load.frequency * (t + ahead))) @ places(t)

    for count in (200, 400, 800):
        h = end / count
        left, right = system.newmark(ring.stiffness, h)
        y, spread = (
            np.concatenate([np.linalg.solve(ring.stiffness, force(0.0)), np.zeros(n)]),
            np.zeros((2 * n, 2 * n)),
        )
        for step in range(1, count + 1):
            t = step * h
            noise = load.noise * places(t - 0.5 * h).T
            shaken = np.sqrt(h) * np.vstack(
                [np.hstack([noise, 0 * noise]), np.hstack([0 * noise, h / 12**0.5 * noise])]
            )
            push = np.concatenate([0.5 * h * (force(t - h) + force(t)), np.zeros(n)])
            moved = np.linalg.solve(left, np.hstack([right, shaken, (right @ y + push)[:, None]]))
            y = moved[:, -1]
            spread = (
                moved[:, : 2 * n] @ spread @ moved[:, : 2 * n].T
                + moved[:, 2 * n : -1] @ moved[:, 2 * n : -1].T
            )
        watched = np.array(
            [ring.interpolation(speed * end)[0], np.eye(ring.size)[3 * middle_node(design)]]
        )
        mean = watched @ y[:n]
        deviation = np.sqrt(np.einsum("pi,ij,pj->p", watched, spread[:n, :n], watched))
        row = 3600 // 4 - 1
        off.append(
            [
                np.abs(mean / fine.mean[row] - 1.0).max(),
                np.abs(deviation / fine.deviation[row] - 1.0).max(),
            ]
        )
    assert max(off[-1]) < 2e-3
    for k in (0, 1):
        assert np.log2(off[0][k] / off[1][k]) == pytest.approx(2.0, abs=0.35)
    assert loads.frequencies[0] > 0.0


def test_covariance_stays_positive(bolted: RingDesign) -> None:
    """Of displacements and velocities of all modes, each kind over its largest deviation, in every
    step of a turn."""
    loads, load = MovingLoads(small(bolted, steps=36)), bolted.moving_load
    squares, n = loads.frequencies**2, len(loads.frequencies)
    modes = ModalStepper(
        squares, load.damping_mass + load.damping_stiffness * squares, 2.0 * np.pi / 200.0 / 36
    )
    spread = np.zeros((2, 2, n, n))
    for step in range(36):
        spread = modes.spread(spread, loads.noises(step))
        size = np.sqrt([np.diag(spread[k, k]).max() for k in (0, 1)]).repeat(n)
        whole = spread.transpose(0, 2, 1, 3).reshape(2 * n, 2 * n) / size / size[:, None]
        assert np.abs(whole - whole.T).max() < 1e-12
        values = np.linalg.eigvalsh(whole)
        assert values[0] > -1e-11 * values[-1]


def test_steps_of_the_loads(bolted: RingDesign) -> None:
    """At least second order in the travel of the loads."""
    found = [MovingLoads(small(bolted, steps=steps)).respond(200.0) for steps in (180, 360, 720)]
    for kind in ("mean", "deviation"):
        coarse, middle, fine = (
            getattr(f, kind)[k - 1 :: k] for f, k in zip(found, (1, 2, 4), strict=True)
        )
        last = np.abs(fine - middle).max()
        assert last < 5e-3 * np.abs(fine).max()
        assert np.log2(np.abs(middle - coarse).max() / last) > 1.7


def test_simulations_of_the_ring(bolted: RingDesign) -> None:
    design = small(bolted, steps=180)
    loads, samples = MovingLoads(design), 400
    exact = loads.respond(200.0)
    sums = loads.simulate(200.0, samples, random_stream(4))
    assert (np.abs(sums.mean - exact.mean) < 5.0 * exact.deviation / np.sqrt(samples)).all()
    assert (np.abs(sums.deviation / exact.deviation - 1.0) < 5.0 / np.sqrt(2.0 * samples)).all()


def test_patterns_in_a_revolution(bolted: RingDesign) -> None:
    """Six cycles under the moving load (six supports), three at a node (three loads); slow: as at
    rest."""
    loads = MovingLoads(bolted)
    found = loads.respond(2.8)
    assert [dominant_cycles(column) for column in found.mean.T] == [6.0, 3.0]
    ring, load, still = bolted.elastic_ring(), bolted.moving_load, loads.quasi_static(2.8)
    h = 2.0 * np.pi / 2.8 / load.steps
    for step in (100, 333, 600):
        force = loads.forces(step, (step + load.steps) * h, 2.8)
        at_rest = loads.shapes @ (force / loads.frequencies**2)
        expected = [
            ring.interpolation(2.0 * np.pi * step / load.steps)[0] @ at_rest,
            at_rest[3 * middle_node(bolted)],
        ]
        assert still[step - 1] == pytest.approx(expected, abs=1e-9 * np.abs(still).max())
    assert np.abs(found.mean - still).max() < 0.03 * np.abs(still).max()


def test_published_speeds_are_slow(bolted: RingDesign) -> None:
    """22 to 50 rad/s: means as without inertia, at the published critical speeds as well."""
    loads = MovingLoads(changed(bolted, "moving_load", steps=180))
    for speed in (22.0, 31.3, 34.19, 36.6, 40.55, 44.0, 50.0):
        still = loads.quasi_static(speed)
        assert np.abs(loads.respond(speed).mean - still).max() < 0.05 * np.abs(still).max()


def test_critical_speeds(bolted: RingDesign) -> None:
    """Three loads excite with multiples of three times their speed: peaks where one of them is the
    lowest mode."""
    loads = MovingLoads(changed(bolted, "moving_load", steps=180))
    first = loads.frequencies[0]
    for multiple in (2, 3):
        critical = first / (3.0 * multiple)
        speeds = critical * np.array([0.88, 0.91, 0.94, 0.97, 1.0, 1.03, 1.06, 1.09, 1.12])
        largest = [np.abs(loads.respond(s).mean[:, 1]).max() for s in speeds]
        assert 0.94 <= speeds[int(np.argmax(largest))] / critical <= 1.06
        assert max(largest) > 1.3 * max(largest[0], largest[-1])


def test_cycles_of_a_revolution(bolted: RingDesign) -> None:
    """The harmonic part keeps its cycles at every speed: as with the frequency of each."""
    load = {"steps": 360, "revolutions": 1}
    with_cycles = MovingLoads(changed(bolted, "moving_load", frequency=0.0, cycles=36.0, **load))
    for speed in (2.8, 40.0):
        fixed = MovingLoads(changed(bolted, "moving_load", frequency=36.0 * speed, **load))
        for kind in ("mean", "deviation"):
            found, expected = (
                getattr(loads.respond(speed), kind) for loads in (with_cycles, fixed)
            )
            assert found == pytest.approx(expected, rel=1e-12)


def test_critical_speeds_of_36_cycles() -> None:
    """Supports that hold radially: three moving waves of 36 cycles excite the lowest mode, of three
    waves, at its frequency over 36 + 3 and 36 - 3: 31.2 and 36.9 rad/s, print has 31.3 and 36.6."""
    keys = ["moving_load.frequency=0.0", "moving_load.cycles=36", "moving_load.revolutions=1"]
    # springs that hold the ring against the loads, softer than any bending
    held = ["supports.tangential=1e6", "supports.torsional=0"]
    loads = MovingLoads(load_design(MOVING, [*keys, *held]))
    lowest = loads.frequencies[1]
    outward = np.abs(np.fft.rfft(loads.shapes[::3, 1]))
    assert np.argmax(outward) == 3
    for cycles, published in ((39.0, 31.3), (33.0, 36.6)):
        expected = lowest / cycles
        speeds = expected * np.array([0.94, 0.96, 0.98, 1.0, 1.02, 1.04, 1.06])
        largest = [np.abs(loads.respond(speed).mean[:, 1]).max() for speed in speeds]
        assert 0.98 <= speeds[int(np.argmax(largest))] / expected <= 1.02
        assert expected == pytest.approx(published, rel=0.015)


def test_deviation_falls_slightly_with_the_speed(bolted: RingDesign) -> None:
    loads = MovingLoads(bolted)
    largest = [loads.respond(speed).deviation[:, 1].max() for speed in (22.0, 50.0)]
    assert 0.9 * largest[0] < largest[1] < largest[0]
