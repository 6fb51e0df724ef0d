r"""Cross-section of one tooth: mapped quadrilaterals that follow the flank.

Half a tooth is cut into blocks (shown for an external tooth, centre line on the left; an internal
one is the same with the radial direction reversed)::

    M---T.            M  centre of the top land, T start of the flank (addendum circle)
    |  cap K          K  end of the rounded tip edge, normal 60 degrees above horizontal, or T
    A---I   \         Q  on the root arc, where it rises 45 degrees
    |    \ s \        R  end of the flank (dedendum circle), E  middle of the root
    | core\ i \       B  below Q on the interface circle
    |      \ d \
    |       \ e  Q..      C  centre line on the interface circle
    W--------J-'  ''R--E
    |  under     | root|
    C------------B-----E'   interface circle, from which the lower rim has straight radial lines
    |  lower rim |     |
    '------------'-----'    free circle: inside of the flexible spline, outside of the ring gear

Three lines meet at I: the flank is smooth at K, where a block's corner would be degenerate.
"""

from __future__ import annotations

import math

import numpy as np

from swgpar.geometry.arrays import Floats
from swgpar.meshing.mapped import Sides
from swgpar.meshing.recipe import ToothRecipe
from swgpar.meshing.spacing import even, graded, line, polar, share, split_count
from swgpar.profiles.flank import ToothProfile

TIP_NORMAL, ROOT_NORMAL = np.radians(60.0), np.radians(45.0)
"""Inclination of the flank's normal, above the tangent of the pitch circle, at K and at Q."""

SHORTEST_EDGE = 0.045
"""Least length of a rounded tip edge over that of the flank: a shorter one has no element. Those of
starts have 0.048 and more. With an element on edges of 0.042, teeth that jump over stop at their
tips: their ratcheting run finds no equilibrium behind its peak."""

SHORT = 0.5
"""Length of a segment of the flank over that of equal elements, below which its element is one more
than asked for: S-shaped teeth have up to three such segments, and of six elements one was left for
half of the flank (docs/verification/error_sources_plane.md)."""

ROUGH = 2
"""Elements along a flank up to which the ends of its segments are of no account: no contact is
found with so few."""

LOWEST_CAP = 0.5
"""Largest part of the height from J to K that the cap takes: the core needs the rest."""

LEAST_UNDER = 0.5
"""Least height of W over the interface circle over that of J: on low teeth the line from Q through
J would meet the circle."""

DEEP_LEAN = 0.4
"""Least polar angle at the interface circle of the line that begins at Q, over that of Q."""


def stations(profile: ToothProfile, first: float, last: float, n: int) -> Floats:
    """Return n + 1 arc lengths from `first` to `last`, mm.

    The ends of segments are among them where elements suffice; else the distances are equal.
    """
    ends = _ends(profile, first, last)
    if n < len(ends) - 1:
        return first + (last - first) * even(n)
    counts = share(n, np.diff(ends))
    parts = [a + (b - a) * even(k)[1:] for a, b, k in zip(ends[:-1], ends[1:], counts, strict=True)]
    return np.concatenate(([first], *parts))


def _ends(profile: ToothProfile, first: float, last: float) -> Floats:
    """Arc lengths (n,) mm of the ends of segments from `first` to `last`, these included."""
    margin = 1e-9 * profile.length
    breaks = profile.breaks[(profile.breaks > first + margin) & (profile.breaks < last - margin)]
    return np.concatenate(([first], breaks, [last]))


def flank_stations(profile: ToothProfile, first: float, last: float, n: int) -> Floats:
    """As `stations`, with an element beside the n for each segment that is `SHORT`; not where the n
    are `ROUGH`."""
    short = np.diff(_ends(profile, first, last)) < SHORT * (last - first) / n
    return stations(profile, first, last, n if n <= ROUGH else n + int(short.sum()))


def inclination(profile: ToothProfile, s: Floats) -> Floats:
    """Angle (n,), rad, of the flank's normal above the tangential direction, towards the tip."""
    x, y = profile.point(s).T
    towards_tip = profile.sign * np.stack((x, y), axis=-1) / np.hypot(x, y)[:, None]
    return np.arcsin(np.clip(np.einsum("ij,ij->i", profile.normal(s), towards_tip), -1.0, 1.0))


def snap(profile: ToothProfile, s: float, within: float) -> float:
    """Return the end of a segment next to `s` when it is nearer than `within`, else `s`, mm."""
    nearest = profile.breaks[np.argmin(np.abs(profile.breaks - s))]
    return float(nearest) if abs(nearest - s) < within else s


def block_ends(profile: ToothProfile) -> tuple[float, float]:
    """Return the arc lengths of K and Q, mm; K is T on a tooth whose tip edge is sharp or short."""
    s = profile.length * even(4096)
    angle = inclination(profile, s)
    middle = int(np.argmin(angle))
    tip = np.flatnonzero(angle[: middle + 1] > TIP_NORMAL)
    root = np.flatnonzero(angle[middle:] < ROOT_NORMAL)
    edge = s[tip[-1]] if tip.size else 0.0
    q = min(s[middle + root[-1]], profile.length) if root.size else s[middle]
    k = snap(profile, edge, 0.1 * profile.length)
    if k == 0.0 and edge >= SHORTEST_EDGE * profile.length:
        k = edge  # K at the beginning of a rounded edge would have the normal of the top land
    return k, snap(profile, q, 0.04 * profile.length)


class HalfTooth:
    """Nodes on the sides of the blocks of half a tooth (x >= 0).

    Attributes:
    s : (n,) mm, arc lengths of the flank's nodes, from T to R
    s_side : (n_side,) mm, those from K to Q
    tip, root : (n, 2) mm, nodes from M to K and from Q to E;  half_pitch : rad

    profile : ToothProfile
    recipe : ToothRecipe
    interface, free : mm, radii of the interface circle and of the free surface of the rim
    """

    def __init__(
        self, profile: ToothProfile, recipe: ToothRecipe, interface: float, free: float
    ) -> None:
        self.profile = profile
        self.recipe = recipe
        self.interface = interface
        self.free = free
        self.half_pitch = np.pi / profile.n_teeth
        s_k, s_q = block_ends(profile)
        s_tip, self.tip = self._tip(s_k)
        s_root, self.root = self._root(s_q)
        self.s_side = self._side(s_k, s_root)
        self.s = np.concatenate((s_tip[:-1], self.s_side, s_root[1:]))

    def _tip(self, s_k: float) -> tuple[Floats, Floats]:
        """Arc lengths (n,) of the flank's nodes from T to K, and nodes (m, 2) from M to K; mm."""
        profile = self.profile
        n_land, n_arc = split_count(self.recipe.tip, 0.5 * profile.top_land, s_k)
        s_tip = stations(profile, 0.0, s_k, n_arc)
        land = polar(profile.r_tip_circle, profile.polar_angle(0.0)[0] * even(n_land))
        return s_tip, np.concatenate((land[:-1], profile.point(s_tip)))

    def _root(self, s_q: float) -> tuple[Floats, Floats]:
        """Arc lengths (n,) of the flank's nodes from Q to R, and nodes (m, 2) from Q to E; mm."""
        profile = self.profile
        n_land, n_arc = split_count(self.recipe.root, 0.5 * profile.root_land, profile.length - s_q)
        s_root = stations(profile, s_q, profile.length, n_arc)
        start = profile.polar_angle(profile.length)[0]
        land = polar(profile.r_root_circle, start + (self.half_pitch - start) * even(n_land))
        return s_root, np.concatenate((profile.point(s_root), land[1:]))

    def _side(self, s_k: float, s_root: Floats) -> Floats:
        """Arc lengths (n,) of the flank's nodes from K to Q, mm. s_root : of those from Q to R"""
        profile, count, s_q = self.profile, self.recipe.flank, float(s_root[0])
        begin = profile.root_start
        if not (self.recipe.even_root and s_k < begin < s_q and len(s_root) > 1 and count > 1):
            return flank_stations(profile, s_k, s_q, count)
        arc = math.ceil((s_q - begin) / (s_root[1] - s_root[0]) * (1.0 - 1e-9))
        arc = min(arc, count // 2)
        above = flank_stations(profile, s_k, begin, count - arc)
        return np.concatenate((above, begin + (s_q - begin) * even(arc)[1:]))

    def blocks(self) -> list[Sides]:
        """Sides of all blocks: cap, side, core, under, root, lower rim under tooth and root."""
        recipe, interface = self.recipe, self.interface
        side = self.profile.point(self.s_side)
        k, q = side[0], side[-1]
        n_core, n_layer = recipe.tip, recipe.layers
        fractions = graded(n_layer, recipe.layer_ratio)
        theta_b = self._split_angle(q)
        b = polar(interface, theta_b)
        bottom = polar(interface, theta_b * even(n_core + n_layer))
        j, w = self._shoulder(q, b, n_core / (n_core + n_layer))
        i, a = self._apex(side, j, n_core, n_layer)
        inner, centre = self._core_sides(side, i, a, j, w)
        k_to_i, q_to_j = line(k, i, fractions), line(q, j, fractions)
        w_to_q = np.concatenate((line(w, j, even(n_core))[:-1], q_to_j[::-1]))
        down = graded(recipe.under, recipe.under_ratio ** (1.0 / max(recipe.under - 1, 1)))
        q_to_b, w_to_c = line(q, b, down), line(w, bottom[0], down)
        root_angles, root_bottom = self._root_bottom(theta_b)
        e_to_bottom = line(self.root[-1], root_bottom[-1], down)
        radii = interface + (self.free - interface) * even(recipe.rim)
        rim = [polar(radii, angle)[::-1] for angle in (0.0, theta_b, self.half_pitch)]
        cap_bottom = line(a, i, even(n_core))
        cap_left = line(a, self.tip[0], fractions[::-1].max() - fractions[::-1])
        return [
            (cap_bottom, k_to_i[::-1], self.tip, cap_left),
            (q_to_j[::-1], side[::-1], k_to_i[::-1], inner[::-1]),
            (w_to_q[: n_core + 1], inner[::-1], cap_bottom, centre[::-1]),
            (bottom, q_to_b[::-1], w_to_q, w_to_c[::-1]),
            (root_bottom, e_to_bottom[::-1], self.root, q_to_b[::-1]),
            (polar(self.free, theta_b * even(n_core + n_layer)), rim[1], bottom, rim[0]),
            (polar(self.free, root_angles), rim[2], root_bottom, rim[1]),
        ]

    def _core_sides(
        self, side: Floats, i: Floats, a: Floats, j: Floats, w: Floats
    ) -> tuple[Floats, Floats]:
        """Nodes (n, 2) from I to J and from A to W, for `side` (n, 2) from K to Q; mm."""
        k, q = side[0], side[-1]
        # the inner line lies between the flank's shape (good for the side) and a straight one (for
        # the core)
        t = ((self.s_side - self.s_side[0]) / (self.s_side[-1] - self.s_side[0]))[:, None]
        parallel = side + (1.0 - t) * (i - k) + t * (j - q)
        straight = i + t * (j - i)
        inner = straight + 0.5 * self._follows(t) * (parallel - straight)
        height = inner[:, 1] + ((1.0 - t) * (a - i) + t * (w - j))[:, 1]
        return inner, np.stack((np.zeros_like(height), height), axis=-1)

    def _follows(self, t: Floats) -> Floats:
        """How far the inner line follows the flank's shape at shares t (n, 1) of its length. Along
        a rounded edge below which there is no cap it begins straight: the edge begins as the top
        land ends, and an inner line like it would fold the core."""
        first = self.profile.segments[0]
        if self.s_side[0] > 0.0 or first.name != "tip":
            return np.ones_like(t)
        return np.minimum(t * (self.s_side[-1] / first.length), 1.0)

    def _root_bottom(self, theta_b: float) -> tuple[Floats, Floats]:
        """Polar angles (n,) rad and nodes (n, 2) mm on the interface circle from B to E'."""
        top = np.arctan2(*self.root.T)
        top = (top - top[0]) / (top[-1] - top[0])
        angles = theta_b + (self.half_pitch - theta_b) * (0.6 * even(self.recipe.root) + 0.4 * top)
        return angles, polar(self.interface, angles)

    def _split_angle(self, q: Floats) -> float:
        """Polar angle of B, rad: between a line square to the root arc and even widths."""
        recipe = self.recipe
        n_base = recipe.tip + recipe.layers
        uniform = self.half_pitch * n_base / (n_base + recipe.root)
        theta_q = np.arctan2(*q)
        depth = abs(np.hypot(*q) - self.interface)
        # below a deep rim the line is steeper, so that it stays within the sector
        lean = max(theta_q - depth * np.tan(np.radians(15.0)) / self.interface, DEEP_LEAN * theta_q)
        return 0.5 * (lean + np.clip(uniform, 0.8 * lean, 1.1 * lean))

    def _shoulder(self, q: Floats, b: Floats, fraction: float) -> tuple[Floats, Floats]:
        """Return J and W, the inner corners of the row of elements that ends at Q."""
        # halfway between the flank above Q and the line to B, so that the angles at Q are about
        # equal
        upwards = -self.profile.tangent(self.s_side[-1])[0]
        to_b = (b - q) / np.hypot(*(b - q))
        direction = upwards + to_b
        direction /= np.hypot(*direction)
        width = (1.0 - fraction) * q[0]
        j = q + direction * width / abs(direction[0])
        towards_tip = self.profile.sign
        least = self.interface + LEAST_UNDER * (j[1] - self.interface)
        height = j[1] + 0.5 * (j[1] - q[1]) * j[0] / width * fraction
        return j, np.array((0.0, towards_tip * max(towards_tip * height, towards_tip * least)))

    def _apex(self, side: Floats, j: Floats, n_core: int, n_layer: int) -> tuple[Floats, Floats]:
        """Return I and A, the inner corners of the cap.

        side : (n, 2) mm, nodes from K to Q
        """
        k = side[0]
        inwards = -self.profile.normal(self.s_side[0])[0]
        if self.s_side[0] == 0.0:
            # a sharp edge: halfway between the flank and the top land
            upwards = self.profile.sign * k / np.hypot(*k)
            if -inwards @ upwards > np.sin(TIP_NORMAL):  # a short rounded edge: of its chord
                x, y = (side[1] - k) / np.hypot(*(side[1] - k))
                inwards = np.array((y, -x)) * np.sign(upwards[1])
            inwards = inwards - upwards
            inwards = inwards / np.hypot(*inwards)
        reach = np.hypot(*(self.tip[0] - k)) + 0.5 * self.profile.top_land
        depth = min(0.5 * n_layer * reach / n_core + 0.25 * reach, 0.5 * k[0] / abs(inwards[0]))
        depth = min(depth, LOWEST_CAP * abs(k[1] - j[1]) / abs(inwards[1]))
        i = k + depth * inwards
        return i, np.array((0.0, i[1] - 0.25 * inwards[1] / abs(inwards[1]) * abs(k[1] - i[1])))
