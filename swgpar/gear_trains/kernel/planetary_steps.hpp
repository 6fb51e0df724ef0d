// Implicit steps of the planetary gear train for many states at once.
//
// The equations are those of swgpar/gear_trains/planetary/time_stepping.py. States are columns of
// (modes, states) arrays; kLanes of them are advanced together through all steps, so that they stay
// in the L1 cache.
#pragma once

#include <Eigen/Dense>
#include <Eigen/StdVector>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace swgpar {

constexpr int kLanes = 16, kMaxTrainMeshes = 24, kMaxContactIterations = 50;

using Lanes = Eigen::Array<double, kLanes, 1>;
using LaneRows = std::vector<Lanes, Eigen::aligned_allocator<Lanes>>;
using MeshVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxTrainMeshes, 1>;
using MeshMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxTrainMeshes, kMaxTrainMeshes>;

struct StepMatrices {  // of all steps; arrays are row-major
  std::int64_t modes, meshes;
  double h, half_backlash;
  const double *from_q, *from_y, *from_torque, *from_force;  // (modes)
  const double* deflection_rows;                             // (steps + 1, meshes, modes)
  const double* compliance;                                  // (steps + 1, meshes, meshes)
  const double* damping;                                     // (meshes)
};

struct MeshLaw {  // force = stiffness * deflection + constant at the end of each of some steps
  const double* solve;  // (count, meshes, meshes), inverse of 1 + 2/h G c + G stiffness
  const double *stiffness, *constant;  // (count, meshes)
  const double*
      flanks;  // (meshes), 1 or -1, the flanks in contact; null for a law without backlash
};

// Sum of n rows times weights that are `stride` apart. It uses four registers: with a loop over
// kLanes the compiler does not keep the sum in registers.
inline Lanes weighted_sum(const double* weight, std::int64_t stride, const LaneRows& rows,
                          std::int64_t n) {
  using Register = Eigen::Array4d;
  using Part = Eigen::Map<const Register, Eigen::Aligned32>;
  Register a = Register::Zero(), b = a, c = a, d = a;
  for (std::int64_t i = 0; i < n; ++i) {
    const double w = weight[i * stride];
    const double* row = rows[i].data();
    a += w * Part(row), b += w * Part(row + 4), c += w * Part(row + 8), d += w * Part(row + 12);
  }
  Lanes sum;
  sum << a, b, c, d;
  return sum;
}

// The same for two sets of rows at once: two independent sums hide the latency of the additions.
inline void weighted_sum(const double* weight, const LaneRows& first, const LaneRows& second,
                         std::int64_t n, Lanes& sum1, Lanes& sum2) {
  using Register = Eigen::Array4d;
  using Part = Eigen::Map<const Register, Eigen::Aligned32>;
  Register a = Register::Zero(), b = a, c = a, d = a, e = a, f = a, g = a, h = a;
  for (std::int64_t i = 0; i < n; ++i) {
    const double w = weight[i];
    const double *row = first[i].data(), *other = second[i].data();
    a += w * Part(row), b += w * Part(row + 4), c += w * Part(row + 8), d += w * Part(row + 12);
    e += w * Part(other), f += w * Part(other + 4), g += w * Part(other + 8),
        h += w * Part(other + 12);
  }
  sum1 << a, b, c, d;
  sum2 << e, f, g, h;
}

// Mesh deflections d (meshes) with (1 + 2/h G c) d + G f(d) = right for meshes with backlash, by
// Newton's method on the piecewise linear f. d holds a guess. Returns whether the contact state
// (flank 1, flank -1, or 0: separated) of all meshes converged.
inline bool solve_with_backlash(const MeshMatrix& compliance, const MeshMatrix& damped,
                                const MeshVector& k, double half_backlash, const MeshVector& right,
                                MeshVector& d) {
  const auto contact_state = [half_backlash](double deflection) {
    return std::abs(deflection) > half_backlash ? std::copysign(1.0, deflection) : 0.0;
  };
  MeshVector contact = d.unaryExpr(contact_state);
  for (int iteration = 0; iteration < kMaxContactIterations; ++iteration) {
    const MeshMatrix matrix = damped + compliance * k.cwiseProduct(contact.cwiseAbs()).asDiagonal();
    d = matrix.partialPivLu().solve(right + compliance * (half_backlash * k.cwiseProduct(contact)));
    const MeshVector new_contact = d.unaryExpr(contact_state);
    if (new_contact == contact) return true;
    contact = new_contact;
  }
  return false;
}

// Advances kLanes states together; the first `width` of them are in use.
class LaneStepper {
 public:
  LaneRows q, y, mesh_term;  // (modes)

  LaneStepper(const StepMatrices& matrices, const MeshLaw& law)
      : q(matrices.modes),
        y(matrices.modes),
        mesh_term(matrices.modes),
        t_(matrices),
        law_(law),
        free_(matrices.modes),
        rate_(matrices.meshes),
        right_(matrices.meshes),
        deflection_(matrices.meshes),
        force_(matrices.meshes) {}

  // Advances by step `first + s + 1`, row s of the mesh law. Returns in how many lanes some mesh
  // was not in contact on its flank, or -1 if a lane did not converge.
  std::int64_t step(std::int64_t first, std::int64_t s, const Lanes& torque, std::int64_t width) {
    const std::int64_t n = t_.modes, m = t_.meshes;
    const double* rows = t_.deflection_rows + (first + s + 1) * m * n;
    const double* compliance = t_.compliance + (first + s + 1) * m * m;
    const double *solve = law_.solve + s * m * m, *stiffness = law_.stiffness + s * m,
                 *constant = law_.constant + s * m;
    for (std::int64_t i = 0; i < n; ++i) {
      free_[i] =
          t_.from_q[i] * q[i] + t_.from_y[i] * y[i] - mesh_term[i] + t_.from_torque[i] * torque;
    }
    for (std::int64_t j = 0; j < m; ++j)
      weighted_sum(rows + j * n, y, free_, n, rate_[j], right_[j]);
    for (std::int64_t j = 0; j < m; ++j) {
      for (std::int64_t l = 0; l < m; ++l) {
        right_[j] += compliance[j * m + l] * (t_.damping[l] * rate_[l] - constant[l]);
      }
    }
    Eigen::Array<bool, kLanes, 1> in_contact = Eigen::Array<bool, kLanes, 1>::Constant(true);
    for (std::int64_t j = 0; j < m; ++j) {
      deflection_[j] = weighted_sum(solve + j * m, 1, right_, m);
      force_[j] = stiffness[j] * deflection_[j] + constant[j];
      if (law_.flanks)
        in_contact = in_contact && law_.flanks[j] * deflection_[j] >= t_.half_backlash;
    }
    std::int64_t separated = 0;
    if (!in_contact.all())
      separated = solve_separated(compliance, stiffness, constant, in_contact, width);
    for (std::int64_t j = 0; j < m; ++j)
      force_[j] += t_.damping[j] * (2.0 / t_.h * deflection_[j] - rate_[j]);
    for (std::int64_t i = 0; i < n; ++i) {
      mesh_term[i] = t_.from_force[i] * weighted_sum(rows + i, n, force_, m);
      q[i] = free_[i] - mesh_term[i];
      y[i] = 4.0 / t_.h * q[i] - y[i];
    }
    return separated;
  }

 private:
  // Replaces deflections and forces of the lanes that are not in contact on the given flanks.
  // Returns their number, or -1 if one did not converge.
  std::int64_t solve_separated(const double* compliance, const double* stiffness,
                               const double* constant,
                               const Eigen::Array<bool, kLanes, 1>& in_contact,
                               std::int64_t width) {
    const std::int64_t m = t_.meshes;
    const MeshMatrix g =
        Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(compliance, m, m);
    const MeshVector k = Eigen::Map<const Eigen::VectorXd>(stiffness, m);
    const MeshMatrix damped =
        MeshMatrix::Identity(m, m) +
        2.0 / t_.h * g * Eigen::Map<const Eigen::VectorXd>(t_.damping, m).asDiagonal();
    const MeshVector loaded = g * Eigen::Map<const Eigen::VectorXd>(constant, m);
    MeshVector d(m), right(m);
    std::int64_t separated = 0;
    for (std::int64_t lane = 0; lane < width; ++lane) {
      if (in_contact[lane]) continue;
      ++separated;
      for (std::int64_t j = 0; j < m; ++j)
        d[j] = deflection_[j][lane], right[j] = right_[j][lane] + loaded[j];
      if (!solve_with_backlash(g, damped, k, t_.half_backlash, right, d)) return -1;
      for (std::int64_t j = 0; j < m; ++j) {
        deflection_[j][lane] = d[j];
        force_[j][lane] = k[j] * (d[j] - std::clamp(d[j], -t_.half_backlash, t_.half_backlash));
      }
    }
    return separated;
  }

  const StepMatrices& t_;
  const MeshLaw& law_;
  LaneRows free_;  // (modes), q at the end of the step without its mesh forces
  LaneRows rate_, right_, deflection_, force_;  // (meshes)
};

// Advances `states` columns of q, y, mesh_term by `count` steps after step `first`. torques (count,
// states): sum of the torques at the start and the end of each step. Returns the number of (step,
// state) pairs in which some mesh was not in contact on its flank, or minus the number of the step
// that did not converge.
inline std::int64_t advance_states(const StepMatrices& t, const MeshLaw& law, std::int64_t first,
                                   std::int64_t count, std::int64_t states, const double* torques,
                                   double* q, double* y, double* mesh_term) {
  LaneStepper stepper(t, law);
  std::int64_t separated = 0;
  for (std::int64_t begin = 0; begin < states; begin += kLanes) {
    const std::int64_t width = std::min<std::int64_t>(kLanes, states - begin);
    const auto load = [&](LaneRows& rows, const double* from) {
      for (std::int64_t i = 0; i < t.modes; ++i) {
        rows[i].setZero();
        std::copy_n(from + i * states + begin, width, rows[i].data());
      }
    };
    const auto store = [&](const LaneRows& rows, double* to) {
      for (std::int64_t i = 0; i < t.modes; ++i)
        std::copy_n(rows[i].data(), width, to + i * states + begin);
    };
    load(stepper.q, q), load(stepper.y, y), load(stepper.mesh_term, mesh_term);
    for (std::int64_t s = 0; s < count; ++s) {
      Lanes torque = Lanes::Zero();
      std::copy_n(torques + s * states + begin, width, torque.data());
      const std::int64_t lanes = stepper.step(first, s, torque, width);
      if (lanes < 0) return -(first + s + 1);
      separated += lanes;
    }
    store(stepper.q, q), store(stepper.y, y), store(stepper.mesh_term, mesh_term);
  }
  return separated;
}

}  // namespace swgpar
