// Eight-node hexahedron with nine incompatible modes (Wilson, Taylor, Beresford), linear elastic,
// modes condensed: the counterpart of C3D8I; without the modes that of C3D8, for comparison. The
// modes' gradients use the centre Jacobian scaled by j0 / j, so that their mean over the element
// vanishes and the patch test passes on distorted meshes.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "trilinear.hpp"

namespace swgpar {

using Mat24 = Eigen::Matrix<double, 24, 24>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

// Strain (xx, yy, zz, xy, yz, zx; engineering shear) of a vector shape with gradient g times unit
// axis c.
inline void strain_column(Eigen::Ref<Eigen::Matrix<double, 6, 1>> col, const Eigen::Vector3d& g,
                          int c) {
  col.setZero();
  col[c] = g[c];
  if (c == 0) col[3] = g[1], col[5] = g[2];
  if (c == 1) col[3] = g[0], col[4] = g[2];
  if (c == 2) col[4] = g[1], col[5] = g[0];
}

struct Hex8i {
  static constexpr int kNodes = 8;
  using Elasticity = Mat6;  // MPa; xx, yy, zz, xy, yz, zx
  Mat24 stiffness;
  Eigen::Matrix<double, 48, 24> recovery;  // stress at the nodes: row 6 * node + component
  Mat8x3 gradient;                         // dN/dX at the centre
  double volume = 0, smallest_jacobian = 0;

  Hex8i(const Mat8x3& x, const Elasticity& elastic, bool incompatible) {
    const Mat8x3 center = shape_gradient(0, 0, 0);
    const Eigen::Matrix3d j0 = x.transpose() * center;  // dX/dxi
    const Eigen::Matrix3d j0inv = j0.inverse();
    const double det0 = j0.determinant();
    gradient = center * j0inv;
    Eigen::Matrix<double, 9, 9> kaa = Eigen::Matrix<double, 9, 9>::Zero();
    Eigen::Matrix<double, 9, 24> kau = Eigen::Matrix<double, 9, 24>::Zero();
    Mat24 kuu = Mat24::Zero();
    std::array<Eigen::Matrix<double, 6, 24>, 8> b;
    std::array<Eigen::Matrix<double, 6, 9>, 8> g;
    const double p = 1.0 / std::sqrt(3.0);
    smallest_jacobian = det0;
    for (int q = 0; q < 8; ++q) {
      const double xi[3] = {p * kCorner[q][0], p * kCorner[q][1], p * kCorner[q][2]};
      const Mat8x3 dn = shape_gradient(xi[0], xi[1], xi[2]);
      const Eigen::Matrix3d j = x.transpose() * dn;
      const double det = j.determinant();
      smallest_jacobian = std::min(smallest_jacobian, det);
      const Mat8x3 dx = dn * j.inverse();
      for (int a = 0; a < 8; ++a)
        for (int c = 0; c < 3; ++c) strain_column(b[q].col(3 * a + c), dx.row(a).transpose(), c);
      for (int m = 0; m < 3; ++m) {
        const Eigen::Vector3d mode = (det0 / det) * (-2.0 * xi[m]) * j0inv.row(m).transpose();
        for (int c = 0; c < 3; ++c) strain_column(g[q].col(3 * m + c), mode, c);
      }
      kuu.noalias() += det * b[q].transpose() * elastic * b[q];
      kau.noalias() += det * g[q].transpose() * elastic * b[q];
      kaa.noalias() += det * g[q].transpose() * elastic * g[q];
      volume += det;
    }
    if (!(smallest_jacobian > 0)) return;
    Eigen::Matrix<double, 9, 24> alpha = Eigen::Matrix<double, 9, 24>::Zero();
    if (incompatible) alpha = -kaa.ldlt().solve(kau);
    stiffness = kuu + kau.transpose() * alpha;
    stiffness = (0.5 * (stiffness + stiffness.transpose())).eval();
    // trilinear extrapolation from the Gauss points, which sit at 1/sqrt(3) of the nodes'
    // coordinates
    const double f = std::sqrt(3.0);
    recovery.setZero();
    for (int q = 0; q < 8; ++q) {
      const Eigen::Matrix<double, 6, 24> s = elastic * (b[q] + g[q] * alpha);
      for (int a = 0; a < 8; ++a) {
        double weight = 0.125;
        for (int c = 0; c < 3; ++c) weight *= 1 + f * kCorner[a][c] * kCorner[q][c];
        recovery.middleRows<6>(6 * a) += weight * s;
      }
    }
  }
};

}  // namespace swgpar
