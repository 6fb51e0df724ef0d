# cython: language_level=3, boundscheck=False, wraparound=False
"""Cython layer of the element kernels: checks arrays, releases the GIL, calls, raises."""

from typing import NamedTuple

from libc.stdint cimport int32_t, int64_t, uint8_t

include "arrays.pxi"


cdef extern from "element_batch.hpp" namespace "swgpar" nogil:
    struct ElementBatch:
        int64_t n
        int64_t nodes
        const double* stiffness
        const double* gradient
        const double* coords
        const double* stress_free
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
    gradient : (n, m, 3) 1/mm, at the centre;  volume : (n,) mm^3
    coords : (n, m, 3) mm, from which displacements count;  stress_free : (n, m, 3) mm, nodes of the stress-free element
    Condensed parts have more nodes, no rows of `recovery`, and the least-squares gradient of their nodes.
    """

    stiffness: np.ndarray
    recovery: np.ndarray
    gradient: np.ndarray
    coords: np.ndarray
    stress_free: np.ndarray
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
    name = "reference_elements"
    coords = np.ascontiguousarray(coords, dtype=DOUBLE)
    cdef int64_t m = 4 if coords.ndim == 3 and coords.shape[1] == 4 else 8, size = 3 if m == 4 else 6, bad
    cdef const double[:, :, ::1] x = checked(name, "coords", coords, DOUBLE, (ANY, m, 3))
    elasticity = np.ascontiguousarray(elasticity, dtype=DOUBLE)
    cdef const double[:, ::1] d = checked(name, "elasticity", elasticity, DOUBLE, (size, size))
    cdef int64_t n = x.shape[0]
    if m == 4 and not thickness > 0.0:
        raise ValueError(f"{name}: thickness is {thickness}; expected a thickness above 0 of quadrilaterals")
    out = ReferenceElements(np.empty((n, 3 * m, 3 * m)), np.empty((n, 6 * m, 3 * m)), np.empty((n, m, 3)),
                            coords, coords, np.empty(n))
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


cdef ElementBatch batch(str function, ref, ref_of, rotation, conn, sixths, nodes, int64_t n_local) except *:
    """Elements whose indices lie within the arrays. nodes : of an element, or ANY"""
    cdef const int32_t[:, ::1] node = indices(function, "conn", conn, INT32, (ANY, nodes), None, n_local)
    cdef int64_t n = node.shape[0], m = node.shape[1]
    cdef const uint8_t[:, ::1] image = indices(function, "sixths", sixths, UINT8, (n, m), None, SIXTHS)
    cdef const double[:, ::1] turn = checked(function, "rotation", rotation, DOUBLE, (n, 2))
    cdef const double[:, :, ::1] stiffness = checked(function, "ref.stiffness", ref.stiffness, DOUBLE, (ANY, 3 * m, 3 * m))
    cdef int64_t n_ref = stiffness.shape[0]
    cdef const double[:, :, ::1] gradient = checked(function, "ref.gradient", ref.gradient, DOUBLE, (n_ref, m, 3))
    cdef const double[:, :, ::1] coords = checked(function, "ref.coords", ref.coords, DOUBLE, (n_ref, m, 3))
    cdef const double[:, :, ::1] free = checked(function, "ref.stress_free", ref.stress_free, DOUBLE, (n_ref, m, 3))
    cdef const int32_t[::1] row = indices(function, "ref_of", ref_of, INT32, (n,), 0, n_ref)
    return ElementBatch(
        n, m, &stiffness[0, 0, 0], &gradient[0, 0, 0], &coords[0, 0, 0], &free[0, 0, 0], &row[0], &turn[0, 0],
        &node[0, 0], &image[0, 0]
    )


def assemble_elements(ref, ref_of, rotation, conn, sixths, u, residual, slot, values):
    """Add forces and tangent blocks of corotated elements; returns their strain energy (N mm).

    ref : ReferenceElements;  ref_of : (n,) row of `ref`;  rotation : (n, 2) cosine and sine of the sector's angle
    conn : (n, m) local nodes, -1 fixed;  sixths : (n, m), sixths of a turn by which images are rotated
    u : (n_local, 3) mm;  residual : (n_local, 3) N or None
    slot : (n, m * m) int64 block of each node pair, -1 to skip;  values : (n_blocks, 3, 3) N/mm, entry (k, l) of
    block p at values[p, l, k]; both None to skip the tangent
    Raises ValueError for arrays that do not fit each other, FloatingPointError for an element that has collapsed.
    """
    name = "assemble_elements"
    cdef const double[:, ::1] displacement = checked(name, "u", u, DOUBLE, (ANY, 3))
    cdef int64_t n_local = displacement.shape[0], bad
    cdef ElementBatch e = batch(name, ref, ref_of, rotation, conn, sixths, ANY, n_local)
    cdef double energy = 0.0
    cdef double[:, ::1] r
    cdef double[:, :, ::1] v
    cdef const int64_t[:, ::1] p
    cdef double* pr = NULL
    cdef double* pv = NULL
    cdef const int64_t* pp = NULL
    if residual is not None:
        r = checked(name, "residual", residual, DOUBLE, (n_local, 3), True)
        pr = &r[0, 0]
    if values is not None:
        v = checked(name, "values", values, DOUBLE, (ANY, 3, 3), True)
        p = indices(name, "slot", slot, INT64, (e.n, e.nodes * e.nodes), None, v.shape[0])
        pv, pp = &v[0, 0, 0], &p[0, 0]
    with nogil:
        if e.nodes == 4:
            bad = assemble4(e, &displacement[0, 0], pr, pp, pv, &energy)
        elif e.nodes == 8:
            bad = assemble8(e, &displacement[0, 0], pr, pp, pv, &energy)
        else:
            bad = assemble_any(e, &displacement[0, 0], pr, pp, pv, &energy)
    if bad >= 0:
        raise FloatingPointError(f"element {bad} has collapsed")
    return energy


def recover_stress(ref, ref_of, rotation, conn, sixths, u):
    """Stress extrapolated to the nodes of each element; (n, m, 6) MPa, global axes, xx yy zz xy yz zx.

    Parameters as for `assemble_elements`, of elements with 4 or 8 nodes. Raises ValueError for arrays that do not fit
    each other, FloatingPointError for an element that has collapsed.
    """
    name = "recover_stress"
    cdef const double[:, ::1] displacement = checked(name, "u", u, DOUBLE, (ANY, 3))
    cdef int64_t m = 4 if np.shape(conn)[1:] == (4,) else 8, bad
    cdef ElementBatch e = batch(name, ref, ref_of, rotation, conn, sixths, m, displacement.shape[0])
    cdef const double[:, :, ::1] s = checked(
        name, "ref.recovery", ref.recovery, DOUBLE, (ref.stiffness.shape[0], 6 * m, 3 * m)
    )
    out = np.empty((e.n, m, 6))
    cdef double[:, :, ::1] o = out
    with nogil:
        if m == 4:
            bad = stress4(e, &s[0, 0, 0], &displacement[0, 0], &o[0, 0, 0])
        else:
            bad = stress8(e, &s[0, 0, 0], &displacement[0, 0], &o[0, 0, 0])
    if bad >= 0:
        raise FloatingPointError(f"element {bad} has collapsed")
    return out
