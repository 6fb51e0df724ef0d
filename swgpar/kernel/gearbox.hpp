// Motion of the cascade gearbox: gears that turn only, coupled by meshes with backlash and by shafts.
//
// The equations are those of swgpar/gear_trains/cascade/dynamics.py. Time steps are SDIRK of two stages and order two,
// L-stable: vibrations that the step does not resolve die out. Both stages solve
//
//   M (w - v) + a f(x + a w, w) = a F e_0    for the velocities w, with a = gamma h,
//
// by Newton's method with the symmetric matrix M + a C + a^2 K. A step that does not converge is halved.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace swgpar {

constexpr int kGears = 23, kMeshes = 18, kShafts = 11;
constexpr double kGamma = 0.29289321881345254;  // 1 - sqrt(1/2)
constexpr int kMaxNewton = 12, kMaxHalvings = 12;
constexpr double kNewtonTolerance = 1e-8;  // change of a velocity over the largest velocity

using Ways = Eigen::Matrix<double, kGears, 1>;
using GearMatrix = Eigen::Matrix<double, kGears, kGears>;

struct Mesh {
  std::int64_t driver, driven;
  double stiffness, variation;  // mean; amplitude over the mean
  double gap_A, gap_B;
  double damping;  // with the flanks in full contact
  double radius;   // of the driven gear
  double module;
};

struct MeshError {  // e = amplitude sin(angle of the driven gear + phase)
  double amplitude, phase, tooth_phase;
};

struct Shaft {
  std::int64_t first, second;
  double first_radius, second_radius;
  double stiffness, initial, end;  // beyond the twist `end`; at no twist, from where it changes along a parabola
  double damping;
};

struct Gearbox {
  const Mesh* meshes;
  const Shaft* shafts;
  const double* mass;
  double ramp;       // approach over which the damping of a mesh sets in
  double generator;  // force over velocity of the last gear
  bool braked;       // the last gear is held
};

struct Interaction {  // a force, and its derivatives with respect to way and rate
  double force, stiffness, damping;
};

inline Interaction mesh_force(const Mesh& m, const MeshError& e, double ramp, const double* x, const double* v) {
  const double way = x[m.driven], speed = v[m.driven];
  const double angle = way / m.radius + e.phase;
  const double p = x[m.driver] - way - e.amplitude * std::sin(angle);
  const double approach = p > m.gap_B ? p - m.gap_B : p < -m.gap_A ? p + m.gap_A : 0.0;
  if (approach == 0.0) return {0.0, 0.0, 0.0};
  const double rate = v[m.driver] - speed - e.amplitude * std::cos(angle) * speed / m.radius;
  // a tooth cycle is a way of pi times the module
  const double k = m.stiffness * (1.0 + m.variation * std::sin(2.0 * way / m.module + e.tooth_phase));
  const double depth = std::min(std::abs(approach) / ramp, 1.0);
  const double c = m.damping * depth * depth * (3.0 - 2.0 * depth);
  const double dc = m.damping * 6.0 * depth * (1.0 - depth) / ramp * (approach > 0.0 ? 1.0 : -1.0);
  return {k * approach + c * rate, std::max(k + dc * rate, 0.0), c};  // never negative, for the Newton matrix
}

// Torque and its derivatives with respect to the twist and its rate.
inline Interaction shaft_torque(const Shaft& s, const double* x, const double* v) {
  const double twist = x[s.first] / s.first_radius - x[s.second] / s.second_radius;
  const double rate = v[s.first] / s.first_radius - v[s.second] / s.second_radius;
  const double rest = std::max(1.0 - std::abs(twist) / s.end, 0.0), more = s.initial - s.stiffness;
  const double extra = more * s.end / 3.0 * (1.0 - rest * rest * rest);
  const double torque = s.stiffness * twist + (twist < 0.0 ? -extra : extra);
  return {torque + s.damping * rate, s.stiffness + more * rest * rest, s.damping};
}

// Forces that have to be overcome; where asked for, their derivatives with respect to ways and velocities.
inline void internal_forces(const Gearbox& box, const MeshError* errors, const double* x, const double* v,
                            double* force, GearMatrix* stiffness, GearMatrix* damping) {
  std::fill(force, force + kGears, 0.0);
  if (stiffness) stiffness->setZero();
  if (damping) damping->setZero();
  const auto add = [&](std::int64_t i, std::int64_t j, double bi, double bj, const Interaction& f) {
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
    const Mesh& m = box.meshes[k];
    add(m.driver, m.driven, 1.0, -1.0, mesh_force(m, errors[k], box.ramp, x, v));
  }
  for (int k = 0; k < kShafts; ++k) {
    const Shaft& s = box.shafts[k];
    add(s.first, s.second, 1.0 / s.first_radius, -1.0 / s.second_radius, shaft_torque(s, x, v));
  }
  force[kGears - 1] += box.generator * v[kGears - 1];
  if (damping) (*damping)(kGears - 1, kGears - 1) += box.generator;
}

// Velocities w at the end of a stage from x, v; w holds a guess. Returns whether Newton converged.
inline bool stage(const Gearbox& box, const MeshError* errors, const Ways& x, const Ways& v, double rack, double a,
                  Ways& w) {
  const Eigen::Map<const Ways> mass(box.mass);
  const int last = kGears - 1;
  GearMatrix stiffness, damping;
  for (int k = 0; k < kMaxNewton; ++k) {
    const Ways now = x + a * w;
    Ways force;
    internal_forces(box, errors, now.data(), w.data(), force.data(), &stiffness, &damping);
    force[0] -= rack;
    Ways residual = mass.cwiseProduct(w - v) + a * force;
    GearMatrix matrix = a * damping + a * a * stiffness;
    matrix.diagonal() += mass;
    if (box.braked) {
      matrix.row(last).setZero();
      matrix.col(last).setZero();
      matrix(last, last) = 1.0;
      residual[last] = 0.0;
    }
    const Ways change = matrix.llt().solve(residual);
    w -= change;
    if (!(change.cwiseAbs().maxCoeff() > kNewtonTolerance * w.cwiseAbs().maxCoeff())) return change.allFinite();
  }
  return false;
}

// Moves x, v on by h under a rack force that goes from f0 to f1. Returns whether all steps converged.
inline bool advance(const Gearbox& box, const MeshError* errors, double f0, double f1, double h, Ways& x, Ways& v,
                    int halvings = 0) {
  const double a = kGamma * h;
  Ways w = v;
  if (stage(box, errors, x, v, f0 + kGamma * (f1 - f0), a, w)) {
    const Ways x2 = x + (h - a) * w, v2 = v + (h - a) / a * (w - v);
    if (stage(box, errors, x2, v2, f1, a, w)) {
      x = x2 + a * w;
      v = w;
      return true;
    }
  }
  if (halvings == kMaxHalvings) return false;
  const double middle = 0.5 * (f0 + f1);
  return advance(box, errors, f0, middle, 0.5 * h, x, v, halvings + 1) &&
         advance(box, errors, middle, f1, 0.5 * h, x, v, halvings + 1);
}

inline void shaft_torques(const Gearbox& box, const double* x, const double* v, double* torque) {
  for (int k = 0; k < kShafts; ++k) torque[k] = shaft_torque(box.shafts[k], x, v).force;
}

// Moves one gearbox through n steps and notes the torques of its shafts after each. Returns the number of steps that
// converged. rack (n + 1): forces at the ends of the steps; torque (n, kShafts).
inline std::int64_t simulate(const Gearbox& box, const MeshError* errors, const double* rack, std::int64_t n, double h,
                             double* x, double* v, double* torque) {
  Ways way = Eigen::Map<Ways>(x), speed = Eigen::Map<Ways>(v);
  std::int64_t done = 0;
  while (done < n && advance(box, errors, rack[done], rack[done + 1], h, way, speed)) {
    shaft_torques(box, way.data(), speed.data(), torque + done * kShafts);
    ++done;
  }
  Eigen::Map<Ways>(x, kGears) = way;
  Eigen::Map<Ways>(v, kGears) = speed;
  return done;
}

}  // namespace swgpar
