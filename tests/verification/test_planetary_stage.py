"""Load sharing of planetary stages against closed forms of springs in parallel."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import swgpar
from support.paths import DRIVERS
from swgpar import load_design
from swgpar.errors import InputError, OutputError
from swgpar.gear_trains.planetary_parts.model import PlanetaryModel, base_radii, carrier_index
from swgpar.gear_trains.planetary_parts.natural_modes import natural_modes
from swgpar.gear_trains.planetary_stage.design import PlanetaryStageDesign
from swgpar.gear_trains.planetary_stage.errors import given_errors
from swgpar.gear_trains.planetary_stage.frequency_response import frequency_response
from swgpar.gear_trains.planetary_stage.load_sharing import Revolution, random_factors, revolution
from swgpar.gear_trains.train import make_train

ENDS = ("rotor", "generator")
PIN = 20.0  # µm
MESHES = {
    "sun_stiffness": 16.9e9,
    "ring_stiffness": 19.2e9,
    "variation": 0.0,
    "sun_contact_ratio": 1.6,
    "ring_contact_ratio": 1.5,
    "phase": 0.25,
}
RIGID = {
    "ring.E": 1e5,
    "ring.radial": 1e15,
    "ring.tangential": 1e15,
    "ring.torsional": 1e15,
    "carrier.bearing": 1e15,
    "planet.clearance": 0.0,
    "load.gravity": 0.0,
    "errors.sun_eccentricity": 0.0,
    "errors.pin_tangential": [],
}


def stage(**changes: object) -> PlanetaryStageDesign:
    """The driver's stage with a rigid ring and carrier and given meshes. Keys have __ for a dot."""
    table = load_design(DRIVERS / "planetary_stage.toml").model_dump(exclude_unset=True)
    table.pop("teeth")
    table["mesh"] |= MESHES
    values = {key.replace("__", "."): value for key, value in changes.items()}
    return make_train(table).with_values(RIGID | values)


def shared(design: PlanetaryStageDesign, places: int = 3) -> Revolution:
    return revolution(design, given_errors(design), places)


def stiffness_along(design: PlanetaryStageDesign) -> float:
    """Force on a planet per displacement of its pin along the motion, N/m; sun and ring held."""
    cosine, mesh = np.cos(np.radians(design.mesh.pressure_angle)), design.mesh
    of_meshes = (1.0 / mesh.sun_stiffness + 1.0 / mesh.ring_stiffness) / (4.0 * cosine**2)
    return 1.0 / (1.0 / design.planet.bearing + of_meshes)


def mean_load(design: PlanetaryStageDesign) -> float:
    centres = 0.5e-3 * (design.sun.pitch_diameter + design.planet.pitch_diameter)
    return design.load.torque / (centres * design.planet.count)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_pin_error_with_a_sun_that_is_held(count: int) -> None:
    """A pin ahead takes more, as springs in parallel do; one behind takes less."""
    ahead = [PIN] + [0.0] * (count - 1)
    held = {"planet__count": count, "sun__bearing": 1e15, "sun__torsional": 1e14}
    design = stage(**held, errors__pin_tangential=ahead)
    change = stiffness_along(design) * 1e-6 * PIN * (count - 1) / count / mean_load(design)
    found = shared(design)
    np.testing.assert_allclose(found.factors(), 1.0 + change, rtol=1e-3)
    np.testing.assert_allclose(found.share.sum(axis=-1), 1.0, rtol=1e-12)
    behind = shared(stage(**held, errors__pin_tangential=[-PIN] + [0.0] * (count - 1)))
    np.testing.assert_allclose(behind.share[..., 0] * count, 1.0 - change, rtol=1e-3)


def test_three_planets_around_a_floating_sun_share_evenly() -> None:
    """Whatever the pins, the eccentricities and the flanks; four do not."""
    errors = {
        "errors__pin_tangential": [30.0, -20.0, 5.0],
        "errors__sun_eccentricity": 20.0,
        "errors__planet_eccentricity": [10.0, 0.0, 30.0],
        "errors__sun_pitch": [10.0] + 20 * [0.0],
    }
    design = stage(planet__count=3, sun__bearing=0.0, **errors)
    found = shared(design, 7)
    np.testing.assert_allclose(found.sun / found.sun.mean(), 1.0, atol=1e-8)
    np.testing.assert_allclose(found.factors(), 1.0, atol=1e-7)
    assert np.linalg.norm(found.displacements[..., :2], axis=2).max() > 1e-5
    four = stage(sun__bearing=0.0, errors__pin_tangential=[PIN, 0.0, 0.0, 0.0])
    change = stiffness_along(four) * 1e-6 * PIN / 4.0 / mean_load(four)
    np.testing.assert_allclose(shared(four).factors(), 1.0 + change, rtol=2e-4)


def test_eccentricity_of_the_ring_turns_once() -> None:
    """An eccentric ring moves a held sun's loads with the turn of the carrier. Sun and carrier that
    float follow it."""
    design = stage(sun__bearing=1e15, errors__ring_eccentricity=30.0)
    share = shared(design, 8).share[:, 0, 0] - 0.25
    spectrum = np.abs(np.fft.rfft(share))
    assert spectrum[1] > 1e-3 and spectrum[[0, 2, 3]].max() < 2e-3 * spectrum[1]
    eccentric, central = (
        shared(stage(sun__bearing=0.0, carrier__bearing=1e-3, errors__ring_eccentricity=e))
        for e in (30.0, 0.0)
    )
    np.testing.assert_allclose(eccentric.share, central.share, atol=1e-7)


def test_errors_that_are_equal_to_errors_of_pins() -> None:
    """An eccentric planet is one whose pin is as far off. Flanks of a planet that are all ahead by
    c are a pin that is c / cos(alpha) ahead. Flanks of the sun that are all ahead turn the sun."""
    held = {"sun__bearing": 1e15}
    cosine = np.cos(np.radians(20.0))

    def at_start(**errors: object) -> np.ndarray:
        return shared(stage(**held, **errors), 2).share[0, 0]

    pin = at_start(errors__pin_tangential=[PIN, 0.0, 0.0, 0.0])
    eccentric = at_start(
        errors__planet_eccentricity=[PIN, 0.0, 0.0, 0.0],
        errors__planet_phase=[90.0, 0.0, 0.0, 0.0],
    )
    np.testing.assert_allclose(eccentric, pin, rtol=1e-9)
    flanks = at_start(errors__planet_pitch=39 * [PIN * cosine])
    np.testing.assert_allclose(flanks, pin, rtol=1e-9)
    none, turned = at_start(), at_start(errors__sun_pitch=21 * [PIN])
    np.testing.assert_allclose(turned, none, rtol=1e-9)


def test_one_tooth_passes_every_planet() -> None:
    """The flank of one tooth of the sun that is ahead loads each planet once in a turn of the sun
    against the carrier, one planet after the other."""
    design = stage(sun__bearing=1e15, errors__sun_pitch=[10.0] + 20 * [0.0])
    found = shared(design, 297)
    loaded = found.share[:, 0] > 0.25 + 0.5 * np.ptp(found.share[:, 0])
    begins = (np.diff(loaded.astype(int), axis=0) == 1).sum(axis=0)
    turns = 99.0 / 21.0
    assert (np.abs(begins - turns) <= 1.0).all()
    assert (loaded.sum(axis=1) <= 2).all()


def test_against_the_whole_matrices() -> None:
    """The elastic ring, condensed to its meshes, gives the forces of all coordinates."""
    design = load_design(DRIVERS / "planetary_stage.toml").with_values(
        {
            "planet.clearance": 0.0,
            "load.gravity": 0.0,
            "mesh.half_backlash": 0.0,
            "errors.pin_tangential": [],
            "errors.sun_eccentricity": 0.0,
        }
    )
    found, train = shared(design, 5), PlanetaryModel(design)
    without = design.model_copy(update={"rotor": None, "generator": None})
    held = PlanetaryModel(without)
    for place, angle in enumerate(found.angle):
        t = angle / design.carrier.speed
        rows, k = held.deflection_rows(t), train.mesh_stiffness(np.array([t]))[0]
        stiffness = held.constant + rows.T @ (k[:, None] * rows)
        load = np.zeros(held.size)
        load[carrier_index(without) + 2] = design.load.torque / base_radii(design)[2]
        forces = -k * (rows @ np.linalg.solve(stiffness, load))
        ours = np.concatenate([found.sun[place, 0], found.ring[place, 0]])
        np.testing.assert_allclose(ours, forces, rtol=1e-6)


def test_planets_at_unequal_places() -> None:
    """Springs in parallel share evenly wherever they are; a floating sun must balance them."""
    angles = [0.0, 87.0, 180.0, 267.0]
    held = shared(stage(planet__angles=angles, sun__bearing=1e15))
    np.testing.assert_allclose(held.factors(), 1.0, atol=1e-3)
    three = {"planet__count": 3, "planet__angles": [0.0, 90.0, 225.0], "sun__bearing": 0.0}
    share = shared(stage(**three)).sun[0, 0]
    # forces of a floating sun at 0, 90 and 225 deg: 1, 1 and the root of 2
    np.testing.assert_allclose(share / share[0], [1.0, 1.0, np.sqrt(2.0)], rtol=1e-6)


def test_clearance_and_gravity() -> None:
    """A planet hangs in its clearance: without torque the pin carries its weight; with torque the
    forces of the carrier balance the torque, and weights move no mean load."""
    design = stage(planet__clearance=50.0, load__gravity=9.81, load__torque=1e-6, sun__bearing=1e9)
    found = shared(design, 5)
    weight = design.planet.mass * 9.81
    assert np.linalg.norm(found.pin, axis=-1).max() < 3.0 * weight
    loaded = stage(planet__clearance=50.0, load__gravity=9.81)
    found = shared(loaded, 5)
    total = found.pin[..., 1].sum(axis=-1)
    np.testing.assert_allclose(total, 4.0 * mean_load(loaded), rtol=1e-8)
    np.testing.assert_allclose(found.mean_factors(), 1.0, atol=1e-4)


def test_clearance_alone_changes_no_share() -> None:
    tight, loose = (shared(stage(planet__clearance=c)).factors() for c in (0.0, 80.0))
    np.testing.assert_allclose(tight, loose, atol=1e-9)


def test_trains_whose_energy_vanishes() -> None:
    """Where the work of the load and the energy of the springs cancel, the energy has no more
    digits than its parts: steps at the end are judged by these."""
    new = swgpar.new_train(train="planetary_stage", ratio=4.2, diameter=240.0, torque=3000.0)
    light = {"load.torque": 300.0, "errors.pin_tangential": [0.0, 60.0, 0.0], "sun.bearing": 1e9}
    design = new.with_values(light)
    assert np.isfinite(random_factors(design, design.tolerances, 1, 100)).all()


def test_back_flanks_and_planets_without_load_are_remarked() -> None:
    """A pin that is far behind is pushed by the sun and holds back the ring, or the other way: its
    planet runs on back flanks. Backlash that is larger than the error leaves it without a load."""
    held = {"sun__bearing": 1e15, "sun__torsional": 1e14, "load__torque": 100.0}
    behind = {"errors__pin_tangential": [-200.0, 0.0, 0.0, 0.0], "planet__count": 4}
    found = shared(stage(**held, **behind, mesh__half_backlash=0.0))
    (force,) = found.sun[0]
    assert force[0] < 0.0 < force[1:].min()
    (sentence,) = found.remarks()
    assert sentence.startswith("back flanks are in contact")
    assert "sun and planet 1 (100 %); ring and planet 1 (100 %)." in sentence
    loose = shared(stage(**held, **behind, mesh__half_backlash=1000.0))
    (sentence,) = loose.remarks()
    assert loose.sun[0, 0, 0] == 0.0 and sentence.startswith("nothing is in contact")
    even = shared(stage(**held, mesh__half_backlash=0.0))
    assert even.remarks() == []


def test_random_pins() -> None:
    """Four planets around a floating sun: the part (1, -1, 1, -1)/4 of the pins is normal with half
    of their deviation, and the factor is 1 + kappa |x| / F: quantiles of a half-normal number."""
    tolerance = {"pin": 30.0, "samples": 400, "positions": 2}
    table = stage(sun__bearing=0.0).model_dump(exclude_unset=True) | {"tolerances": tolerance}
    design = PlanetaryStageDesign.model_validate(table)
    found = random_factors(design, design.tolerances, 0, 400)[:, 0] - 1.0
    expected = stiffness_along(design) * 0.5 * 10e-6 / mean_load(design)
    assert np.sqrt((found**2).mean()) == pytest.approx(expected, rel=0.1)
    # the same numbers in any division into blocks of the same number
    again = random_factors(design, design.tolerances, 0, 400)[:, 0] - 1.0
    np.testing.assert_array_equal(found, again)


def test_a_run(tmp_path: Path) -> None:
    """Answers of every planet, tables and figures; the same from its folder."""
    few = {"load.positions": 20, "tolerances.samples": 110, "tolerances.positions": 3}
    result = swgpar.run(
        load_design(DRIVERS / "planetary_stage.toml").with_values(few), out=tmp_path / "run"
    )
    value = {name: answer.value for name, answer in result.summary.items()}
    assert value["load_sharing_factor"] == max(
        4.0 * value[f"largest_share[{k}]"] for k in range(1, 5)
    )
    assert value["random_factor_median"] < value["random_factor_90"] < value["random_factor_99"]
    force = max(value[f"largest_sun_force[{k}]"] for k in range(1, 5))
    helix, angle = np.radians(7.5), np.radians(20.0)
    axial = force * np.cos(angle) * np.tan(helix)
    assert value["axial_force"] == pytest.approx(axial)
    assert value["tilting_moment"] == pytest.approx(axial * 0.4004)
    assert set(result.plot.names) == {
        *("planet_loads", "mesh_forces", "sun_path", "spectrum", "response", "campbell"),
        "random_factors",
    }
    again = swgpar.open_result(tmp_path / "run")
    assert {name: answer.value for name, answer in again.summary.items()} == value
    spectrum, planets = result.tables["spectrum"], result.tables["planets"]
    assert spectrum["sun_force_2_N"][0] == pytest.approx(planets["sun_force_2_N"].mean())
    assert again.tables["random"]["train"].tolist() == list(range(1, 111))


@pytest.mark.parametrize(
    ("ratio", "diameter", "torque"), [(3.4, 60.0, 20.0), (5.7, 1000.0, 2e5), (12.0, 300.0, 800.0)]
)
def test_a_stage_to_start_from(
    ratio: float, diameter: float, torque: float, tmp_path: Path
) -> None:
    """Near the ratio, of the given size; the file gives the same design; it carries its load."""
    sizes = {"ratio": ratio, "diameter": diameter, "torque": torque}
    design = swgpar.new_train(tmp_path / "a b.toml", train="planetary_stage", **sizes)
    assert swgpar.load_design(tmp_path / "a b.toml") == design
    assert 1.0 + design.ring.teeth / design.sun.teeth == pytest.approx(ratio, rel=0.02)
    assert design.module * design.ring.teeth == pytest.approx(diameter)
    found = shared(design)
    assert design.load.torque == torque and found.sun.min() > 0.0
    with pytest.raises(OutputError, match="exists"):
        swgpar.new_train(tmp_path / "a b.toml", train="planetary_stage", **sizes)


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        ({"ratio": 2.0}, r"ratio = 2 is out of range: allowed 3 to 12 \(sun over carrier\)"),
        ({"torque": 1e7}, r"torque = .* is out of range: allowed up to 3\.375e\+05 N·m with this"),
        ({"diameter": 0.0}, r"diameter = 0 is out of range: allowed 1 to 100000 mm"),
    ],
)
def test_stages_that_are_refused(wrong: dict[str, float], sentence: str) -> None:
    given = {"ratio": 5.0, "diameter": 1000.0, "torque": 1e5} | wrong
    with pytest.raises(InputError, match=sentence):
        swgpar.new_train(train="planetary_stage", **given)


def test_frequency_response() -> None:
    """At low frequency a stage whose shaft is held answers as at rest: every sun mesh has its part
    of the torque. Without damping the response is largest at natural frequencies. A transmission
    error that is slow makes no force where the sun turns freely."""
    table = stage(damping__mass=0.0, damping__stiffness=1e-9).model_dump(exclude_unset=True)
    held = make_train({name: part for name, part in table.items() if name not in ENDS})
    train = PlanetaryModel(held)
    slow = frequency_response(train, np.array([1e-3]))
    centres = base_radii(held)[2]
    per_mesh = 1.0 / (4.0 * 2.0 * centres * np.cos(np.radians(20.0)))
    np.testing.assert_allclose(slow.mesh_by_torque, per_mesh, rtol=1e-3)
    modes = natural_modes(train)
    (rotational, *_) = modes.frequency[(modes.kind == "rotational") & (modes.frequency > 1.0)]
    near = frequency_response(train, rotational * np.array([0.98, 1.0, 1.02])).mesh_by_torque[:, 0]
    assert near[1] > 20.0 * max(near[0], near[2])
    free = make_train(table | {"generator": {"inertia": 1.0}})
    slow = frequency_response(PlanetaryModel(free), np.array([1e-2])).mesh_by_error
    fast = frequency_response(PlanetaryModel(free), np.array([200.0])).mesh_by_error
    assert slow.max() < 1e-3 * fast.max()


def test_rotor_and_generator_are_two_more_coordinates() -> None:
    """A light rotor and generator hardly change the other modes; the train then turns freely."""
    table = load_design(DRIVERS / "planetary_stage.toml").model_dump(exclude_unset=True)
    free = PlanetaryStageDesign.model_validate(table)
    grounded = {name: part for name, part in table.items() if name not in ("rotor", "generator")}
    held = PlanetaryStageDesign.model_validate(grounded)
    size = PlanetaryModel(held).size
    assert PlanetaryModel(free).size == size + 2
    lowest = natural_modes(PlanetaryModel(free)).frequency[0]
    assert lowest < 0.01 < natural_modes(PlanetaryModel(held)).frequency[2]
    heavy = table | {"generator": {"inertia": 1e9}}
    heavy.pop("rotor")
    frequencies = [
        natural_modes(PlanetaryModel(PlanetaryStageDesign.model_validate(one))).frequency
        for one in (heavy, grounded)
    ]
    np.testing.assert_allclose(frequencies[0][1:], frequencies[1], rtol=1e-3)
