// Equations of motion of the cascade gearbox and their time integration.
//
// Each of the 23 gears has one degree of freedom: its displacement along its pitch line (m). Meshes
// with backlash and torsional shafts couple them.
//
// The equations are those of swgpar/gear_trains/cascade/dynamics.py. Time steps are SDIRK with two
// stages and second order. The scheme is L-stable: vibrations that the step does not resolve are
// damped out. Both stages solve
//
//   M (w - v) + a f(x + a w, w) = a F e_0    for the velocities w, with a = gamma h,
//
// by Newton's method with the symmetric matrix M + a C + a^2 K. A step that does not converge is
// halved.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace swgpar {

constexpr int kGears = 23, kMeshes = 18, kShafts = 11;
constexpr int kRack = 0, kFlywheel = kGears - 1;
constexpr double kSdirkGamma = 0.29289321881345254;  // 1 - sqrt(1/2)
constexpr int kMaxNewtonIterations = 12, kMaxStepHalvings = 12;
constexpr double kNewtonTolerance = 1e-8;  // largest change of a velocity over the largest velocity

using GearVector = Eigen::Matrix<double, kGears, 1>;
using GearMatrix = Eigen::Matrix<double, kGears, kGears>;

struct Mesh {
  std::int64_t driver, driven;
  double stiffness, variation;  // mean; amplitude over the mean
  double gap_A, gap_B;
  double damping;  // with the flanks in full contact
  double driven_radius;
  double module;
};

struct MeshError {  // e = amplitude sin(angle of the driven gear + phase)
  double amplitude, phase, tooth_phase;
};

struct Shaft {
  std::int64_t first, second;
  double first_radius, second_radius;
  double stiffness, initial_stiffness;  // at twists above `linear_above`, and at zero twist; a
                                        // parabola between them
  double linear_above;
  double damping;
};

struct GearboxData {
  const Mesh* meshes;
  const Shaft* shafts;
  const double* mass;
  double contact_ramp;       // penetration over which the damping of a mesh rises to its full value
  double generator_damping;  // force over velocity of the flywheel
  bool braked;               // the flywheel is fixed
};

struct ForceLaw {  // a force, and its derivatives with respect to the deflection and to the
                   // deflection rate
  double force, stiffness, damping;
};

inline ForceLaw mesh_force(const Mesh& m, const MeshError& e, double contact_ramp, const double* x,
                           const double* v) {
  const double displacement = x[m.driven], velocity = v[m.driven];
  const double angle = displacement / m.driven_radius + e.phase;
  const double deflection = x[m.driver] - displacement - e.amplitude * std::sin(angle);
  const double penetration = deflection > m.gap_B    ? deflection - m.gap_B
                             : deflection < -m.gap_A ? deflection + m.gap_A
                                                     : 0.0;
  if (penetration == 0.0) return {0.0, 0.0, 0.0};
  const double rate =
      v[m.driver] - velocity - e.amplitude * std::cos(angle) * velocity / m.driven_radius;
  // one tooth pitch is pi times the module
  const double k =
      m.stiffness * (1.0 + m.variation * std::sin(2.0 * displacement / m.module + e.tooth_phase));
  const double depth = std::min(std::abs(penetration) / contact_ramp, 1.0);
  const double damping = m.damping * depth * depth * (3.0 - 2.0 * depth);
  const double damping_slope =
      m.damping * 6.0 * depth * (1.0 - depth) / contact_ramp * (penetration > 0.0 ? 1.0 : -1.0);
  return {k * penetration + damping * rate,
          std::max(k + damping_slope * rate,
                   0.0),  // not negative: the Newton matrix stays positive definite
          damping};
}

// Torque and its derivatives with respect to the twist and its rate.
inline ForceLaw shaft_torque(const Shaft& s, const double* x, const double* v) {
  const double twist = x[s.first] / s.first_radius - x[s.second] / s.second_radius;
  const double rate = v[s.first] / s.first_radius - v[s.second] / s.second_radius;
  const double below_linear = std::max(1.0 - std::abs(twist) / s.linear_above, 0.0);
  const double extra_stiffness = s.initial_stiffness - s.stiffness;
  const double extra_torque =
      extra_stiffness * s.linear_above / 3.0 * (1.0 - below_linear * below_linear * below_linear);
  const double torque = s.stiffness * twist + (twist < 0.0 ? -extra_torque : extra_torque);
  return {torque + s.damping * rate, s.stiffness + extra_stiffness * below_linear * below_linear,
          s.damping};
}

// Internal forces of meshes, shafts and generator (kGears, N); if the pointers are set, their
// derivatives with respect to displacements (N/m) and velocities (N s/m).
inline void internal_forces(const GearboxData& gearbox, const MeshError* errors, const double* x,
                            const double* v, double* force, GearMatrix* stiffness,
                            GearMatrix* damping) {
  std::fill(force, force + kGears, 0.0);
  if (stiffness) stiffness->setZero();
  if (damping) damping->setZero();
  const auto add = [&](std::int64_t i, std::int64_t j, double bi, double bj, const ForceLaw& f) {
    force[i] += bi * f.force;
    force[j] += bj * f.force;
    if (stiffness) {
      (*stiffness)(i, i) += bi * bi * f.stiffness;
      (*stiffness)(j, j) += bj * bj * f.stiffness;
      (*stiffness)(i, j) += bi * bj * f.stiffness;
      (*stiffness)(j, i) += bi * bj * f.stiffness;
    }
    if (damping) {
      (*damping)(i, i) += bi * bi * f.damping;
      (*damping)(j, j) += bj * bj * f.damping;
      (*damping)(i, j) += bi * bj * f.damping;
      (*damping)(j, i) += bi * bj * f.damping;
    }
  };
  for (int k = 0; k < kMeshes; ++k) {
    const Mesh& m = gearbox.meshes[k];
    add(m.driver, m.driven, 1.0, -1.0, mesh_force(m, errors[k], gearbox.contact_ramp, x, v));
  }
  for (int k = 0; k < kShafts; ++k) {
    const Shaft& s = gearbox.shafts[k];
    add(s.first, s.second, 1.0 / s.first_radius, -1.0 / s.second_radius, shaft_torque(s, x, v));
  }
  force[kFlywheel] += gearbox.generator_damping * v[kFlywheel];
  if (damping) (*damping)(kFlywheel, kFlywheel) += gearbox.generator_damping;
}

// Velocities w at the end of a stage from x, v; w holds a guess. Returns whether Newton converged.
inline bool solve_stage(const GearboxData& gearbox, const MeshError* errors, const GearVector& x,
                        const GearVector& v, double rack_force, double a, GearVector& w) {
  const Eigen::Map<const GearVector> mass(gearbox.mass);
  GearMatrix stiffness, damping;
  for (int k = 0; k < kMaxNewtonIterations; ++k) {
    const GearVector displacement = x + a * w;
    GearVector force;
    internal_forces(gearbox, errors, displacement.data(), w.data(), force.data(), &stiffness,
                    &damping);
    force[kRack] -= rack_force;
    GearVector residual = mass.cwiseProduct(w - v) + a * force;
    GearMatrix matrix = a * damping + a * a * stiffness;
    matrix.diagonal() += mass;
    if (gearbox.braked) {
      matrix.row(kFlywheel).setZero();
      matrix.col(kFlywheel).setZero();
      matrix(kFlywheel, kFlywheel) = 1.0;
      residual[kFlywheel] = 0.0;
    }
    const GearVector change = matrix.llt().solve(residual);
    w -= change;
    if (!(change.cwiseAbs().maxCoeff() > kNewtonTolerance * w.cwiseAbs().maxCoeff()))
      return change.allFinite();
  }
  return false;
}

// Moves x, v on by h under a rack force that goes from f0 to f1. Returns whether all steps
// converged.
inline bool advance_step(const GearboxData& gearbox, const MeshError* errors, double f0, double f1,
                         double h, GearVector& x, GearVector& v, int halvings = 0) {
  const double a = kSdirkGamma * h;
  GearVector w = v;
  if (solve_stage(gearbox, errors, x, v, f0 + kSdirkGamma * (f1 - f0), a, w)) {
    const GearVector x2 = x + (h - a) * w, v2 = v + (h - a) / a * (w - v);
    if (solve_stage(gearbox, errors, x2, v2, f1, a, w)) {
      x = x2 + a * w;
      v = w;
      return true;
    }
  }
  if (halvings == kMaxStepHalvings) return false;
  const double middle = 0.5 * (f0 + f1);
  return advance_step(gearbox, errors, f0, middle, 0.5 * h, x, v, halvings + 1) &&
         advance_step(gearbox, errors, middle, f1, 0.5 * h, x, v, halvings + 1);
}

inline void shaft_torques(const GearboxData& gearbox, const double* x, const double* v,
                          double* torque) {
  for (int k = 0; k < kShafts; ++k) torque[k] = shaft_torque(gearbox.shafts[k], x, v).force;
}

// Moves one gearbox through n steps and stores the torques of its shafts after each. Returns the
// number of steps that converged. rack_force (n + 1): forces at the ends of the steps; torque (n,
// kShafts).
inline std::int64_t simulate_gearbox(const GearboxData& gearbox, const MeshError* errors,
                                     const double* rack_force, std::int64_t n, double h, double* x,
                                     double* v, double* torque) {
  GearVector displacement = Eigen::Map<GearVector>(x), velocity = Eigen::Map<GearVector>(v);
  std::int64_t done = 0;
  while (done < n && advance_step(gearbox, errors, rack_force[done], rack_force[done + 1], h,
                                  displacement, velocity)) {
    shaft_torques(gearbox, displacement.data(), velocity.data(), torque + done * kShafts);
    ++done;
  }
  Eigen::Map<GearVector>(x, kGears) = displacement;
  Eigen::Map<GearVector>(v, kGears) = velocity;
  return done;
}

}  // namespace swgpar
