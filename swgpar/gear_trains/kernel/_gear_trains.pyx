# cython: language_level=3, boundscheck=False, wraparound=False
"""Cython layer of the gear trains' kernels: checks shapes, releases the GIL, calls."""

import numpy as np

from libc.stdint cimport int64_t


cdef extern from "<Eigen/Dense>" nogil:
    pass

cdef extern from "cascade_gearbox.hpp" namespace "swgpar" nogil:
    struct Mesh:
        int64_t driver, driven
        double stiffness, variation, gap_A, gap_B, damping, driven_radius, module
    struct MeshError:
        double amplitude, phase, tooth_phase
    struct Shaft:
        int64_t first, second
        double first_radius, second_radius, stiffness, initial_stiffness, linear_above, damping
    struct GearboxData:
        const Mesh* meshes
        const Shaft* shafts
        const double* mass
        double contact_ramp, generator_damping
        bint braked
    cppclass GearMatrix:
        GearMatrix()
        double* data()
    int kGears, kMeshes, kShafts
    void internal_forces(const GearboxData& gearbox, const MeshError* errors, const double* x, const double* v, double* force,
                         GearMatrix* stiffness, GearMatrix* damping)
    void shaft_torques(const GearboxData& gearbox, const double* x, const double* v, double* torque)
    int64_t simulate_gearbox(const GearboxData& gearbox, const MeshError* errors, const double* rack_force, int64_t n, double h, double* x,
                     double* v, double* torque)

cdef extern from "planetary_steps.hpp" namespace "swgpar" nogil:
    struct StepMatrices:
        int64_t modes, meshes
        double h, half_backlash
        const double* from_q
        const double* from_y
        const double* from_torque
        const double* from_force
        const double* deflection_rows
        const double* compliance
        const double* damping
    struct MeshLaw:
        const double* solve
        const double* stiffness
        const double* constant
        const double* flanks
    int kMaxTrainMeshes
    int64_t advance_states(const StepMatrices& matrices, const MeshLaw& law, int64_t first, int64_t count, int64_t states,
                          const double* torques, double* q, double* y, double* mesh_term)


MESH = np.dtype([("driver", "i8"), ("driven", "i8"), *((name, "f8") for name in (
    "stiffness", "variation", "gap_A", "gap_B", "damping", "driven_radius", "module"))])
MESH_ERROR = np.dtype([(name, "f8") for name in ("amplitude", "phase", "tooth_phase")])
SHAFT = np.dtype([("first", "i8"), ("second", "i8"), *((name, "f8") for name in (
    "first_radius", "second_radius", "stiffness", "initial_stiffness", "linear_above", "damping"))])


cdef class GearboxKernel:
    """Forces, matrices and motion of a cascade gearbox with given meshes and shafts.

    Parameters
    ----------
    mass : (23,) float64, kg
    meshes : (18,) MESH
    shafts : (11,) SHAFT, the flexible units first
    contact_ramp : penetration over which the damping of a mesh rises to its full value, m
    generator_damping : force over velocity of the flywheel, N·s/m
    braked : the flywheel is fixed
    """

    cdef const double[::1] mass
    cdef const Mesh[::1] meshes
    cdef const Shaft[::1] shafts
    cdef GearboxData gearbox

    def __init__(self, const double[::1] mass, const Mesh[::1] meshes, const Shaft[::1] shafts, 
                 double contact_ramp, double generator_damping, bint braked):
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
        self.gearbox = GearboxData(&meshes[0], &shafts[0], &mass[0], contact_ramp, generator_damping, braked)

    def forces(self, const MeshError[::1] errors, const double[::1] x, const double[::1] v):
        """Forces (23,) in N of meshes, shafts and generator at displacements x (m) and velocities v (m/s)."""
        self._check(errors.shape[0], x.shape[0], v.shape[0])
        force = np.empty(kGears)
        cdef double[::1] out = force
        with nogil:
            internal_forces(self.gearbox, &errors[0], &x[0], &v[0], &out[0], NULL, NULL)
        return force

    def matrices(self, const MeshError[::1] errors, const double[::1] x, const double[::1] v):
        """Stiffness (N/m) and damping (N·s/m), (23, 23), symmetric."""
        self._check(errors.shape[0], x.shape[0], v.shape[0])
        cdef double[::1] force = np.empty(kGears)
        cdef GearMatrix stiffness, damping
        internal_forces(self.gearbox, &errors[0], &x[0], &v[0], &force[0], &stiffness, &damping)
        shape = (kGears, kGears)
        return (np.array(<double[:kGears * kGears]>stiffness.data()).reshape(shape),
                np.array(<double[:kGears * kGears]>damping.data()).reshape(shape))

    def torques(self, const double[:, ::1] x, const double[:, ::1] v):
        """Torques (n, 11) in N·m of all shafts at displacements and velocities (n, 23)."""
        cdef int64_t k, n = x.shape[0]
        self._check(kMeshes, x.shape[1], v.shape[1])
        if v.shape[0] != n:
            raise ValueError("GearboxKernel: not as many velocities as displacements")
        torque = np.empty((n, kShafts))
        cdef double[:, ::1] out = torque
        for k in range(n):
            shaft_torques(self.gearbox, &x[k, 0], &v[k, 0], &out[k, 0])
        return torque

    def simulate(self, const MeshError[::1] errors, const double[::1] rack_force, double h, double[::1] x, double[::1] v):
        """Advance x and v in place under rack forces at the ends of all steps, (n + 1,) N, h apart.

        Returns the torques of all shafts, N·m, after every step that converged: (m, 11), m = n if all did.
        """
        self._check(errors.shape[0], x.shape[0], v.shape[0])
        cdef int64_t n = rack_force.shape[0] - 1, done
        if n < 1:
            raise ValueError("GearboxKernel: no step")
        torque = np.empty((n, kShafts))
        cdef double[:, ::1] out = torque
        with nogil:
            done = simulate_gearbox(self.gearbox, &errors[0], &rack_force[0], n, h, &x[0], &v[0], &out[0, 0])
        return torque[:done]

    def _check(self, int64_t errors, int64_t x, int64_t v):
        if errors != kMeshes or x != kGears or v != kGears:
            raise ValueError("GearboxKernel: wrong number of errors, displacements or velocities")


cdef class PlanetaryStepKernel:
    """Time steps of a planetary gear train; swgpar/gear_trains/planetary/time_stepping.py has the equations.

    Parameters
    ----------
    h : step, s;  half_backlash : m
    from_q, from_y, from_torque, from_force : (modes,) float64, coefficients of the step
    deflection_rows : (steps + 1, meshes, modes), mesh deflections per mode
    compliance : (steps + 1, meshes, meshes), G;  damping : (meshes,) N·s/m
    """

    cdef const double[::1] from_q, from_y, from_torque, from_force, damping
    cdef const double[:, :, ::1] deflection_rows, compliance
    cdef StepMatrices matrices

    def __init__(self, double h, double half_backlash, const double[::1] from_q, const double[::1] from_y,
                 const double[::1] from_torque, const double[::1] from_force, const double[:, :, ::1] deflection_rows,
                 const double[:, :, ::1] compliance, const double[::1] damping):
        cdef int64_t n = deflection_rows.shape[2], m = deflection_rows.shape[1]
        if not 0 < m <= kMaxTrainMeshes or damping.shape[0] != m:
            raise ValueError("PlanetaryStepKernel: wrong number of meshes")
        if from_q.shape[0] != n or from_y.shape[0] != n or from_torque.shape[0] != n or from_force.shape[0] != n:
            raise ValueError("PlanetaryStepKernel: wrong number of modes")
        if compliance.shape[0] != deflection_rows.shape[0] or compliance.shape[1] != m or compliance.shape[2] != m:
            raise ValueError("PlanetaryStepKernel: compliance and deflection_rows differ in their numbers of steps or meshes")
        self.from_q, self.from_y, self.from_torque, self.from_force = from_q, from_y, from_torque, from_force
        self.deflection_rows, self.compliance, self.damping = deflection_rows, compliance, damping
        self.matrices = StepMatrices(n, m, h, half_backlash, &from_q[0], &from_y[0], &from_torque[0], &from_force[0], &deflection_rows[0, 0, 0],
                                &compliance[0, 0, 0], &damping[0])

    def advance(self, int64_t first, double[:, ::1] q, double[:, ::1] y, double[:, ::1] mesh_term,
                const double[:, ::1] torques, const double[:, :, ::1] solve, const double[:, ::1] stiffness,
                const double[:, ::1] constant, const double[::1] flanks=None):
        """Advance states q, y, mesh_term (modes, states) in place by the steps after step `first`, one for each row of torques.

        torques : (count, states) N·m, sum of the torques at the start and the end of each step
        solve : (count, meshes, meshes);  stiffness, constant : (count, meshes), force = stiffness * deflection + constant
        flanks : (meshes,) 1 or -1, the flanks in contact for which this law holds; None for meshes without backlash

        Returns the number of (step, state) pairs in which some mesh was not in contact on its flank, or minus the number
        of the step that did not converge.
        """
        cdef int64_t n = self.matrices.modes, m = self.matrices.meshes, count = torques.shape[0], states = q.shape[1], separated
        if first < 0 or first + count >= self.deflection_rows.shape[0] or count < 1 or states < 1:
            raise ValueError("PlanetaryStepKernel: no such steps or no states")
        if q.shape[0] != n or y.shape[0] != n or mesh_term.shape[0] != n:
            raise ValueError("PlanetaryStepKernel: wrong number of modes")
        if y.shape[1] != states or mesh_term.shape[1] != states or torques.shape[1] != states:
            raise ValueError("PlanetaryStepKernel: wrong number of states")
        if (solve.shape[0] != count or solve.shape[1] != m or solve.shape[2] != m or stiffness.shape[0] != count
                or stiffness.shape[1] != m or constant.shape[0] != count or constant.shape[1] != m):
            raise ValueError("PlanetaryStepKernel: wrong number of meshes or steps in the mesh law")
        if flanks is not None and flanks.shape[0] != m:
            raise ValueError("PlanetaryStepKernel: wrong number of flanks")
        cdef MeshLaw law = MeshLaw(&solve[0, 0, 0], &stiffness[0, 0], &constant[0, 0], NULL)
        if flanks is not None:
            law.flanks = &flanks[0]
        with nogil:
            separated = advance_states(self.matrices, law, first, count, states, &torques[0, 0], &q[0, 0], &y[0, 0], &mesh_term[0, 0])
        return separated
