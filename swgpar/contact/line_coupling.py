"""What the elements under a flank lack for a load that changes within a layer along the face width.

Along z the elements interpolate linearly. The line load w(z) of the lines acts on them as its
projection Pi w onto the hat functions of the layers' nodes. For Pi w they lack what they lack in
the section (`swgpar.contact.missing_compliance`). Of the rest they see nothing: it acts on half
spaces alone. Missing in all, with the half space H and the elements' Green's function G,

    D Pi + H (1 - Pi) = D + (G + R) (1 - Pi),

where R is H without the logarithm of the section: R / (pi E') of
`swgpar.contact.layer_half_space`.

A load that is linear over the layers has no rest, and lines then do not couple. The load of a line
is uniform over its share of the face width; R is the mean over the shares. Forces have images at
the ends of the profile, as in G.
"""

from __future__ import annotations

import numpy as np

from swgpar.contact.layer_half_space import among_lines
from swgpar.contact.missing_compliance import MissingCompliance


class LineCoupling:
    """Compliance (G + R) (1 - Pi) among the lines of one flank of a body.

    Parameters
    ----------
    missing : of the flank;  nodes : (n_z,) mm, stations of its nodes
    z, length : (n_line,) mm, of all lines, and their shares of the face width

    Attributes
    ----------
    table : (n_line, n_line, n_s, n_s) mm / (N/mm), by lines and nodes of the profile, for loads and
    displacements times the roots of the lengths: symmetric
    """

    def __init__(
        self, missing: MissingCompliance, nodes: np.ndarray, z: np.ndarray, length: np.ndarray
    ) -> None:
        self.s = missing.s
        hats = np.array([np.interp(z, nodes, unit, 0.0, 0.0) for unit in np.eye(len(nodes))]).T
        seen = np.sqrt(length)[:, None] * hats
        rest = np.eye(len(z)) - seen @ np.linalg.pinv(seen)
        compliance = missing.green * np.eye(len(z))[..., None, None]
        for place in (self.s, 2.0 * self.s[0] - self.s, 2.0 * self.s[-1] - self.s):
            half_space = among_lines(place[:, None] - self.s, z, length)
            compliance += 0.5 * missing.logarithm * half_space
        self.table = np.einsum("lp,pqab,qm->lmab", rest, compliance, rest, optimize=True)

    def add(
        self,
        start: np.ndarray,
        line: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        out: np.ndarray,
    ) -> None:
        """Add the compliance among cells, of means over them under forces spread over them.

        start : (m + 1,) first cell of each line;  line : (m,) their numbers
        low, high : (n,) mm, ends of the cells, each within a facet;  out : (n, n) mm / (N/mm)
        """
        middle = 0.5 * (low + high)
        facet = np.clip(np.searchsorted(self.s, middle, side="right") - 1, 0, len(self.s) - 2)
        share = (middle - self.s[facet]) / (self.s[facet + 1] - self.s[facet])
        shape, cell = np.zeros((len(middle), len(self.s))), np.arange(len(middle))
        shape[cell, facet], shape[cell, facet + 1] = 1.0 - share, share
        cells = [slice(a, b) for a, b in zip(start[:-1], start[1:])]
        for k, of in enumerate(cells):
            for j, by in enumerate(cells):
                out[of, by] += shape[of] @ self.table[line[k], line[j]] @ shape[by].T
