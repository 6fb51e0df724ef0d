"""The gearbox without errors in motion: one period of the rack force, and the braked flywheel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.gear_trains.cascade.design import CascadeDesign, Direction
from swgpar.gear_trains.cascade.dynamics import Gearbox, ramp
from swgpar.gear_trains.cascade.layout import DOFS, RACK
from swgpar.gear_trains.cascade.static_sharing import even_pinion_mask

ROWS = 4000
"""Of the history of one period."""

WINDOW = 0.02
"""Half width, over the peak force, of the range in which load shares at a force are averaged."""

FITTED = 0.25
"""Share of the peak above which a crossing of load shares is sought: there the units are linear."""


@dataclass(frozen=True)
class LoadCycle:
    """One period of the rack force.

    time : (n,) s;  rack_force : (n,) N;  displacement, velocity : (n,) of the rack, m and m/s
    pinion_forces : (n, 8) N
    """

    time: np.ndarray
    rack_force: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    pinion_forces: np.ndarray

    @property
    def shares(self) -> np.ndarray:
        """Load shares (n, 8) (eq. 24); NaN at less than 1 % of the largest rack force."""
        carried = self.pinion_forces.sum(axis=1, keepdims=True)
        loaded = np.abs(carried) > 0.01 * np.abs(self.rack_force).max()
        return self.pinion_forces / np.where(loaded, carried, np.nan)

    def shares_at(self, force: float) -> np.ndarray:
        """Mean load shares (8,) while the rack force in direction B is about `force` N."""
        near = np.abs(self.rack_force - force) < WINDOW * self.rack_force.max()
        carried = self.pinion_forces[near].sum(axis=0)
        return carried / carried.sum()

    def first_crossing(self) -> float:
        """Lowest rack force in N at which shares of an odd and an even pinion cross; NaN for none.

        Where the flexible units are linear, shares are a + b / F: fitted over the tooth cycles.
        """
        lowest, highest = FITTED * self.rack_force.max(), self.rack_force.max()
        loaded = (self.rack_force > lowest) & np.isfinite(self.shares).all(axis=1)
        terms = np.stack([np.ones(loaded.sum()), 1.0 / self.rack_force[loaded]], axis=1)
        a, b = np.linalg.lstsq(terms, self.shares[loaded], rcond=None)[0]
        even = even_pinion_mask()
        constant, falling = a[even][:, None] - a[~even], b[even][:, None] - b[~even]
        with np.errstate(divide="ignore"):
            roots = -falling / constant
        inside = (roots > lowest) & (roots < highest)
        return float(roots[inside].min()) if inside.any() else float("nan")


def one_load_cycle(design: CascadeDesign) -> LoadCycle:
    """From rest through one period of the rack force, direction B first."""
    gearbox, peak = Gearbox(design), 1e3 * design.load.peak
    time = np.linspace(0.0, design.load.period, ROWS + 1)

    def force(t: np.ndarray) -> np.ndarray:
        return peak * np.sin(2.0 * np.pi * t / design.load.period)

    x, v = gearbox.integrate(force, np.zeros(DOFS), time)
    return LoadCycle(time, force(time), x[:, RACK], v[:, RACK], gearbox.pinion_forces(x, v))


def braked_load_shares(design: CascadeDesign, direction: Direction) -> np.ndarray:
    """Load shares (8,) at the braked force with a fixed flywheel, as the source measures them."""
    gearbox, load = Gearbox(design, braked=True), design.load
    force = (1e3 if direction == "B" else -1e3) * load.braked
    time = np.linspace(0.0, load.braked_ramp + load.braked_hold, 401)
    x, v = gearbox.integrate(ramp(force, load.braked_ramp), np.zeros(DOFS), time)
    held = time > load.braked_ramp + 0.5 * load.braked_hold
    carried = gearbox.pinion_forces(x, v)[held].sum(axis=0)
    return carried / carried.sum()
