// Finite rotation of a linear element: energy 1/2 d^T K0 d of the displacement d seen in the
// element's own rotated frame, with forces and tangent that are its exact first and second
// derivatives.
//
// R: polar rotation of F = sum_a x_a g_a^T (g_a: shape gradients at the centre);  y_a = R^T (x_a -
// mean), d = y - X, X: stress-free nodes, which may be others than those from which displacements
// count. R does not depend on X, so that d varies with y alone. With v = R^T dx, U = R^T F, G =
// tr(U) 1 - U:  spin theta = Q v, Q = G^-1 [ [g_a]x ], dd = P v, P = 1 + Y Q, Y_a = [y_a]x;  f0 =
// K0 d, m = sum y_a x f0_a, r = f0 - Q^T m, f_a = R r_a.
#pragma once

#include "hex8i.hpp"

namespace swgpar {

inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d s;
  s << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return s;
}

constexpr int kScaledSteps =
    4;  // of Newton's iteration for the polar factor, the others converge by themselves
constexpr int kMostPolarSteps = 50;  // some 6 are needed
constexpr double kPolarTolerance =
    1e-30;  // of the squared change: round-off of a matrix of entries near 1

// Rotation nearest to F (det F > 0) by Newton's iteration for the polar factor, scaled by Frobenius
// norms (Higham 1986).
inline Eigen::Matrix3d polar_rotation(const Eigen::Matrix3d& f) {
  Eigen::Matrix3d r = f;
  for (int it = 0; it < kMostPolarSteps; ++it) {
    const Eigen::Matrix3d inverse = r.inverse();
    const double size = r.squaredNorm(),
                 scale =
                     it < kScaledSteps ? std::sqrt(std::sqrt(inverse.squaredNorm() / size)) : 1.0;
    const Eigen::Matrix3d next = 0.5 * (scale * r + inverse.transpose() / scale);
    const double change = (next - r).squaredNorm();
    r = next;
    if (change < kPolarTolerance) break;
  }
  return r;
}

// The same for a rotation about z alone.
inline Eigen::Matrix3d plane_rotation(const Eigen::Matrix3d& f) {
  const double c = f(0, 0) + f(1, 1), s = f(1, 0) - f(0, 1), norm = std::hypot(c, s);
  Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
  r(0, 0) = r(1, 1) = c / norm;
  r(1, 0) = s / norm;
  r(0, 1) = -r(1, 0);
  return r;
}

// N: 8 for hexahedra; 4 for plane elements, whose nodes have no displacement along z; Dynamic for
// condensed parts, which are plane where their gradient has no z.
template <int N>
struct CorotatedElement {
  static constexpr int D = N == Eigen::Dynamic ? Eigen::Dynamic : 3 * N;
  static constexpr int S = N == 4 ? 1 : 3;  // axes about which it rotates, the last ones: z alone
  using Nodes = Eigen::Matrix<double, N, 3>;
  using Vector = Eigen::Matrix<double, D, 1>;
  using Square = Eigen::Matrix<double, D, D>;
  using Rows = Eigen::Matrix<double, S, D>;

  Eigen::Matrix3d rotation, stretch;
  Nodes y;
  Vector d, f0, r;
  Eigen::Vector3d moment;
  Rows q;
  bool valid = true;

  // small: X_a - mean(X), stress-free, rotated: undeformed nodes from their mean at the sector's
  // angle, u: displacements. The displacement in the element frame is R^T (rotated + u - mean u) -
  // small, formed from small numbers only.
  CorotatedElement(const Nodes& small, const Nodes& rotated, const Nodes& u, const Nodes& g,
                   const double* stiffness) {
    const Eigen::RowVector3d mean = u.colwise().mean();
    const Nodes x = rotated + (u.rowwise() - mean);
    const int m = static_cast<int>(g.rows());
    Eigen::Matrix3d f = x.transpose() * g;
    const bool plane = N == 4 || (N == Eigen::Dynamic && (g.col(2).array() == 0.0).all());
    if (plane) f(2, 2) = 1.0;
    if (!(f.determinant() > 0)) {
      valid = false;
      return;
    }
    rotation = plane ? plane_rotation(f) : polar_rotation(f);
    stretch = rotation.transpose() * f;
    stretch = (0.5 * (stretch + stretch.transpose())).eval();
    y = x * rotation;
    d.resize(3 * m), q.resize(S, 3 * m);
    for (int a = 0; a < m; ++a)
      d.template segment<3>(3 * a) = (y.row(a) - small.row(a)).transpose();
    f0.noalias() = Eigen::Map<const Square>(stiffness, 3 * m, 3 * m) * d;
    moment.setZero();
    for (int a = 0; a < m; ++a)
      moment += Eigen::Vector3d(y.row(a)).cross(f0.template segment<3>(3 * a));
    const Eigen::Matrix3d gi = (stretch.trace() * Eigen::Matrix3d::Identity() - stretch).inverse();
    for (int a = 0; a < m; ++a)
      q.template middleCols<3>(3 * a) = gi.template bottomRows<S>() * skew(g.row(a));
    r = f0 - q.transpose() * moment.template tail<S>();
  }

  // Tangent in the element frame; symmetric.
  Square tangent(const Nodes& g, const double* stiffness) const {
    const int m = static_cast<int>(g.rows());
    const Eigen::Map<const Square> k0(stiffness, 3 * m, 3 * m);
    Eigen::Matrix<double, D, S> lever(3 * m, S);
    Rows spin_f0(S, 3 * m), spin_r(S, 3 * m), change(S, 3 * m);
    const Eigen::Matrix3d gi = (stretch.trace() * Eigen::Matrix3d::Identity() - stretch).inverse();
    const Eigen::Vector3d n = gi * moment;
    for (int a = 0; a < m; ++a) {
      lever.template middleRows<3>(3 * a) = skew(y.row(a)).template rightCols<S>();
      spin_f0.template middleCols<3>(3 * a) =
          skew(f0.template segment<3>(3 * a)).template bottomRows<S>();
      spin_r.template middleCols<3>(3 * a) =
          skew(r.template segment<3>(3 * a)).template bottomRows<S>();
      const Eigen::Vector3d ga = g.row(a);
      change.template middleCols<3>(3 * a) =
          (n * ga.transpose() - ga.dot(n) * Eigen::Matrix3d::Identity()).template bottomRows<S>();
    }
    change.noalias() -= skew(stretch * n).template bottomRightCorner<S, S>() * q;
    // P^T K0 P + Q^T F0 P + Fr^T Q + Q^T N, gathered as K0 + A Q + Q^T A^T-like low-rank updates
    const Eigen::Matrix<double, D, S> ky = k0 * lever;
    const Eigen::Matrix<double, S, S> inner = lever.transpose() * ky + spin_f0 * lever;
    Rows left = ky.transpose() + spin_f0 + change;
    left.noalias() += inner * q;
    Square t = k0;
    t.noalias() += ky * q;
    t.noalias() += q.transpose() * left;
    t.noalias() += spin_r.transpose() * q;
    return t;
  }
};

}  // namespace swgpar
