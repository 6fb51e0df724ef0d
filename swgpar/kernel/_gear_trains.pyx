# cython: language_level=3, boundscheck=False, wraparound=False
"""Cython layer of the gear trains' kernels: checks shapes, releases the GIL, calls."""

import numpy as np

from libc.stdint cimport int64_t


cdef extern from "<Eigen/Dense>" nogil:
    pass

cdef extern from "gearbox.hpp" namespace "swgpar" nogil:
    struct Mesh:
        int64_t driver, driven
        double stiffness, variation, gap_A, gap_B, damping, radius, module
    struct MeshError:
        double amplitude, phase, tooth_phase
    struct Shaft:
        int64_t first, second
        double first_radius, second_radius, stiffness, initial, end, damping
    struct Gearbox:
        const Mesh* meshes
        const Shaft* shafts
        const double* mass
        double ramp, generator
        bint braked
    cppclass GearMatrix:
        GearMatrix()
        double* data()
    int kGears, kMeshes, kShafts
    void internal_forces(const Gearbox& box, const MeshError* errors, const double* x, const double* v, double* force,
                         GearMatrix* stiffness, GearMatrix* damping)
    void shaft_torques(const Gearbox& box, const double* x, const double* v, double* torque)
    int64_t simulate(const Gearbox& box, const MeshError* errors, const double* rack, int64_t n, double h, double* x,
                     double* v, double* torque)

cdef extern from "planetary.hpp" namespace "swgpar" nogil:
    struct TrainSteps:
        int64_t modes, meshes
        double h, half
        const double* of_q
        const double* of_y
        const double* of_torque
        const double* scale
        const double* ways
        const double* give
        const double* damping
    struct MeshLaw:
        const double* solve
        const double* spring
        const double* constant
        const double* sides
    int kMaxTrainMeshes
    int64_t advance_train(const TrainSteps& t, const MeshLaw& law, int64_t first, int64_t count, int64_t states,
                          const double* torques, double* q, double* y, double* push)


MESH = np.dtype([("driver", "i8"), ("driven", "i8"), *((name, "f8") for name in (
    "stiffness", "variation", "gap_A", "gap_B", "damping", "radius", "module"))])
MESH_ERROR = np.dtype([(name, "f8") for name in ("amplitude", "phase", "tooth_phase")])
SHAFT = np.dtype([("first", "i8"), ("second", "i8"), *((name, "f8") for name in (
    "first_radius", "second_radius", "stiffness", "initial", "end", "damping"))])


cdef class GearboxKernel:
    """A cascade gearbox with given meshes and shafts.

    Parameters
    ----------
    mass : (23,) float64, kg
    meshes : (18,) MESH
    shafts : (11,) SHAFT, the flexible units first
    ramp : approach over which the damping of a mesh sets in, m
    generator : force over velocity of the last gear, N·s/m
    braked : the last gear is held
    """

    cdef const double[::1] mass
    cdef const Mesh[::1] meshes
    cdef const Shaft[::1] shafts
    cdef Gearbox box

    def __init__(self, const double[::1] mass, const Mesh[::1] meshes, const Shaft[::1] shafts, double ramp,
                 double generator, bint braked):
        if mass.shape[0] != kGears or meshes.shape[0] != kMeshes or shafts.shape[0] != kShafts:
            raise ValueError("GearboxKernel: wrong number of gears, meshes or shafts")
        cdef int64_t k
        for k in range(kMeshes):
            if not (0 <= meshes[k].driver < kGears and 0 <= meshes[k].driven < kGears):
                raise ValueError("GearboxKernel: a mesh has no such gear")
        for k in range(kShafts):
            if not (0 <= shafts[k].first < kGears and 0 <= shafts[k].second < kGears):
                raise ValueError("GearboxKernel: a shaft has no such gear")
        self.mass, self.meshes, self.shafts = mass, meshes, shafts
        self.box = Gearbox(&meshes[0], &shafts[0], &mass[0], ramp, generator, braked)

    def forces(self, const MeshError[::1] errors, const double[::1] x, const double[::1] v):
        """Forces (23,) in N that have to be overcome at ways x (m) and velocities v (m/s)."""
        self._check(errors.shape[0], x.shape[0], v.shape[0])
        force = np.empty(kGears)
        cdef double[::1] out = force
        with nogil:
            internal_forces(self.box, &errors[0], &x[0], &v[0], &out[0], NULL, NULL)
        return force

    def matrices(self, const MeshError[::1] errors, const double[::1] x, const double[::1] v):
        """Stiffness (N/m) and damping (N·s/m), (23, 23), symmetric."""
        self._check(errors.shape[0], x.shape[0], v.shape[0])
        cdef double[::1] force = np.empty(kGears)
        cdef GearMatrix stiffness, damping
        internal_forces(self.box, &errors[0], &x[0], &v[0], &force[0], &stiffness, &damping)
        shape = (kGears, kGears)
        return (np.array(<double[:kGears * kGears]>stiffness.data()).reshape(shape),
                np.array(<double[:kGears * kGears]>damping.data()).reshape(shape))

    def torques(self, const double[:, ::1] x, const double[:, ::1] v):
        """Torques (n, 11) in N·m of all shafts at ways and velocities (n, 23)."""
        cdef int64_t k, n = x.shape[0]
        self._check(kMeshes, x.shape[1], v.shape[1])
        if v.shape[0] != n:
            raise ValueError("GearboxKernel: not as many velocities as ways")
        torque = np.empty((n, kShafts))
        cdef double[:, ::1] out = torque
        for k in range(n):
            shaft_torques(self.box, &x[k, 0], &v[k, 0], &out[k, 0])
        return torque

    def simulate(self, const MeshError[::1] errors, const double[::1] rack, double h, double[::1] x, double[::1] v):
        """Move x and v on under rack forces at the ends of all steps, (n + 1,) N, h apart.

        Returns the torques of all shafts, N·m, after every step that converged: (m, 11), m = n if all did.
        """
        self._check(errors.shape[0], x.shape[0], v.shape[0])
        cdef int64_t n = rack.shape[0] - 1, done
        if n < 1:
            raise ValueError("GearboxKernel: no step")
        torque = np.empty((n, kShafts))
        cdef double[:, ::1] out = torque
        with nogil:
            done = simulate(self.box, &errors[0], &rack[0], n, h, &x[0], &v[0], &out[0, 0])
        return torque[:done]

    def _check(self, int64_t errors, int64_t x, int64_t v):
        if errors != kMeshes or x != kGears or v != kGears:
            raise ValueError("GearboxKernel: wrong number of errors, ways or velocities")


cdef class TrainKernel:
    """All steps of a planetary gear train; swgpar/gear_trains/planetary/steps.py has the equations.

    Parameters
    ----------
    h : step, s;  half : half backlash, m
    of_q, of_y, of_torque, scale : (modes,) float64
    ways : (steps + 1, meshes, modes);  give : (steps + 1, meshes, meshes);  damping : (meshes,)
    """

    cdef const double[::1] of_q, of_y, of_torque, scale, damping
    cdef const double[:, :, ::1] ways, give
    cdef TrainSteps steps

    def __init__(self, double h, double half, const double[::1] of_q, const double[::1] of_y,
                 const double[::1] of_torque, const double[::1] scale, const double[:, :, ::1] ways,
                 const double[:, :, ::1] give, const double[::1] damping):
        cdef int64_t n = ways.shape[2], m = ways.shape[1]
        if not 0 < m <= kMaxTrainMeshes or damping.shape[0] != m:
            raise ValueError("TrainKernel: wrong number of meshes")
        if of_q.shape[0] != n or of_y.shape[0] != n or of_torque.shape[0] != n or scale.shape[0] != n:
            raise ValueError("TrainKernel: wrong number of modes")
        if give.shape[0] != ways.shape[0] or give.shape[1] != m or give.shape[2] != m:
            raise ValueError("TrainKernel: not as many matrices as ways")
        self.of_q, self.of_y, self.of_torque, self.scale = of_q, of_y, of_torque, scale
        self.ways, self.give, self.damping = ways, give, damping
        self.steps = TrainSteps(n, m, h, half, &of_q[0], &of_y[0], &of_torque[0], &scale[0], &ways[0, 0, 0],
                                &give[0, 0, 0], &damping[0])

    def advance(self, int64_t first, double[:, ::1] q, double[:, ::1] y, double[:, ::1] push,
                const double[:, ::1] torques, const double[:, :, ::1] solve, const double[:, ::1] spring,
                const double[:, ::1] constant, const double[::1] sides=None):
        """Move states q, y, push (modes, states) on by the steps after number `first`, one for each row of torques.

        torques : (count, states) N·m, those at start and end of each step added up
        solve : (count, meshes, meshes);  spring, constant : (count, meshes), force = spring way + constant
        sides : (meshes,) 1 or -1, the flanks that this law holds on; None for meshes without backlash

        Returns in how many steps of how many states some mesh did not touch on its side, or minus the number of the
        step that did not converge.
        """
        cdef int64_t n = self.steps.modes, m = self.steps.meshes, count = torques.shape[0], states = q.shape[1], lost
        if first < 0 or first + count >= self.ways.shape[0] or count < 1 or states < 1:
            raise ValueError("TrainKernel: no such steps or no states")
        if q.shape[0] != n or y.shape[0] != n or push.shape[0] != n:
            raise ValueError("TrainKernel: wrong number of modes")
        if y.shape[1] != states or push.shape[1] != states or torques.shape[1] != states:
            raise ValueError("TrainKernel: wrong number of states")
        if (solve.shape[0] != count or solve.shape[1] != m or solve.shape[2] != m or spring.shape[0] != count
                or spring.shape[1] != m or constant.shape[0] != count or constant.shape[1] != m):
            raise ValueError("TrainKernel: wrong number of meshes or steps of their law")
        if sides is not None and sides.shape[0] != m:
            raise ValueError("TrainKernel: wrong number of sides")
        cdef MeshLaw law = MeshLaw(&solve[0, 0, 0], &spring[0, 0], &constant[0, 0], NULL)
        if sides is not None:
            law.sides = &sides[0]
        with nogil:
            lost = advance_train(self.steps, law, first, count, states, &torques[0, 0], &q[0, 0], &y[0, 0], &push[0, 0])
        return lost
