"""Indentation of a flank by its own contact, as far as the elements see it.

The contact of half spaces computes the whole indentation. What of it is in the displacement of the
mesh has to be taken off first. Along z the elements interpolate linearly. A line load acts on them
as its projection onto the hat functions N_k of the layers' nodes. It has the coefficients
w = M^-1 F, of the nodal forces F and M_kl = ∫ N_k N_l dz. In the section the elements yield as the
Green's function G of the contact law says (`swgpar.contact.missing_compliance`). Farther off than a
layer is long they yield as a half space does:

    u_a(z) = sum_bk (G_ab N_k(z) + R_k(s_a - s_b, z) / (pi E')) w_bk,

where R_k is the half space under the hat function N_k without the logarithm that is in G
(`swgpar.contact.layer_half_space`). The forces have images at the ends of the profile, as in G.
"""

from __future__ import annotations

import numpy as np

from swgpar.contact.layer_half_space import under_hats
from swgpar.contact.missing_compliance import MissingCompliance
from swgpar.flank_pressure.flank_loads import overlaps


def indentation(missing: MissingCompliance, z: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Displacement (n_s, n_z) mm of the nodes of a flank into the body by the indentation under
    their forces.

    missing : of the flank;  z : (n_z,) mm, stations of its nodes;  force : (n_s, n_z) N, on the
    nodes, into the body
    """
    load = np.linalg.solve(overlaps(z), force.T).T
    s, (first, last) = missing.s, missing.s[[0, -1]]
    out = missing.green @ load
    for place in (s, 2.0 * first - s, 2.0 * last - s):
        table = under_hats(place[:, None] - s, z)
        out += 0.5 * missing.logarithm * np.einsum("ablk,bk->al", table, load)
    return out
