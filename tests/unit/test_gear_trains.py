"""Design files of gear trains, published values in them, samples that do not depend on the
ranks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from support.paths import DRIVERS, REFERENCE
from swgpar import load_design
from swgpar.errors import ConvergenceError, InputError
from swgpar.gear_trains.published import check_published, compare
from swgpar.gear_trains.train import make_train, model_of
from swgpar.input.toml_file import read_toml
from swgpar.results.quantity import Quantity
from swgpar.results.table import format_columns, read_columns
from swgpar.systems import system_of_section, system_of_table
from swgpar.vibration.curved_beam import free_frequencies
from swgpar.vibration.sampling import block_sizes, random_stream, run_tasks

CASCADE, GEAR_PAIR = DRIVERS / "cascade.toml", DRIVERS / "gear_pair.toml"
RING, RING_MODES = DRIVERS / "ring_moving_load.toml", DRIVERS / "ring_modes.toml"
PLANETARY = DRIVERS / "planetary.toml"
STAGE = DRIVERS / "planetary_stage.toml"

REFUSED = [
    (
        CASCADE,
        "gear_train.model=belt",
        'gear_train.model = "belt" is not available: allowed "cascade" or "gear_pair"',
    ),
    (CASCADE, "gear_train.seed=-1", "gear_train.seed = -1 is out of range: allowed 0 to 1e+12"),
    (CASCADE, "rack.mass=0", "rack.mass = 0 is out of range: allowed above 0 to 1000000000 kg"),
    (CASCADE, "g2.teeth=20.5", "g2.teeth = 20.5 is not a whole number"),
    (CASCADE, "g2.teeth=20.0", "g2.teeth = 20.0 is not a whole number"),
    (CASCADE, "g5.teeth=20", "g5 = a table is not a key of the design file: did you mean g"),
    (CASCADE, "g1_g1.variation=1", "g1_g1.variation = 1 is out of range: allowed 0 to below 1"),
    (CASCADE, "g1_g1.module=5", "g1_g1.module = 5 is out of range: allowed 4 mm (g1_g2.module)"),
    (
        CASCADE,
        "flex_unit.ratio=[1, 1]",
        "flex_unit.ratio = [1, 1] is not a list of that many numbers",
    ),
    (
        CASCADE,
        "flex_unit.ratio=[1, 1, 1, 1, 1, 1, 1, 0]",
        "flex_unit.ratio = 0 is out of range: allowed stiffness",
    ),
    (CASCADE, "load.forces=[]", "load.forces = [] is not a list of that many numbers"),
    (
        CASCADE,
        "load.peak=200",
        "load.forces = 207 is out of range: allowed above 0 to 200 kN (load.peak)",
    ),
    (
        CASCADE,
        "population.step=1",
        "population.step = 1 is out of range: allowed above 0 to 0.4 s (population.hold)",
    ),
    (
        CASCADE,
        "published.static_B_12=1",
        "published.static_B_12 is not a quantity of this gear train: did you mean",
    ),
    (CASCADE, "published.braked_B=1", "published.braked_B = 1 is not a list of 8 numbers"),
    (
        CASCADE,
        "published.overloaded_static=many",
        'published.overloaded_static = "many" is not one number',
    ),
    (
        CASCADE,
        "measured.static_B_12=1",
        "measured.static_B_12 is not a quantity of this gear train: did you mean",
    ),
    (
        CASCADE,
        "g3_g4.gaps_B=[0.1]",
        "g3_g4.gaps_B = [0.1] is out of range: allowed no or 2 numbers, one for each mesh",
    ),
    (
        CASCADE,
        "g3_g4.gaps_A=[0.1, 5]",
        "g3_g4.gaps_A = 5 is out of range: allowed 0 to 4.71239 mm (half of the pitch",
    ),
    (CASCADE, "population.direction=C", 'population.direction = "C" is not available: allowed'),
    (
        GEAR_PAIR,
        "gear_1.radius=0",
        "gear_1.radius = 0 is out of range: allowed above 0 to 1000000 mm",
    ),
    (
        GEAR_PAIR,
        "mesh.contact_ratio=2.5",
        "mesh.contact_ratio = 2.5 is out of range: allowed 1 to 2",
    ),
    (
        GEAR_PAIR,
        "load.output=[1.0]",
        "load.output = [1.0] is out of range: allowed 3 torques (load.input)",
    ),
    (GEAR_PAIR, "load.input=[1.0, -1.0, 1.0]", "load.input = -1 is out of range"),
    (
        GEAR_PAIR,
        "time.step=1",
        "time.step = 1 is out of range: allowed 3e-09 to 0.03 s (at most 10000000 steps)",
    ),
    (
        GEAR_PAIR,
        "monte_carlo.samples=1",
        "monte_carlo.samples = 1 is out of range: allowed 2 to 100000000",
    ),
    (
        RING,
        "ring.inner_radius=520",
        "ring.inner_radius = 520 is out of range: allowed 173.333 mm (a ring as thick as the "
        "radius of its centre line) to below 520 mm",
    ),
    (RING, "ring.inner_radius=1", "ring.inner_radius = 1 is out of range: allowed 173.333 mm"),
    (
        RING,
        "moving_load.cycles=36",
        "moving_load.frequency = 100.8 is out of range: allowed 0 with moving_load.cycles",
    ),
    (
        RING,
        "moving_load.cycles=80 moving_load.frequency=0",
        "moving_load.cycles = 80 is out of range: allowed above 0 to 72 (10 of moving_load.steps",
    ),
    (RING, "ring.nu=0.6", "ring.nu = 0.6 is out of range: allowed above -1 to 0.5"),
    (
        RING,
        "moving_load.radius=521",
        "moving_load.radius = 521 is out of range: allowed 246.25 mm (half of ring.inner_radius) "
        "to 520 mm (ring.outer_radius)",
    ),
    (
        RING,
        "moving_load.radius=0.52",
        "moving_load.radius = 0.52 is out of range: allowed 246.25 mm (half of ring.inner_radius)",
    ),
    (
        RING,
        "supports.count=5",
        "supports.count = 5 is out of range: allowed divisors of 36 (ring.elements)",
    ),
    (
        RING,
        "ring.elements=6",
        "ring.elements = 6 is out of range: allowed at least 12, for a node between two",
    ),
    (
        RING,
        "moving_load.steps=700",
        "moving_load.steps = 700 is out of range: allowed multiples of 3",
    ),
    (
        RING,
        "supports.tangential=0 supports.torsional=0",
        "supports.tangential = 0 is out of range: allowed stiffnesses",
    ),
    (
        RING,
        "supports.count=1 supports.radial=0 supports.torsional=0",
        "is out of range: allowed stiffnesses of the supp",
    ),
    (
        RING,
        "moving_load.damping_mass=0 moving_load.damping_stiffness=0",
        "moving_load.damping_stiffness = 0 is out of range: allowed above 0 to inf s without "
        "moving_load.damping_mass",
    ),
    (
        RING,
        "moving_load.sweep=[3.0]",
        "moving_load.sweep = [3.0] is out of range: allowed two speeds",
    ),
    (PLANETARY, "planet.count=1", "planet.count = 1 is out of range: allowed 2 to 12"),
    (
        PLANETARY,
        "planet.count=7",
        "planet.count = 7 is out of range: allowed divisors of 120 (sun.teeth + ring.teeth)",
    ),
    (
        PLANETARY,
        "ring.teeth=100",
        "ring.teeth = 100 is out of range: allowed 21 (sun.teeth) and twice a planet's",
    ),
    (
        PLANETARY,
        "sun.teeth=27",
        "planet.pitch_diameter = 400.4 is out of range: allowed 287.467 mm within 0.1 %",
    ),
    (
        PLANETARY,
        "ring.supports=1 ring.radial=0 ring.torsional=0",
        "ring.supports = 1 is out of range: allowed supports",
    ),
    (
        PLANETARY,
        "ring.supports=5",
        "ring.supports = 5 is out of range: allowed divisors of 18 (ring.elements)",
    ),
    (
        PLANETARY,
        "time.steps=10001",
        "time.steps = 10001 is out of range: allowed multiples of 500 (time.rows)",
    ),
    (
        PLANETARY,
        "wind.power_coefficient=0.6",
        "wind.power_coefficient = 0.6 is out of range: allowed above 0 to",
    ),
    (
        PLANETARY,
        "planet.count=5",
        "planet.count = 5 is out of range: allowed 2 to 4; the tips of more planets overlap",
    ),
    (PLANETARY, "planet.count=12", "planet.count = 12 is out of range: allowed 2 to 4; the tips"),
    (
        PLANETARY,
        "ring.root_radius=508",
        "ring.root_radius = 508 is out of range: allowed above 508.2 mm (pitch radius) to 539 mm",
    ),
    (PLANETARY, "ring.root_radius=540", "ring.root_radius = 540 is out of range: allowed above"),
    (
        PLANETARY,
        "mesh.half_backlash=1e6",
        "mesh.half_backlash = 1000000 is out of range: allowed 0 to 7577.14 µm (a quarter of the",
    ),
    (
        GEAR_PAIR,
        "mesh.half_backlash=1e6",
        "mesh.half_backlash = 1000000 is out of range: allowed 0 to 56443.9 µm (a quarter of the",
    ),
    (
        CASCADE,
        "g3_g4.gap_B=1000",
        "g3_g4.gap_B = 1000 is out of range: allowed 0 to 4.71239 mm (half of the pitch, g3_g4.mod",
    ),
    (CASCADE, "load.period=1e-6", "load.period = 1e-06 is out of range: allowed 0.01 to"),
    (
        PLANETARY,
        "ring.rim=3000",
        "ring.rim = 3000 is out of range: allowed above 0 to 1042 mm (a rim as thick as the radius",
    ),
    (PLANETARY, "ring.rims=[87.0,1043.0]", "ring.rims = 1043 is out of range: allowed above 0"),
    (
        STAGE,
        "errors.pin_tangential=[1.0]",
        "errors.pin_tangential = [1.0] is out of range: allowed no or 4 numbers (planet.count)",
    ),
    (
        STAGE,
        "errors.sun_pitch=[1.0,2.0]",
        "errors.sun_pitch = [1.0, 2.0] is out of range: allowed no or 21 numbers (sun.teeth)",
    ),
    (
        STAGE,
        "planet.angles=[0.0,91.0,180.0,271.0]",
        "planet.angles = 91 is out of range: allowed multiples of 3 deg (360 deg over sun.teeth +",
    ),
    (
        STAGE,
        "planet.angles=[0.0,60.0,180.0,270.0]",
        "is out of range: allowed 86.2093 deg or more from one to the next, or tips overlap",
    ),
    (STAGE, "planet.angles=[0.0,90.0]", "is out of range: allowed 4 ascending angles (planet.coun"),
    (STAGE, "tolerances.pin=1e5", "tolerances.pin = 100000 is out of range: allowed 0 to 10266.7"),
    (STAGE, "errors.planet_phase=[1.0,1.0,1.0,1.0]", "allowed with errors.planet_eccentricity"),
    (STAGE, "mesh.helix=50", "mesh.helix = 50 is out of range: allowed 0 to 45 deg"),
    (
        STAGE,
        "mesh.sun_stiffness=1e9",
        "mesh.sun_stiffness = 1000000000 is out of range: allowed no value with [teeth]",
    ),
    (
        STAGE,
        "teeth.addendum=1.2",
        "teeth.addendum = 1.2 is out of range: allowed values with a contact ratio of ring and",
    ),
    (STAGE, "teeth.stiffness=fem", 'teeth.stiffness = "fem" is not available: allowed'),
    (STAGE, "load.torque=0", "load.torque = 0 is out of range: allowed above 0 to 1000000000 N·m"),
    (PLANETARY, "rims=1", '--set "rims=1" cannot be read'),
    (RING_MODES, "moving_load.force=1", "moving_load.damping_mass is missing: give a number"),
    (
        RING_MODES,
        "teeth.count=63",
        "teeth.count = 63 is out of range: allowed divisors of 64 (ring.elements)",
    ),
    (
        RING_MODES,
        "ring.modes=65",
        "ring.modes = 65 is out of range: allowed 1 to 64 (ring.elements)",
    ),
]


@pytest.mark.parametrize(("file", "override", "reason"), REFUSED)
def test_one_sentence_with_key_and_reason(file: Path, override: str, reason: str) -> None:
    with pytest.raises(InputError) as caught:
        load_design(file, override.split() if override.count("=") > 1 else [override])
    message = str(caught.value)
    assert "\n" not in message and reason in message, message


def test_drives_are_no_gear_trains() -> None:
    assert system_of_table(read_toml(CASCADE)) is system_of_section("gear_train")
    assert system_of_table(read_toml(REFERENCE)) is system_of_section("drive")
    with pytest.raises(InputError, match="gear_train.model is missing"):
        make_train(read_toml(REFERENCE))


def test_published_values_that_do_not_fit_are_left_out(caplog: pytest.LogCaptureFixture) -> None:
    """Of other speeds and numbers of modes, by override and `with_values`; those that fit stay."""
    with caplog.at_level("WARNING"):
        slower = load_design(RING, ["moving_load.speeds=[2.8, 22.0]"])
    assert "mean_middle_node_22" in slower.published and "critical_speeds" in slower.published
    assert not any(name.endswith(("_30", "_50")) for name in slower.published)
    assert "published.mean_middle_node_30 is left out" in caplog.text
    caplog.clear()
    with caplog.at_level("WARNING"):
        few = load_design(RING_MODES).with_values({"ring.modes": 4})
    assert few.published == {} and "published.frequencies is left out" in caplog.text
    assert "or another number of values" in caplog.text
    # a wrong name stays refused: in the file, with a change, and as a change
    table = read_toml(RING_MODES)
    table["published"] = {"frequency": 1.0}
    for design, overrides in (
        (table, []),
        (table, ["ring.modes=4"]),
        (RING_MODES, ["published.frequency=1"]),
    ):
        with pytest.raises(InputError, match=r"published\.frequency is not a quantity"):
            load_design(design, overrides)


def test_modes_are_compared_by_their_shapes() -> None:
    """On three supports the mode with nodes on them has three waves and the frequency of the free
    ring with as many; other modes mix numbers that three does not divide."""
    design = load_design(DRIVERS / "ring_supported.toml")
    table = model_of(design).compute(design, MPI.COMM_SELF).tables["modes"]
    assert [int(waves) % 3 == 0 for waves in table["waves"]] == [False, True, False]
    assert table["waves"][1] == 3
    assert table["frequency_Hz"][1] == pytest.approx(table["free_ring_Hz"][1], rel=1e-5)
    free = free_frequencies(design.beam_section(), 3)[0] / (2.0 * np.pi)
    assert table["free_ring_Hz"][1] == pytest.approx(free)


REMARKS = [
    (RING, "ring.inner_radius=480", None),
    (
        RING,
        "ring.inner_radius=410",
        "the rim is 0.23 of a wavelength thick (6 waves around): displ",
    ),
    (RING, "ring.inner_radius=300", "beam theory ends at 5 waves: shorter ones are less than"),
    (RING_MODES, "ring.inner_radius=70", "beam theory ends at 3 waves"),
    (PLANETARY, "ring.rim=40 ring.rims=[40]", None),
    (PLANETARY, "ring.rim=128 ring.rims=[40]", "ring under loads are up to 9.2 % too small"),
    (PLANETARY, "ring.rim=40 ring.rims=[128]", "a rim of 128 mm: the rim is 0.21 of a wavelength"),
    (PLANETARY, "ring.rim=900", "beam theory ends at 0.5, where displacements of the ring under"),
]


@pytest.mark.parametrize(("file", "override", "sentence"), REMARKS)
def test_where_beam_theory_ends(file: Path, override: str, sentence: str | None) -> None:
    design = load_design(file, override.split())
    known = model_of(design).quantities(design).values()
    remarks = {quantity.remark for quantity in known} - {""}
    assert set(design.remarks()) == remarks
    if sentence is None:
        assert not remarks
    else:
        assert any(sentence in remark for remark in remarks), remarks


def test_steps_resolve_the_harmonic_part_at_the_lowest_speed() -> None:
    """36 cycles in a revolution at 2.8 rad/s."""
    for override, said in (
        ("moving_load.steps=360", False),
        ("moving_load.steps=357", True),
        ("moving_load.frequency=1e5", True),
        ("moving_load.sweep=[1.3, 50.0]", True),
    ):
        sentences = load_design(RING, [override]).remarks()
        assert bool(sentences) == said, override
        assert all("fewer than 10 of moving_load.steps in a cycle" in one for one in sentences)
    quiet = load_design(RING, ["moving_load.frequency=1e5", "moving_load.harmonic=0"])
    assert not quiet.remarks()


@pytest.mark.parametrize(("force", "said"), [(1e6, False), (1e11, True)])
def test_a_run_says_where_displacements_are_not_small(
    force: float, said: bool, caplog: pytest.LogCaptureFixture
) -> None:
    few = ["steps=36", "sweep_speeds=3", "samples=2", "speeds=[22.0]", "harmonic=0", "noise=0"]
    overrides = [f"moving_load.{key}" for key in [*few, f"force={force}"]]
    design = load_design(RING, ["ring.elements=12", *overrides])
    with caplog.at_level("WARNING"):
        model_of(design).compute(design, MPI.COMM_SELF)
    assert ("of its radius: the linear theory is off by about as much" in caplog.text) == said


@pytest.mark.parametrize(
    "file", [CASCADE, GEAR_PAIR, RING, RING_MODES, DRIVERS / "ring_supported.toml", PLANETARY]
)
def test_derived_values_are_finite(file: Path) -> None:
    design = load_design(file)
    values = model_of(design).derived(design)
    assert values and np.isfinite(list(values.values())).all()


def test_published_beside_computed() -> None:
    known = {"share": Quantity("shares", count=2), "count": Quantity("a count")}
    published = {"share": [0.5, 0.25], "count": 0}
    check_published(published, known)
    rows = compare(published, {"share": [0.55, 0.25], "count": 1.0}, known)
    assert [row.quantity for row in rows] == ["share[1]", "share[2]", "count"]
    assert [row.difference_percent for row in rows] == [pytest.approx(10.0), 0.0, None]
    assert {row.source for row in rows} == {"published"}


def test_measured_beside_published() -> None:
    """Both kinds of values of one quantity; those that do not fit a changed design are left out."""
    design = load_design(CASCADE)
    assert {"static_B_23"} <= design.measured.keys() & design.published.keys()
    changed = design.with_values(["load.forces=[23.0]"])
    assert changed.measured.keys() == {"static_B_23", "static_A_23"}
    given = ["load.forces=[14.0]", "load.peak=14", f"measured.dynamic_B_14={[0.125] * 8}"]
    assert load_design(CASCADE, given).measured == {"dynamic_B_14": [0.125] * 8}
    with pytest.raises(InputError, match="measured.static_B_23 = 1 is not a list of 8 numbers"):
        load_design(CASCADE, ["measured.static_B_23=1"])


def test_streams_are_independent_of_the_order_of_their_use() -> None:
    assert block_sizes(7, 3) == [3, 3, 1]
    first = random_stream(5, 0, 1).standard_normal(4)
    random_stream(5, 0, 0).standard_normal(100)
    assert (random_stream(5, 0, 1).standard_normal(4) == first).all()
    assert (random_stream(5, 0, 2).standard_normal(4) != first).all()
    assert (random_stream(6, 0, 1).standard_normal(4) != first).all()


def test_tasks_come_back_in_order_and_their_errors_too() -> None:
    def fail() -> None:
        raise ConvergenceError("no")

    squares = {"odd": [lambda: 1, lambda: 9], "even": [lambda k=k: k * k for k in (0, 2, 4)]}
    results, seconds = run_tasks(MPI.COMM_WORLD, squares)
    assert results == {"odd": [1, 9], "even": [0, 4, 16]} and seconds.keys() == squares.keys()
    assert 0.0 <= seconds["even"].largest <= seconds["even"].total
    with pytest.raises(ConvergenceError, match="no"):
        run_tasks(MPI.COMM_WORLD, {"tasks": [lambda: 1, fail]})


def test_tables_read_back_to_the_last_bit(tmp_path: Path) -> None:
    table = {
        "x": np.array([0.1, np.nan, 1e-300]),
        "n": np.array([1, 2, 3]),
        "name": np.array(["a", "b,c", "d"]),
    }
    (tmp_path / "t.csv").write_bytes(format_columns(table))
    back = read_columns(tmp_path / "t.csv")
    assert list(back) == list(table) and (back["name"] == table["name"]).all()
    for name in ("x", "n"):
        np.testing.assert_array_equal(back[name], table[name])
