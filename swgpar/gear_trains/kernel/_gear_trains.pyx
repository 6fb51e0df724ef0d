# cython: language_level=3, boundscheck=False, wraparound=False
"""Cython layer of the gear trains' kernels: checks arrays, releases the GIL, calls."""

from libc.stdint cimport int64_t

include "../../kernel/arrays.pxi"


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

    def __cinit__(self, mass, meshes, shafts, double contact_ramp, double generator_damping, bint braked):
        name = "GearboxKernel"
        checked(name, "meshes", meshes, MESH, (kMeshes,))
        checked(name, "shafts", shafts, SHAFT, (kShafts,))
        for ends, field in ((meshes, "driver"), (meshes, "driven"), (shafts, "first"), (shafts, "second")):
            of = "meshes" if ends is meshes else "shafts"
            indices(name, f"{of}[{field!r}]", np.ascontiguousarray(ends[field]), INT64, (ANY,), 0, kGears)
        self.mass = checked(name, "mass", mass, DOUBLE, (kGears,))
        self.meshes, self.shafts = meshes, shafts
        self.gearbox = GearboxData(
            &self.meshes[0], &self.shafts[0], &self.mass[0], contact_ramp, generator_damping, braked
        )

    def forces(self, errors, x, v):
        """Forces (23,) in N of meshes, shafts and generator at displacements x (m) and velocities v (m/s).

        errors : (18,) MESH_ERROR;  x, v : (23,). Raises ValueError for other arrays, as all methods do.
        """
        name = "GearboxKernel.forces"
        cdef const MeshError[::1] mesh_errors = checked(name, "errors", errors, MESH_ERROR, (kMeshes,))
        cdef const double[::1] displacement = checked(name, "x", x, DOUBLE, (kGears,))
        cdef const double[::1] velocity = checked(name, "v", v, DOUBLE, (kGears,))
        force = np.empty(kGears)
        cdef double[::1] out = force
        with nogil:
            internal_forces(self.gearbox, &mesh_errors[0], &displacement[0], &velocity[0], &out[0], NULL, NULL)
        return force

    def matrices(self, errors, x, v):
        """Stiffness (N/m) and damping (N·s/m), (23, 23), symmetric; arguments as for `forces`."""
        name = "GearboxKernel.matrices"
        cdef const MeshError[::1] mesh_errors = checked(name, "errors", errors, MESH_ERROR, (kMeshes,))
        cdef const double[::1] displacement = checked(name, "x", x, DOUBLE, (kGears,))
        cdef const double[::1] velocity = checked(name, "v", v, DOUBLE, (kGears,))
        cdef double[::1] force = np.empty(kGears)
        cdef GearMatrix stiffness, damping
        internal_forces(self.gearbox, &mesh_errors[0], &displacement[0], &velocity[0], &force[0], &stiffness, &damping)
        shape = (kGears, kGears)
        return (np.array(<double[:kGears * kGears]>stiffness.data()).reshape(shape),
                np.array(<double[:kGears * kGears]>damping.data()).reshape(shape))

    def torques(self, x, v):
        """Torques (n, 11) in N·m of all shafts at displacements and velocities (n, 23)."""
        name = "GearboxKernel.torques"
        cdef const double[:, ::1] displacement = checked(name, "x", x, DOUBLE, (ANY, kGears))
        cdef int64_t k, n = displacement.shape[0]
        cdef const double[:, ::1] velocity = checked(name, "v", v, DOUBLE, (n, kGears))
        torque = np.empty((n, kShafts))
        cdef double[:, ::1] out = torque
        for k in range(n):
            shaft_torques(self.gearbox, &displacement[k, 0], &velocity[k, 0], &out[k, 0])
        return torque

    def simulate(self, errors, rack_force, double h, x, v):
        """Advance x and v in place under rack forces at the ends of all steps, (n + 1,) N, h apart.

        Returns the torques of all shafts, N·m, after every step that converged: (m, 11), m = n if all did.
        """
        name = "GearboxKernel.simulate"
        cdef const MeshError[::1] mesh_errors = checked(name, "errors", errors, MESH_ERROR, (kMeshes,))
        cdef const double[::1] force = checked(name, "rack_force", rack_force, DOUBLE, (ANY,))
        cdef double[::1] displacement = checked(name, "x", x, DOUBLE, (kGears,), True)
        cdef double[::1] velocity = checked(name, "v", v, DOUBLE, (kGears,), True)
        cdef int64_t n = force.shape[0] - 1, done
        if n < 1:
            raise ValueError(f"{name}: rack_force is ({n + 1},); expected 2 values or more")
        torque = np.empty((n, kShafts))
        cdef double[:, ::1] out = torque
        with nogil:
            done = simulate_gearbox(
                self.gearbox, &mesh_errors[0], &force[0], n, h, &displacement[0], &velocity[0], &out[0, 0]
            )
        return torque[:done]


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

    def __cinit__(self, double h, double half_backlash, from_q, from_y, from_torque, from_force, deflection_rows,
                  compliance, damping):
        name = "PlanetaryStepKernel"
        self.deflection_rows = checked(name, "deflection_rows", deflection_rows, DOUBLE, (ANY, ANY, ANY))
        cdef int64_t steps = self.deflection_rows.shape[0]
        cdef int64_t m = self.deflection_rows.shape[1], n = self.deflection_rows.shape[2]
        if not 0 < m <= kMaxTrainMeshes:
            raise ValueError(
                f"{name}: deflection_rows is ({steps}, {m}, {n}); expected from 1 to {kMaxTrainMeshes} meshes"
            )
        self.compliance = checked(name, "compliance", compliance, DOUBLE, (steps, m, m))
        self.damping = checked(name, "damping", damping, DOUBLE, (m,))
        self.from_q = checked(name, "from_q", from_q, DOUBLE, (n,))
        self.from_y = checked(name, "from_y", from_y, DOUBLE, (n,))
        self.from_torque = checked(name, "from_torque", from_torque, DOUBLE, (n,))
        self.from_force = checked(name, "from_force", from_force, DOUBLE, (n,))
        self.matrices = StepMatrices(
            n, m, h, half_backlash, &self.from_q[0], &self.from_y[0], &self.from_torque[0], &self.from_force[0],
            &self.deflection_rows[0, 0, 0], &self.compliance[0, 0, 0], &self.damping[0],
        )

    def advance(self, int64_t first, q, y, mesh_term, torques, solve, stiffness, constant, flanks=None):
        """Advance states q, y, mesh_term (modes, states) in place by the steps after step `first`, one for each row of torques.

        torques : (count, states) N·m, sum of the torques at the start and the end of each step
        solve : (count, meshes, meshes);  stiffness, constant : (count, meshes), force = stiffness * deflection + constant
        flanks : (meshes,) 1 or -1, the flanks in contact for which this law holds; None for meshes without backlash

        Returns the number of (step, state) pairs in which some mesh was not in contact on its flank, or minus the number
        of the step that did not converge. Raises ValueError for other arrays.
        """
        name = "PlanetaryStepKernel.advance"
        cdef int64_t n = self.matrices.modes, m = self.matrices.meshes, last = self.deflection_rows.shape[0] - 1
        cdef const double[:, ::1] torque = checked(name, "torques", torques, DOUBLE, (ANY, ANY))
        cdef int64_t count = torque.shape[0], states = torque.shape[1], separated
        if count < 1 or states < 1 or not 0 <= first <= last - count:
            raise ValueError(
                f"{name}: torques is ({count}, {states}) after step {first}; expected a state and steps from 1 to {last}"
            )
        cdef tuple shape = (n, states)
        cdef double[:, ::1] q_rows = checked(name, "q", q, DOUBLE, shape, True)
        cdef double[:, ::1] y_rows = checked(name, "y", y, DOUBLE, shape, True)
        cdef double[:, ::1] mesh_terms = checked(name, "mesh_term", mesh_term, DOUBLE, shape, True)
        cdef const double[:, :, ::1] inverse = checked(name, "solve", solve, DOUBLE, (count, m, m))
        cdef const double[:, ::1] slope = checked(name, "stiffness", stiffness, DOUBLE, (count, m))
        cdef const double[:, ::1] offset = checked(name, "constant", constant, DOUBLE, (count, m))
        cdef const double[::1] sides
        cdef MeshLaw law = MeshLaw(&inverse[0, 0, 0], &slope[0, 0], &offset[0, 0], NULL)
        if flanks is not None:
            sides = checked(name, "flanks", flanks, DOUBLE, (m,))
            law.flanks = &sides[0]
        with nogil:
            separated = advance_states(
                self.matrices, law, first, count, states, &torque[0, 0], &q_rows[0, 0], &y_rows[0, 0], &mesh_terms[0, 0]
            )
        return separated
