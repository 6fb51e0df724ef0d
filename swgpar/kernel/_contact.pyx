# cython: language_level=3, boundscheck=False, wraparound=False
"""Cython layer of the contact kernels: checks shapes, releases the GIL, calls."""

import numpy as np

from libc.math cimport cos, sin
from libc.stdint cimport int32_t, int64_t, uint8_t


cdef extern from "<Eigen/Dense>" nogil:
    pass

cdef extern from "contact_batch.hpp" namespace "swgpar" nogil:
    struct FlankBatch:
        int n_patch, n_s, n_z
        const double* s
        const double* z
        const double* point
        const double* tangent
        const double* orientation
        const double* rotation
        double body_cosine, body_sine
        const int32_t* conn
        const uint8_t* sixths
    struct FaceBatch:
        int64_t n_face
        int n_q
        const int32_t* conn
        const uint8_t* sixths
        const double* coords
        const double* normal
        const double* shape
        const double* weight
        const double* offset
        const int32_t* patch
    struct BlockRows:
        const int64_t* start
        const int32_t* column
        double* values
        const int32_t* number
        int64_t n_own
        bint symmetric
    struct Friction:
        double coefficient, stiffness
        const double* foot_point
        const double* gap
        const double* traction
        double* current
        const double* lagged
    int64_t flank_contact(const FlankBatch&, const FaceBatch&, const double* u, const double* multiplier,
                          double penalty, double opening, double reach, double beyond, double limit, const Friction& friction,
                          double* residual, const BlockRows& rows, double* gap, double* pressure, double* foot_point,
                          double* moment)
    int64_t add_blocks(int64_t n, int m, const int32_t* conn, const uint8_t* sixths, const double* blocks,
                       const BlockRows& rows)


OVERHANG = 1e-4
"""Facets by which points in contact may lie past the ends of a flank. Flanks that end at the same z then touch up to
their ends also where elastic deformation moves one end past the other."""


cdef BlockRows rows_of(rows):
    cdef const int64_t[::1] start = rows.start
    cdef const int32_t[::1] column = rows.column, number = rows.number
    cdef double[:, :, ::1] values = rows.values
    return BlockRows(&start[0], &column[0], &values[0, 0, 0], &number[0], rows.n_own, rows.symmetric)


cdef Friction friction_of(law, int64_t n_face, int64_t n_q) except *:
    cdef const double[:, :, ::1] foot_point = law.foot_point, traction = law.traction
    cdef const double[:, ::1] gap = law.gap
    cdef double[:, :, ::1] current = law.current
    for array in (law.foot_point, law.traction, law.gap, law.current, law.gap if law.lagged is None else law.lagged):
        if array.shape[0] != n_face or array.shape[1] != n_q:
            raise ValueError("contact_flanks: arrays of the friction do not have the shape (faces, points)")
    law.current[...] = 0.0  # also at points that were in contact in the last evaluation only
    cdef Friction made = Friction(
        law.coefficient, law.stiffness, &foot_point[0, 0, 0], &gap[0, 0], &traction[0, 0, 0], &current[0, 0, 0], NULL
    )
    cdef const double[:, ::1] lagged
    if law.lagged is not None:
        lagged = law.lagged
        made.lagged = &lagged[0, 0]
    return made


def contact_flanks(patches, faces, const double[:, ::1] u, const double[:, ::1] multiplier, double penalty,
                   double opening, double reach, double limit, double[:, ::1] residual, rows, friction=None,
                   double rotation=0.0, double[::1] moment=None, double beyond=OVERHANG):
    """Gaps, forces and tangent of slave faces against master flanks (kernel/contact.hpp, kernel/friction.hpp).

    Parameters
    ----------
    patches, faces : records of arrays (`swgpar.contact.flanks.Flanks`, `Faces`)
    u : (n_local, 3) mm, displacements
    multiplier : (n_face, n_q) MPa
    penalty : MPa / mm
    opening : mm, added to every gap
    limit : MPa, bound of the pressure in the tangent's geometric term
    reach : mm, points farther from the master surface than this are not in contact
    residual : (n_local, 3) N, added to; None to skip
    rows : record with start, column, values, number, n_own, symmetric; None to skip the tangent
    friction : record of the last converged state, which takes the tractions (`swgpar.contact.friction.Friction`), or None
    rotation : rad, of the master body as a whole
    beyond : facets by which foot points may lie past the ends of the flank, which goes on straight there
    moment : (n_face,) N mm, derivative of the contact's energy with respect to `rotation`, added to with the residual

    Returns
    -------
    gap : (n_face, n_q) mm, +inf where there is no foot point
    pressure : (n_face, n_q) MPa
    foot_point : (n_face, n_q, 2) mm, arc length and z of the foot point on the master, nan where there is none
    missing : number of blocks the pattern lacks

    Raises ValueError for shapes that disagree.
    """
    cdef const double[::1] s = patches.s, z = patches.z, orientation = patches.orientation
    cdef const double[:, :, ::1] point = patches.point, tangent = patches.tangent
    cdef const double[:, ::1] rotations = patches.rotation
    cdef const int32_t[:, :, ::1] pconn = patches.conn
    cdef const uint8_t[:, :, ::1] psixths = patches.sixths
    cdef const int32_t[:, ::1] conn = faces.conn
    cdef const uint8_t[:, ::1] sixths = faces.sixths
    cdef const double[:, :, ::1] coords = faces.coords
    cdef const double[:, ::1] normal = faces.normal, weight = faces.weight, offset = faces.offset
    cdef const double[:, :, ::1] shape = faces.shape
    cdef const int32_t[::1] patch = faces.patch
    cdef int64_t n_face = conn.shape[0], n_q = shape.shape[1], n_patch = pconn.shape[0]
    gap_array = np.full((n_face, n_q), np.inf)
    pressure_array = np.zeros((n_face, n_q))
    foot_point_array = np.full((n_face, n_q, 2), np.nan)
    if n_face == 0 or n_patch == 0:
        return gap_array, pressure_array, foot_point_array, 0
    if not (coords.shape[0] == normal.shape[0] == shape.shape[0] == weight.shape[0] == offset.shape[0] == patch.shape[0] == n_face
            and multiplier.shape[0] == n_face and multiplier.shape[1] == n_q and weight.shape[1] == n_q
            and pconn.shape[1] == s.shape[0] and pconn.shape[2] == z.shape[0] and point.shape[0] == n_patch
            and point.shape[1] == s.shape[0] and tangent.shape[1] == s.shape[0] and u.shape[1] == 3):
        raise ValueError("contact_flanks: array shapes disagree")
    cdef double[:, ::1] gap = gap_array, pressure = pressure_array
    cdef double[:, :, ::1] foot_point = foot_point_array
    cdef FlankBatch p = FlankBatch(n_patch, s.shape[0] - 1, z.shape[0] - 1, &s[0], &z[0], &point[0, 0, 0],
                                   &tangent[0, 0, 0], &orientation[0], &rotations[0, 0], cos(rotation), sin(rotation),
                                   &pconn[0, 0, 0], &psixths[0, 0, 0])
    cdef FaceBatch f = FaceBatch(n_face, n_q, &conn[0, 0], &sixths[0, 0], &coords[0, 0, 0], &normal[0, 0],
                                 &shape[0, 0, 0], &weight[0, 0], &offset[0, 0], &patch[0])
    cdef int64_t missing
    cdef BlockRows r = BlockRows(NULL, NULL, NULL, NULL, 0, True)
    cdef Friction law = Friction(0.0, 0.0, NULL, NULL, NULL, NULL, NULL)
    if rows is not None:
        r = rows_of(rows)
    if friction is not None:
        law = friction_of(friction, n_face, n_q)
    cdef double* p_residual = NULL
    if residual is not None:
        p_residual = &residual[0, 0]
    cdef double[::1] moments = np.zeros(n_face) if moment is None else moment
    if moments.shape[0] != n_face:
        raise ValueError("contact_flanks: moment must have an entry for each face")
    with nogil:
        missing = flank_contact(p, f, &u[0, 0], &multiplier[0, 0], penalty, opening, reach, beyond, limit, law, p_residual, r,
                                &gap[0, 0], &pressure[0, 0], &foot_point[0, 0, 0], &moments[0])
    return gap_array, pressure_array, foot_point_array, missing


def add_face_blocks(const int32_t[:, ::1] conn, const uint8_t[:, ::1] sixths, const double[:, :, :, :, ::1] blocks, rows):
    """Add dense blocks (n, m, m, 3, 3), N/mm, of nodes conn (n, m) to the owned rows of a tangent.

    sixths : (n, m), sixths of a turn by which images are rotated;  rows : record as for `contact_flanks`
    Returns the number of blocks that the pattern lacks. Raises ValueError for shapes that disagree.
    """
    cdef int64_t n = conn.shape[0], missing
    cdef BlockRows r = rows_of(rows)
    cdef int m = conn.shape[1]
    if not (sixths.shape[0] == n and sixths.shape[1] == m and blocks.shape[0] == n and blocks.shape[1] == m
            and blocks.shape[2] == m and blocks.shape[3] == 3 and blocks.shape[4] == 3):
        raise ValueError("add_face_blocks: array shapes disagree")
    if n == 0:
        return 0
    with nogil:
        missing = add_blocks(n, m, &conn[0, 0], &sixths[0, 0], &blocks[0, 0, 0, 0, 0], r)
    return missing
