# cython: language_level=3, boundscheck=False, wraparound=False
"""Cython layer of the contact kernels: checks arrays, releases the GIL, calls."""

from libc.math cimport cos, sin
from libc.stdint cimport int32_t, int64_t, uint8_t

include "arrays.pxi"


cdef extern from "<Eigen/Dense>" nogil:
    pass

cdef extern from "contact_batch.hpp" namespace "swgpar" nogil:
    struct FlankBatch:
        int n_patch, n_s, n_z
        const double* s
        const double* z
        const double* point
        const double* tangent
        const double* bulge
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
        double coefficient
        const double* stiffness
        const double* foot_point
        const double* gap
        const double* traction
        double* current
        const double* lagged
    struct MissingCompliance:
        int n_node
        const double* s
        const double* green
        double logarithm
    void add_missing_compliance(const MissingCompliance&, int n, const double* low, const double* high, double* out)
    struct GapGradients:
        int32_t* conn
        uint8_t* sixths
        double* vector
        double* friction
    int64_t flank_contact(const FlankBatch&, const FaceBatch&, const double* u, const double* multiplier,
                          double penalty, double opening, double reach, double beyond, double limit, const Friction& friction,
                          double* residual, const BlockRows& rows, double* gap, double* pressure, double* foot_point,
                          double* moment, const GapGradients& gradients)
    int64_t add_line_tangents(int64_t n_line, const int64_t* start, int n_node, const int32_t* conn,
                              const uint8_t* sixths, const double* left, const double* right, const double* stiffness,
                              const BlockRows& rows)
    int64_t add_blocks(int64_t n, int m, const int32_t* conn, const uint8_t* sixths, const double* blocks,
                       const BlockRows& rows)


OVERHANG = 1e-4
"""Facets by which points in contact may lie past the ends of a flank. Flanks that end at the same z then touch up to
their ends also where elastic deformation moves one end past the other."""


cdef BlockRows rows_of(str function, rows, n_local) except *:
    """Rows whose pattern lies within their arrays. n_local : local nodes, ANY where the rows alone know them"""
    cdef int64_t n_own = rows.n_own
    number_array = checked(function, "rows.number", rows.number, INT32, (n_local,))
    if not 0 <= n_own <= number_array.shape[0]:
        raise ValueError(f"{function}: rows.n_own is {n_own}; expected from 0 to the {number_array.shape[0]} local nodes")
    column_array = checked(function, "rows.column", rows.column, INT32, (ANY,))
    cdef int64_t n_block = column_array.shape[0]
    cdef const int64_t[::1] start = checked(function, "rows.start", rows.start, INT64, (n_own + 1,))
    cdef const int32_t[::1] column = column_array, number = number_array
    cdef double[:, :, ::1] values = checked(function, "rows.values", rows.values, DOUBLE, (n_block, 3, 3), True)
    cdef int64_t k
    cdef bint ascends = start[0] == 0 and start[n_own] == n_block
    for k in range(n_own):
        ascends &= start[k] <= start[k + 1]
    if not ascends:
        raise ValueError(f"{function}: rows.start ({n_own + 1},) is out of order; expected to ascend from 0 to the {n_block} blocks")
    return BlockRows(&start[0], &column[0], &values[0, 0, 0], &number[0], n_own, rows.symmetric)


cdef Friction friction_of(str function, law, int64_t n_face, int64_t n_q) except *:
    cdef tuple vectors = (n_face, n_q, 2), scalars = (n_face, n_q)
    cdef const double[:, :, ::1] foot_point = checked(function, "friction.foot_point", law.foot_point, DOUBLE, vectors)
    cdef const double[:, :, ::1] traction = checked(function, "friction.traction", law.traction, DOUBLE, vectors)
    cdef const double[:, ::1] gap = checked(function, "friction.gap", law.gap, DOUBLE, scalars)
    cdef const double[:, ::1] stiffness = checked(function, "friction.stiffness", law.stiffness, DOUBLE, scalars)
    cdef double[:, :, ::1] current = checked(function, "friction.current", law.current, DOUBLE, vectors, True)
    cdef Friction made = Friction(
        law.coefficient, &stiffness[0, 0], &foot_point[0, 0, 0], &gap[0, 0], &traction[0, 0, 0], &current[0, 0, 0], NULL
    )
    cdef const double[:, ::1] lagged
    if law.lagged is not None:
        lagged = checked(function, "friction.lagged", law.lagged, DOUBLE, scalars)
        made.lagged = &lagged[0, 0]
    law.current[...] = 0.0  # also at points that were in contact in the last evaluation only
    return made


cdef GapGradients gradients_of(str function, record, int64_t n_face, int64_t n_q) except *:
    cdef tuple shape = (n_face, n_q, 8)
    cdef int32_t[:, :, ::1] conn = checked(function, "gradients.conn", record.conn, INT32, shape, True)
    cdef uint8_t[:, :, ::1] sixths = checked(function, "gradients.sixths", record.sixths, UINT8, shape, True)
    cdef double[:, :, :, ::1] vector = checked(function, "gradients.vector", record.vector, DOUBLE, (*shape, 3), True)
    cdef double[:, :, :, ::1] force = checked(function, "gradients.friction", record.friction, DOUBLE, (*shape, 3), True)
    return GapGradients(&conn[0, 0, 0], &sixths[0, 0, 0], &vector[0, 0, 0, 0], &force[0, 0, 0, 0])


def contact_flanks(patches, faces, u, multiplier, double penalty, double opening, double reach, double limit, residual,
                   rows, friction=None, double rotation=0.0, moment=None, double beyond=OVERHANG, gradients=None):
    """Gaps, forces and tangent of slave faces against master flanks (kernel/contact.hpp, kernel/friction.hpp).

    Parameters
    ----------
    patches, faces : records of arrays (`swgpar.contact.flank_pairs.MasterFlanks`, `Faces`)
    u : (n_local, 3) mm, displacements
    multiplier : (n_face, n_q) MPa
    penalty : MPa / mm
    opening : mm, added to every gap
    reach : mm, points farther from the master surface than this are not in contact
    limit : MPa, bound of the pressure in the tangent's geometric term
    residual : (n_local, 3) N, added to; None to skip
    rows : record with start, column, values, number, n_own, symmetric; None to skip the tangent
    friction : record of the last converged state, which takes the tractions (`swgpar.contact.friction.Friction`), or None
    rotation : rad, of the master body as a whole
    moment : (n_face,) N mm, derivative of the contact's energy with respect to `rotation`, added to with the residual
    beyond : facets by which foot points may lie past the ends of the flank, which goes on straight there
    gradients : record that takes the gradients of the gaps (`swgpar.contact.flank_pairs.GapGradients`), or None

    Returns
    -------
    gap : (n_face, n_q) mm, +inf where there is no foot point
    pressure : (n_face, n_q) MPa
    foot_point : (n_face, n_q, 2) mm, arc length and z of the foot point on the master, nan where there is none
    missing : number of blocks the pattern lacks

    Raises ValueError for arrays that do not fit each other.
    """
    name = "contact_flanks"
    cdef const double[:, ::1] uv = checked(name, "u", u, DOUBLE, (ANY, 3))
    cdef int64_t n_local = uv.shape[0]

    cdef const int32_t[:, :, ::1] pconn = indices(name, "patches.conn", patches.conn, INT32, (ANY, ANY, ANY), None, n_local)
    cdef int64_t n_patch = pconn.shape[0], n_s = pconn.shape[1], n_z = pconn.shape[2]
    if n_s < 2 or n_z < 2:
        raise ValueError(f"{name}: patches.conn is ({n_patch}, {n_s}, {n_z}); expected 2 nodes or more per direction")
    cdef const uint8_t[:, :, ::1] psixths = indices(
        name, "patches.sixths", patches.sixths, UINT8, (n_patch, n_s, n_z), None, SIXTHS
    )
    cdef const double[::1] s = checked(name, "patches.s", patches.s, DOUBLE, (n_s,))
    cdef const double[::1] z = checked(name, "patches.z", patches.z, DOUBLE, (n_z,))
    cdef const double[:, :, ::1] point = checked(name, "patches.point", patches.point, DOUBLE, (n_patch, n_s, 2))
    cdef const double[:, :, ::1] tangent = checked(name, "patches.tangent", patches.tangent, DOUBLE, (n_patch, n_s, 2))
    cdef const double[:, :, :, ::1] bulge = checked(name, "patches.bulge", patches.bulge, DOUBLE, (n_patch, n_s - 1, 4, 2))
    cdef const double[::1] orientation = checked(name, "patches.orientation", patches.orientation, DOUBLE, (n_patch,))
    cdef const double[:, ::1] rotations = checked(name, "patches.rotation", patches.rotation, DOUBLE, (n_patch, 2))

    cdef const int32_t[:, ::1] conn = indices(name, "faces.conn", faces.conn, INT32, (ANY, 4), None, n_local)
    cdef int64_t n_face = conn.shape[0]
    cdef const double[:, :, ::1] shape = checked(name, "faces.shape", faces.shape, DOUBLE, (n_face, ANY, 4))
    cdef int64_t n_q = shape.shape[1]
    cdef tuple points = (n_face, n_q)
    cdef const uint8_t[:, ::1] sixths = indices(name, "faces.sixths", faces.sixths, UINT8, (n_face, 4), None, SIXTHS)
    cdef const double[:, :, ::1] coords = checked(name, "faces.coords", faces.coords, DOUBLE, (n_face, 4, 3))
    cdef const double[:, ::1] normal = checked(name, "faces.normal", faces.normal, DOUBLE, (n_face, 3))
    cdef const double[:, ::1] weight = checked(name, "faces.weight", faces.weight, DOUBLE, points)
    cdef const double[:, ::1] offset = checked(name, "faces.offset", faces.offset, DOUBLE, points)
    cdef const int32_t[::1] patch = indices(name, "faces.patch", faces.patch, INT32, (n_face,), 0, n_patch)
    cdef const double[:, ::1] multipliers = checked(name, "multiplier", multiplier, DOUBLE, points)

    cdef BlockRows r = BlockRows(NULL, NULL, NULL, NULL, 0, True)
    if rows is not None:
        r = rows_of(name, rows, n_local)
    cdef Friction law = Friction(0.0, NULL, NULL, NULL, NULL, NULL, NULL)
    if friction is not None:
        law = friction_of(name, friction, n_face, n_q)
    cdef GapGradients g = GapGradients(NULL, NULL, NULL, NULL)
    if gradients is not None and n_face and n_q:
        g = gradients_of(name, gradients, n_face, n_q)
    cdef double[:, ::1] residuals
    cdef double* p_residual = NULL
    if residual is not None:
        residuals = checked(name, "residual", residual, DOUBLE, (n_local, 3), True)
        p_residual = &residuals[0, 0]
    if moment is None:
        moment = np.zeros(n_face)
    cdef double[::1] moments = checked(name, "moment", moment, DOUBLE, (n_face,), True)

    gap_array = np.full(points, np.inf)
    pressure_array = np.zeros(points)
    foot_point_array = np.full((n_face, n_q, 2), np.nan)
    if n_face == 0:
        return gap_array, pressure_array, foot_point_array, 0
    cdef double[:, ::1] gap = gap_array, pressure = pressure_array
    cdef double[:, :, ::1] foot_point = foot_point_array
    cdef FlankBatch p = FlankBatch(n_patch, n_s - 1, n_z - 1, &s[0], &z[0], &point[0, 0, 0], &tangent[0, 0, 0],
                                   &bulge[0, 0, 0, 0],
                                   &orientation[0], &rotations[0, 0], cos(rotation), sin(rotation), &pconn[0, 0, 0],
                                   &psixths[0, 0, 0])
    cdef FaceBatch f = FaceBatch(n_face, n_q, &conn[0, 0], &sixths[0, 0], &coords[0, 0, 0], &normal[0, 0],
                                 &shape[0, 0, 0], &weight[0, 0], &offset[0, 0], &patch[0])
    cdef int64_t missing
    with nogil:
        missing = flank_contact(p, f, &uv[0, 0], &multipliers[0, 0], penalty, opening, reach, beyond, limit, law,
                                p_residual, r, &gap[0, 0], &pressure[0, 0], &foot_point[0, 0, 0], &moments[0], g)
    return gap_array, pressure_array, foot_point_array, missing


def add_face_blocks(conn, sixths, blocks, rows):
    """Add dense blocks (n, m, m, 3, 3), N/mm, of nodes conn (n, m) to the owned rows of a tangent.

    sixths : (n, m), sixths of a turn by which images are rotated;  rows : record as for `contact_flanks`
    Returns the number of blocks that the pattern lacks. Raises ValueError for arrays that do not fit each other.
    """
    name = "add_face_blocks"
    cdef BlockRows r = rows_of(name, rows, ANY)
    cdef const int32_t[:, ::1] nodes = indices(name, "conn", conn, INT32, (ANY, ANY), None, rows.number.shape[0])
    cdef int64_t n = nodes.shape[0], m = nodes.shape[1], missing
    cdef const uint8_t[:, ::1] images = indices(name, "sixths", sixths, UINT8, (n, m), None, SIXTHS)
    cdef const double[:, :, :, :, ::1] dense = checked(name, "blocks", blocks, DOUBLE, (n, m, m, 3, 3))
    if n == 0:
        return 0
    with nogil:
        missing = add_blocks(n, m, &nodes[0, 0], &images[0, 0], &dense[0, 0, 0, 0, 0], r)
    return missing


def add_line_compliances(start, low, high, missing, out):
    """Add what a body's elements lack in compliance among the cells of lines (kernel/contact_lines.hpp).

    start : (n_line + 1,) int64, first cell of each line, ascending from 0 to the number of cells
    low, high : (n_cell,) mm, ends of the cells on the flank, each within a facet
    missing : record with s, green, logarithm (`swgpar.contact.missing_compliance.MissingCompliance`)
    out : (n,) mm / (N/mm), the matrices (cells, cells) of the lines, one after the other; added to

    Raises ValueError for arrays that do not fit each other.
    """
    name = "add_line_compliances"
    cdef const double[::1] left = checked(name, "low", low, DOUBLE, (ANY,))
    cdef const double[::1] right = checked(name, "high", high, DOUBLE, (left.shape[0],))
    cdef const int64_t[::1] first = line_starts(name, start, left.shape[0])
    cdef int64_t n_line = first.shape[0] - 1, k, n, size = 0
    for k in range(n_line):
        size += (first[k + 1] - first[k]) ** 2
    cdef double[::1] values = checked(name, "out", out, DOUBLE, (size,), True)
    cdef const double[::1] s = checked(name, "missing.s", missing.s, DOUBLE, (ANY,))
    cdef int64_t n_node = s.shape[0]
    cdef const double[:, ::1] green = checked(name, "missing.green", missing.green, DOUBLE, (n_node, n_node))
    if n_node < 2:
        raise ValueError(f"{name}: missing.s is ({n_node},); expected 2 nodes or more")
    cdef MissingCompliance m = MissingCompliance(n_node, &s[0], &green[0, 0], missing.logarithm)
    if size == 0:
        return
    size = 0
    with nogil:
        for k in range(n_line):
            n = first[k + 1] - first[k]
            if n > 0:
                add_missing_compliance(m, n, &left[first[k]], &right[first[k]], &values[size])
                size += n * n


cdef const int64_t[::1] line_starts(str function, start, int64_t n_cell):
    """First cells of lines, checked."""
    cdef const int64_t[::1] first = checked(function, "start", start, INT64, (ANY,))
    cdef int64_t n_line = first.shape[0] - 1, k
    cdef bint ascends = n_line >= 0 and first[0] == 0 and first[n_line] == n_cell
    for k in range(n_line):
        ascends &= first[k] <= first[k + 1]
    if not ascends:
        raise ValueError(f"{function}: start ({n_line + 1},) is out of order; expected to ascend from 0 to the {n_cell} cells")
    return first


def add_contact_lines(start, conn, sixths, left, right, stiffness, rows):
    """Add the tangents of lines of contact to the owned rows (kernel/contact_lines.hpp).

    start : (n_line + 1,) int64, first cell of each line, ascending from 0 to the number of cells
    conn, sixths : (n_cell, m) local nodes, -1 without unknowns, and sixths of a turn by which images are rotated
    left, right : (n_cell, m, 3), gradients of the cells' forces and gaps by the nodes
    stiffness : (n,) N/mm, the matrices (cells, cells) of the lines, one after the other
    rows : record as for `contact_flanks`

    Returns the number of blocks that the pattern lacks. Raises ValueError for arrays that do not fit each other.
    """
    name = "add_contact_lines"
    cdef BlockRows r = rows_of(name, rows, ANY)
    cdef const int32_t[:, ::1] nodes = indices(name, "conn", conn, INT32, (ANY, ANY), None, rows.number.shape[0])
    cdef int64_t n_cell = nodes.shape[0], m = nodes.shape[1], k, size = 0, missing
    cdef const uint8_t[:, ::1] images = indices(name, "sixths", sixths, UINT8, (n_cell, m), None, SIXTHS)
    cdef const double[:, :, ::1] g = checked(name, "left", left, DOUBLE, (n_cell, m, 3))
    cdef const double[:, :, ::1] h = checked(name, "right", right, DOUBLE, (n_cell, m, 3))
    cdef const int64_t[::1] first = line_starts(name, start, n_cell)
    cdef int64_t n_line = first.shape[0] - 1
    for k in range(n_line):
        size += (first[k + 1] - first[k]) ** 2
    cdef const double[::1] s = checked(name, "stiffness", stiffness, DOUBLE, (size,))
    if n_cell == 0 or m == 0:
        return 0
    with nogil:
        missing = add_line_tangents(n_line, &first[0], m, &nodes[0, 0], &images[0, 0], &g[0, 0, 0], &h[0, 0, 0], &s[0], r)
    return missing
