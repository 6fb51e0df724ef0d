"""The contacts of the wave generator: cam and pins, or balls and outer race of a bearing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.contact.ball_contact import BallContact
from swgpar.contact.contact import NO_KEYS, Contact, PenaltyContact
from swgpar.contact.race_contact import RaceContact
from swgpar.contact.rigid_surface import RigidContact
from swgpar.fem.elements import Elements


@dataclass(frozen=True, kw_only=True)
class WaveGeneratorContacts:
    """Contacts by what touches; None where it is absent.

    cam, pins : rigid, on the inner surface of the flexible spline
    race : outer race of a bearing, on that surface;  balls : on the race
    """

    cam: RigidContact | None = None
    pins: RigidContact | None = None
    race: RaceContact | None = None
    balls: BallContact | None = None

    @property
    def of_inner_surface(self) -> list[PenaltyContact]:
        """Those that press on the flexible spline."""
        return [one for one in (self.cam, self.pins, self.race) if one is not None]

    @property
    def all(self) -> list[Contact]:
        """Those that are present."""
        balls = [] if self.balls is None else [self.balls]
        return [*self.of_inner_surface, *balls]

    def block_keys(self, elements: Elements) -> np.ndarray:
        """Keys (n,) of the tangent's blocks that race and balls need, row * n_global + column,
        sorted."""
        nodes = [] if self.race is None else [self.race.conn]
        nodes += [] if self.balls is None else [self.balls.windows]
        keys = [elements.block_keys(conn).ravel() for conn in nodes]
        keys = np.unique(np.concatenate([NO_KEYS, *keys]))
        return keys[keys >= 0]
