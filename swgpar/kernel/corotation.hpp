// Finite rotation of a linear element: energy 1/2 d^T K0 d of the displacement d seen in the element's own
// rotated frame, with forces and tangent that are its exact first and second derivatives.
//
// R: polar rotation of F = sum_a x_a g_a^T (g_a: shape gradients at the centre);  y_a = R^T (x_a - mean),
// d = y - X. With v = R^T dx, U = R^T F, G = tr(U) 1 - U:  spin theta = Q v, Q = G^-1 [ [g_a]x ],
// dd = P v, P = 1 + Y Q, Y_a = [y_a]x;  f0 = K0 d, m = sum y_a x f0_a, r = f0 - Q^T m, f_a = R r_a.
#pragma once

#include "hex8i.hpp"

namespace swgpar {

inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d s;
  s << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return s;
}

// Rotation nearest to F (det F > 0) by the scaled Newton iteration for the polar factor.
inline Eigen::Matrix3d polar_rotation(const Eigen::Matrix3d& f) {
  Eigen::Matrix3d r = f;
  for (int it = 0; it < 50; ++it) {
    const Eigen::Matrix3d inverse = r.inverse();
    const double change0 = r.squaredNorm(),
                 scale = it < 4 ? std::sqrt(std::sqrt(inverse.squaredNorm() / change0)) : 1.0;
    const Eigen::Matrix3d next = 0.5 * (scale * r + inverse.transpose() / scale);
    const double change = (next - r).squaredNorm();
    r = next;
    if (change < 1e-30) break;
  }
  return r;
}

struct Corotated {
  Eigen::Matrix3d rotation, stretch;
  Mat8x3 y;
  Vec24 d, f0, r;
  Eigen::Vector3d moment;
  Mat3x24 q;
  bool valid = true;

  // small: X_a - mean(X), turned: the same after the sector's turn, u: displacements. The displacement in the
  // element frame is R^T (turned + u - mean u) - small, formed from small numbers only.
  Corotated(const Mat8x3& small, const Mat8x3& turned, const Mat8x3& u, const Mat8x3& g, const double* stiffness) {
    const Eigen::RowVector3d mean = u.colwise().mean();
    const Mat8x3 x = turned + (u.rowwise() - mean);
    const Eigen::Matrix3d f = x.transpose() * g;
    if (!(f.determinant() > 0)) {
      valid = false;
      return;
    }
    rotation = polar_rotation(f);
    stretch = rotation.transpose() * f;
    stretch = (0.5 * (stretch + stretch.transpose())).eval();
    y = x * rotation;
    for (int a = 0; a < 8; ++a) d.segment<3>(3 * a) = (y.row(a) - small.row(a)).transpose();
    f0.noalias() = Eigen::Map<const Mat24>(stiffness) * d;
    moment.setZero();
    for (int a = 0; a < 8; ++a) moment += Eigen::Vector3d(y.row(a)).cross(f0.segment<3>(3 * a));
    const Eigen::Matrix3d gi = (stretch.trace() * Eigen::Matrix3d::Identity() - stretch).inverse();
    for (int a = 0; a < 8; ++a) q.middleCols<3>(3 * a) = gi * skew(g.row(a));
    r = f0 - q.transpose() * moment;
  }

  // Tangent in the element frame; symmetric.
  Mat24 tangent(const Mat8x3& g, const double* stiffness) const {
    const Eigen::Map<const Mat24> k0(stiffness);
    Mat24x3 lever;
    Mat3x24 spin_f0, spin_r, change;
    const Eigen::Matrix3d gi = (stretch.trace() * Eigen::Matrix3d::Identity() - stretch).inverse();
    const Eigen::Vector3d n = gi * moment;
    for (int a = 0; a < 8; ++a) {
      lever.middleRows<3>(3 * a) = skew(y.row(a));
      spin_f0.middleCols<3>(3 * a) = skew(f0.segment<3>(3 * a));
      spin_r.middleCols<3>(3 * a) = skew(r.segment<3>(3 * a));
      const Eigen::Vector3d ga = g.row(a);
      change.middleCols<3>(3 * a) = n * ga.transpose() - ga.dot(n) * Eigen::Matrix3d::Identity();
    }
    change.noalias() -= skew(stretch * n) * q;
    // P^T K0 P + Q^T F0 P + Fr^T Q + Q^T N, gathered as K0 + A Q + Q^T A^T-like low-rank updates
    const Mat24x3 ky = k0 * lever;
    const Eigen::Matrix3d inner = lever.transpose() * ky + spin_f0 * lever;
    Mat3x24 left = ky.transpose() + spin_f0 + change;
    left.noalias() += inner * q;
    Mat24 t = k0;
    t.noalias() += ky * q;
    t.noalias() += q.transpose() * left;
    t.noalias() += spin_r.transpose() * q;
    return t;
  }
};

}  // namespace swgpar
