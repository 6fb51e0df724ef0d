// Implicit steps of the planetary gear train for many states at once.
//
// The equations are those of swgpar/gear_trains/planetary/steps.py. States are columns of (modes, states) arrays;
// kLanes of them go through all steps together, so that they stay in the nearest cache.
#pragma once

#include <Eigen/Dense>
#include <Eigen/StdVector>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace swgpar {

constexpr int kLanes = 16, kMaxTrainMeshes = 24, kMaxPieces = 50;

using Lanes = Eigen::Array<double, kLanes, 1>;
using LaneRows = std::vector<Lanes, Eigen::aligned_allocator<Lanes>>;
using MeshVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxTrainMeshes, 1>;
using MeshMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxTrainMeshes, kMaxTrainMeshes>;

struct TrainSteps {  // of all steps; arrays are row-major
  std::int64_t modes, meshes;
  double h, half;                                 // half backlash
  const double *of_q, *of_y, *of_torque, *scale;  // (modes)
  const double* ways;                             // (steps + 1, meshes, modes)
  const double* give;                             // (steps + 1, meshes, meshes)
  const double* damping;                          // (meshes)
};

struct MeshLaw {                    // force = spring way + constant at the end of each of some steps
  const double* solve;              // (count, meshes, meshes), inverse of 1 + 2/h G c + G spring
  const double *spring, *constant;  // (count, meshes)
  const double* sides;              // (meshes), or null for a law without backlash
};

// Sum of n rows times the weights that stand `stride` apart: four registers, which a loop over kLanes would not stay
// in.
inline Lanes weighted(const double* weight, std::int64_t stride, const LaneRows& rows, std::int64_t n) {
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

// The same for two sets of rows at once, which hides the time that one sum has to wait for itself.
inline void weighted(const double* weight, const LaneRows& first, const LaneRows& second, std::int64_t n, Lanes& sum1,
                     Lanes& sum2) {
  using Register = Eigen::Array4d;
  using Part = Eigen::Map<const Register, Eigen::Aligned32>;
  Register a = Register::Zero(), b = a, c = a, d = a, e = a, f = a, g = a, h = a;
  for (std::int64_t i = 0; i < n; ++i) {
    const double w = weight[i];
    const double *row = first[i].data(), *other = second[i].data();
    a += w * Part(row), b += w * Part(row + 4), c += w * Part(row + 8), d += w * Part(row + 12);
    e += w * Part(other), f += w * Part(other + 4), g += w * Part(other + 8), h += w * Part(other + 12);
  }
  sum1 << a, b, c, d;
  sum2 << e, f, g, h;
}

// Ways d (meshes) with (1 + 2/h G c) d + G f(d) = right for meshes with backlash, by Newton's method on the pieces of
// f. d holds a guess. Returns whether the pieces came to rest.
inline bool solve_pieces(const MeshMatrix& give, const MeshMatrix& damped, const MeshVector& k, double half,
                         const MeshVector& right, MeshVector& d) {
  const auto piece = [half](double way) { return std::abs(way) > half ? std::copysign(1.0, way) : 0.0; };
  MeshVector pieces = d.unaryExpr(piece);
  for (int round = 0; round < kMaxPieces; ++round) {
    const MeshMatrix matrix = damped + give * k.cwiseProduct(pieces.cwiseAbs()).asDiagonal();
    d = matrix.partialPivLu().solve(right + give * (half * k.cwiseProduct(pieces)));
    const MeshVector now = d.unaryExpr(piece);
    if (now == pieces) return true;
    pieces = now;
  }
  return false;
}

// Moves `states` columns of q, y, push on by `count` steps after number `first`. torques (count, states): those at
// start and end of each step added up. Returns in how many steps of how many states some mesh did not touch on its
// side, or minus the number of the step that did not converge.
inline std::int64_t advance_train(const TrainSteps& t, const MeshLaw& law, std::int64_t first, std::int64_t count,
                                  std::int64_t states, const double* torques, double* q_out, double* y_out,
                                  double* push_out) {
  const std::int64_t n = t.modes, m = t.meshes;
  LaneRows q(n), y(n), push(n), modes(n), rate(m), right(m), way(m), force(m);
  std::int64_t apart = 0;
  for (std::int64_t begin = 0; begin < states; begin += kLanes) {
    const std::int64_t width = std::min<std::int64_t>(kLanes, states - begin);
    const auto load = [&](LaneRows& rows, const double* from) {
      for (std::int64_t i = 0; i < n; ++i) {
        rows[i].setZero();
        std::copy_n(from + i * states + begin, width, rows[i].data());
      }
    };
    load(q, q_out), load(y, y_out), load(push, push_out);
    for (std::int64_t s = 0; s < count; ++s) {
      const double *w = t.ways + (first + s + 1) * m * n, *give = t.give + (first + s + 1) * m * m;
      const double *solve = law.solve + s * m * m, *spring = law.spring + s * m, *constant = law.constant + s * m;
      Lanes torque = Lanes::Zero();
      std::copy_n(torques + s * states + begin, width, torque.data());
      for (std::int64_t i = 0; i < n; ++i) {
        modes[i] = t.of_q[i] * q[i] + t.of_y[i] * y[i] - push[i] + t.of_torque[i] * torque;
      }
      for (std::int64_t j = 0; j < m; ++j) weighted(w + j * n, y, modes, n, rate[j], right[j]);
      for (std::int64_t j = 0; j < m; ++j) {
        for (std::int64_t l = 0; l < m; ++l) {
          right[j] += give[j * m + l] * (t.damping[l] * rate[l] - constant[l]);
        }
      }
      Eigen::Array<bool, kLanes, 1> touching = Eigen::Array<bool, kLanes, 1>::Constant(true);
      for (std::int64_t j = 0; j < m; ++j) {
        way[j] = weighted(solve + j * m, 1, right, m);
        force[j] = spring[j] * way[j] + constant[j];
        if (law.sides) touching = touching && law.sides[j] * way[j] >= t.half;
      }
      if (!touching.all()) {
        const MeshMatrix g = Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(give, m, m);
        const MeshVector k = Eigen::Map<const Eigen::VectorXd>(spring, m);
        const MeshMatrix damped =
            MeshMatrix::Identity(m, m) + 2.0 / t.h * g * Eigen::Map<const Eigen::VectorXd>(t.damping, m).asDiagonal();
        const MeshVector loaded = g * Eigen::Map<const Eigen::VectorXd>(constant, m);
        MeshVector d(m), rest(m);
        for (std::int64_t lane = 0; lane < width; ++lane) {
          if (touching[lane]) continue;
          ++apart;
          for (std::int64_t j = 0; j < m; ++j) d[j] = way[j][lane], rest[j] = right[j][lane] + loaded[j];
          if (!solve_pieces(g, damped, k, t.half, rest, d)) return -(first + s + 1);
          for (std::int64_t j = 0; j < m; ++j) {
            way[j][lane] = d[j];
            force[j][lane] = k[j] * (d[j] - std::clamp(d[j], -t.half, t.half));
          }
        }
      }
      for (std::int64_t j = 0; j < m; ++j) force[j] += t.damping[j] * (2.0 / t.h * way[j] - rate[j]);
      for (std::int64_t i = 0; i < n; ++i) {
        push[i] = t.scale[i] * weighted(w + i, n, force, m);
        q[i] = modes[i] - push[i];
        y[i] = 4.0 / t.h * q[i] - y[i];
      }
    }
    const auto store = [&](const LaneRows& rows, double* to) {
      for (std::int64_t i = 0; i < n; ++i) std::copy_n(rows[i].data(), width, to + i * states + begin);
    };
    store(q, q_out), store(y, y_out), store(push, push_out);
  }
  return apart;
}

}  // namespace swgpar
