# cython: language_level=3, boundscheck=False, wraparound=False
"""Cython layer of the element kernels: checks shapes, releases the GIL, calls, raises."""

from typing import NamedTuple

import numpy as np

from libc.stdint cimport int32_t, int64_t, uint8_t


cdef extern from "element_batch.hpp" namespace "swgpar" nogil:
    struct ElementBatch:
        int64_t n
        int64_t nodes
        const double* stiffness
        const double* gradient
        const double* coords
        const int32_t* ref_of
        const double* rotation
        const int32_t* conn
        const uint8_t* sixths
    int64_t assemble8 "swgpar::assemble<8>"(const ElementBatch&, const double* u, double* residual,
                                            const int64_t* slot, double* values, double* energy)
    int64_t assemble4 "swgpar::assemble<4>"(const ElementBatch&, const double* u, double* residual,
                                            const int64_t* slot, double* values, double* energy)
    int64_t assemble_any "swgpar::assemble<Eigen::Dynamic>"(const ElementBatch&, const double* u, double* residual,
                                                           const int64_t* slot, double* values, double* energy)
    int64_t stress8 "swgpar::stress<8>"(const ElementBatch&, const double* recovery, const double* u, double* out)
    int64_t stress4 "swgpar::stress<4>"(const ElementBatch&, const double* recovery, const double* u, double* out)
    int64_t solid "swgpar::reference<swgpar::Hex8i>"(int64_t n, const double* coords, const double* elasticity,
                                                     bint incompatible, double* stiffness, double* recovery,
                                                     double* gradient, double* volume)
    int64_t plane "swgpar::reference<swgpar::Quad4i>"(int64_t n, const double* coords, const double* elasticity,
                                                      bint incompatible, double* stiffness, double* recovery,
                                                      double* gradient, double* volume, double thickness)


class ReferenceElements(NamedTuple):
    """Matrices of undeformed elements of m nodes (8, or 4 in the plane), shared by all congruent ones.

    stiffness : (n, 3 m, 3 m) N/mm;  recovery : (n, 6 m, 3 m) MPa/mm, row 6 * node + component
    gradient : (n, m, 3) 1/mm, at the centre;  coords : (n, m, 3) mm;  volume : (n,) mm^3
    Condensed parts have more nodes, no rows of `recovery`, and the least-squares gradient of their nodes.
    """

    stiffness: np.ndarray
    recovery: np.ndarray
    gradient: np.ndarray
    coords: np.ndarray
    volume: np.ndarray


def reference_elements(coords, elasticity, double thickness=0.0, bint incompatible=True):
    """Matrices of C3D8I-type hexahedra or of CPS4I-type quadrilaterals.

    coords : (n, 8, 3) mm, VTK node order, or (n, 4, 3) at one z, counter-clockwise seen against z
    elasticity : MPa, symmetric, with engineering shear strains: (6, 6) of hexahedra, xx yy zz xy yz zx;
    (3, 3) of quadrilaterals in plane stress, xx yy xy
    thickness : mm, of quadrilaterals
    incompatible : False leaves the incompatible modes out, which gives C3D8 and CPS4, for comparison
    Raises ValueError naming the first element with a non-positive Jacobian.
    """
    cdef double[:, :, ::1] x = np.ascontiguousarray(coords, dtype=np.float64)
    if x.shape[1] not in (4, 8) or x.shape[2] != 3:
        raise ValueError("reference_elements: coords must have shape (n, 8, 3) or (n, 4, 3)")
    if x.shape[1] == 4 and not thickness > 0.0:
        raise ValueError("reference_elements: quadrilaterals need a thickness above 0")
    cdef double[:, ::1] d = np.ascontiguousarray(elasticity, dtype=np.float64)
    cdef int64_t n = x.shape[0], m = x.shape[1], size = 3 if m == 4 else 6, bad
    if d.shape[0] != size or d.shape[1] != size:
        raise ValueError(f"reference_elements: elasticity must have shape ({size}, {size})")
    out = ReferenceElements(np.empty((n, 3 * m, 3 * m)), np.empty((n, 6 * m, 3 * m)), np.empty((n, m, 3)),
                            np.asarray(x), np.empty(n))
    if n == 0:
        return out
    cdef double[:, :, ::1] k = out.stiffness, s = out.recovery, g = out.gradient
    cdef double[::1] v = out.volume
    with nogil:
        if m == 4:
            bad = plane(n, &x[0, 0, 0], &d[0, 0], incompatible, &k[0, 0, 0], &s[0, 0, 0], &g[0, 0, 0], &v[0],
                        thickness)
        else:
            bad = solid(n, &x[0, 0, 0], &d[0, 0], incompatible, &k[0, 0, 0], &s[0, 0, 0], &g[0, 0, 0], &v[0])
    if bad >= 0:
        raise ValueError(f"element {bad} has a non-positive Jacobian determinant")
    return out


cdef ElementBatch batch(const double[:, :, ::1] stiffness, const double[:, :, ::1] gradient,
                        const double[:, :, ::1] coords, const int32_t[::1] ref_of, const double[:, ::1] rotation,
                        const int32_t[:, ::1] conn, const uint8_t[:, ::1] sixths) except *:
    if not (rotation.shape[0] == conn.shape[0] == sixths.shape[0] == ref_of.shape[0] and rotation.shape[1] == 2
            and conn.shape[1] == sixths.shape[1] == coords.shape[1]):
        raise ValueError("element arrays: shapes disagree")
    return ElementBatch(conn.shape[0], conn.shape[1], &stiffness[0, 0, 0], &gradient[0, 0, 0], &coords[0, 0, 0], &ref_of[0],
                        &rotation[0, 0], &conn[0, 0], &sixths[0, 0])


def assemble_elements(ref, const int32_t[::1] ref_of, const double[:, ::1] rotation, const int32_t[:, ::1] conn,
                      const uint8_t[:, ::1] sixths, const double[:, ::1] u, residual, slot, values):
    """Add forces and tangent blocks of corotated elements; returns their strain energy (N mm).

    ref_of : (n,) row of `ref`;  rotation : (n, 2) cosine and sine of the sector's angle
    conn : (n, m) local nodes, -1 fixed;  sixths : (n, m), sixths of a turn by which images are rotated
    u : (n_local, 3) mm;  residual : (n_local, 3) N or None
    slot : (n, m * m) int64 block of each node pair, -1 to skip;  values : (n_blocks, 3, 3) N/mm, entry (k, l) of
    block p at values[p, l, k]; both None to skip the tangent
    Raises ValueError for shapes that disagree, FloatingPointError for an element that has collapsed.
    """
    cdef int64_t bad
    cdef double energy = 0.0
    if conn.shape[0] == 0:
        return 0.0
    cdef ElementBatch e = batch(ref.stiffness, ref.gradient, ref.coords, ref_of, rotation, conn, sixths)
    cdef double[:, ::1] r
    cdef double[:, :, ::1] v
    cdef const int64_t[:, ::1] p
    cdef double* pr = NULL
    cdef double* pv = NULL
    cdef const int64_t* pp = NULL
    if residual is not None:
        r = residual
        pr = &r[0, 0]
    if values is not None:
        v, p = values, slot
        if p.shape[0] != e.n or p.shape[1] != conn.shape[1] * conn.shape[1]:
            raise ValueError("assemble_elements: slot must have a column for each pair of nodes")
        pv, pp = &v[0, 0, 0], &p[0, 0]
    with nogil:
        if conn.shape[1] == 4:
            bad = assemble4(e, &u[0, 0], pr, pp, pv, &energy)
        elif conn.shape[1] == 8:
            bad = assemble8(e, &u[0, 0], pr, pp, pv, &energy)
        else:
            bad = assemble_any(e, &u[0, 0], pr, pp, pv, &energy)
    if bad >= 0:
        raise FloatingPointError(f"element {bad} has collapsed")
    return energy


def recover_stress(ref, const int32_t[::1] ref_of, const double[:, ::1] rotation, const int32_t[:, ::1] conn,
                   const uint8_t[:, ::1] sixths, const double[:, ::1] u):
    """Stress extrapolated to the nodes of each element; (n, m, 6) MPa, global axes, xx yy zz xy yz zx.

    Parameters as for `assemble_elements`. Raises ValueError for shapes that disagree, FloatingPointError for an element
    that has collapsed.
    """
    cdef int64_t bad
    if conn.shape[1] not in (4, 8):
        raise ValueError("recover_stress: elements have 4 or 8 nodes")
    out = np.empty((conn.shape[0], conn.shape[1], 6))
    if conn.shape[0] == 0:
        return out
    cdef ElementBatch e = batch(ref.stiffness, ref.gradient, ref.coords, ref_of, rotation, conn, sixths)
    cdef double[:, :, ::1] o = out, s = ref.recovery
    with nogil:
        if conn.shape[1] == 4:
            bad = stress4(e, &s[0, 0, 0], &u[0, 0], &o[0, 0, 0])
        else:
            bad = stress8(e, &s[0, 0, 0], &u[0, 0], &o[0, 0, 0])
    if bad >= 0:
        raise FloatingPointError(f"element {bad} has collapsed")
    return out
