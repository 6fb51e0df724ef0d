"""How the planets of a stage share its load, over a revolution of the carrier.

The load of a planet is the force of the carrier on it along the motion. The load sharing factor is
the largest load of a planet over the mean of all (K_gamma of ISO 6336-1 and IEC 61400-4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.gear_trains.planetary_parts.model import PlanetaryModel
from swgpar.gear_trains.planetary_stage.design import PlanetaryStageDesign, StageTolerances
from swgpar.gear_trains.planetary_stage.errors import StageErrors, random_errors
from swgpar.gear_trains.planetary_stage.static_equilibrium import StaticStage

BLOCK_SIZE = 100


@dataclass(frozen=True)
class Revolution:
    """Trains at places of the carrier in one revolution; arrays begin with (places, trains).

    angle : (places,) rad
    displacements : (…, unknowns) m
    sun, ring : (…, planets) N, mesh forces, positive on the loaded flank
    pin : (…, planets, 2) N, of the carrier on the planets, outward and along
    """

    angle: np.ndarray
    displacements: np.ndarray
    sun: np.ndarray
    ring: np.ndarray
    pin: np.ndarray

    @property
    def share(self) -> np.ndarray:
        """Load of each planet over that of all, (places, trains, planets)."""
        along = self.pin[..., 1]
        return along / along.sum(axis=-1, keepdims=True)

    def factors(self) -> np.ndarray:
        """Load sharing factors (trains,), at the worst place."""
        return self.share.max(axis=(0, 2)) * self.share.shape[-1]

    def mean_factors(self) -> np.ndarray:
        """Load sharing factors (trains,) of the mean loads over the revolution."""
        return self.share.mean(axis=0).max(axis=1) * self.share.shape[-1]

    def remarks(self) -> list[str]:
        """Which planets of the first train touch with back flanks, or are without load."""
        sentences = []
        for what, touches in (
            ("back flanks are in contact", lambda force: force < 0.0),
            ("nothing is in contact", lambda force: force == 0.0),
        ):
            places = []
            for gear, force in (("sun", self.sun[:, 0]), ("ring", self.ring[:, 0])):
                part = np.mean(touches(force), axis=0)
                names = [f"{k + 1} ({100.0 * part[k]:.3g} %)" for k in np.flatnonzero(part)]
                places += [f"{gear} and planet {', '.join(names)}"] if names else []
            if places:
                sentences.append(
                    f"{what} at a part of the places of the carrier: {'; '.join(places)}. Errors "
                    "or weights are larger than the load takes up there"
                )
        return sentences


def revolution(design: PlanetaryStageDesign, errors: StageErrors, places: int) -> Revolution:
    """All trains with given errors. Raises ConvergenceError."""
    stage, count = StaticStage(PlanetaryModel(design), design, errors), design.planet.count
    angle = 2.0 * np.pi * np.arange(places) / places
    found = [stage.at(one / design.carrier.speed) for one in angle]
    mesh = np.array([one.mesh for one in found])
    return Revolution(
        angle,
        np.array([one.displacements for one in found]),
        mesh[..., :count],
        mesh[..., count:],
        np.array([one.bearing for one in found]),
    )


def random_factors(
    design: PlanetaryStageDesign, tolerances: StageTolerances, block: int, count: int
) -> np.ndarray:
    """Load sharing factors (count, 2) of the trains of a block: at the worst place, of means."""
    errors = random_errors(design, tolerances, block, count)
    found = revolution(design, errors, tolerances.positions)
    return np.stack([found.factors(), found.mean_factors()], axis=1)
