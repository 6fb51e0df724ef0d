// Four-node plane-stress quadrilateral with four incompatible modes (Wilson, Taylor, Beresford),
// modes condensed: the counterpart of CPS4I; without the modes that of CPS4, for comparison. Nodes
// have three components like those of the hexahedron, of which the third has no stiffness, so that
// corotation, assembly and contact are the same.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "trilinear.hpp"

namespace swgpar {

struct Quad4i {
  static constexpr int kNodes = 4;
  using Elasticity = Eigen::Matrix3d;  // MPa, in plane stress; xx, yy, xy
  Eigen::Matrix<double, 12, 12> stiffness;
  Eigen::Matrix<double, 24, 12> recovery;    // stress at the nodes: row 6 * node + component
  Eigen::Matrix<double, 4, 3> gradient;      // dN/dX at the centre
  double volume = 0, smallest_jacobian = 0;  // mm^3; determinant in the plane

  Quad4i(const Eigen::Matrix<double, 4, 3>& x, const Elasticity& elastic, bool incompatible,
         double thickness) {
    using Mat8 = Eigen::Matrix<double, 8, 8>;
    using Mat4x8 = Eigen::Matrix<double, 4, 8>;
    using Mat3x8 = Eigen::Matrix<double, 3, 8>;
    using Mat4x2 = Eigen::Matrix<double, 4, 2>;
    const Eigen::Matrix<double, 4, 2> plane = x.leftCols<2>();
    // on the lower face of the hexahedron its first four shape functions are those of the
    // quadrilateral
    const Mat4x2 center = shape_gradient(0, 0, -1).topLeftCorner<4, 2>();
    const Eigen::Matrix2d j0 = plane.transpose() * center, j0inv = j0.inverse();
    const double det0 = j0.determinant(), p = 1.0 / std::sqrt(3.0);
    gradient.setZero();
    gradient.leftCols<2>() = center * j0inv;
    Eigen::Matrix4d kaa = Eigen::Matrix4d::Zero();
    Mat4x8 kau = Mat4x8::Zero();
    Mat8 kuu = Mat8::Zero();
    std::array<Mat3x8, 4> b;
    std::array<Eigen::Matrix<double, 3, 4>, 4> g;
    smallest_jacobian = det0;
    for (int q = 0; q < 4; ++q) {
      const double xi[2] = {p * kCorner[q][0], p * kCorner[q][1]};
      const Mat4x2 dn = shape_gradient(xi[0], xi[1], -1).topLeftCorner<4, 2>();
      const Eigen::Matrix2d j = plane.transpose() * dn;
      const double det = j.determinant();
      smallest_jacobian = std::min(smallest_jacobian, det);
      const Mat4x2 dx = dn * j.inverse();
      b[q].setZero(), g[q].setZero();
      for (int a = 0; a < 4; ++a) {
        b[q](0, 2 * a) = b[q](2, 2 * a + 1) = dx(a, 0);
        b[q](1, 2 * a + 1) = b[q](2, 2 * a) = dx(a, 1);
      }
      for (int m = 0; m < 2; ++m) {
        const Eigen::Vector2d mode = (det0 / det) * (-2.0 * xi[m]) * j0inv.row(m).transpose();
        g[q](0, 2 * m) = g[q](2, 2 * m + 1) = mode[0];
        g[q](1, 2 * m + 1) = g[q](2, 2 * m) = mode[1];
      }
      const double weight = det * thickness;
      kuu.noalias() += weight * b[q].transpose() * elastic * b[q];
      kau.noalias() += weight * g[q].transpose() * elastic * b[q];
      kaa.noalias() += weight * g[q].transpose() * elastic * g[q];
      volume += weight;
    }
    if (!(smallest_jacobian > 0)) return;
    Mat4x8 alpha = Mat4x8::Zero();
    if (incompatible) alpha = -kaa.ldlt().solve(kau);
    Mat8 k = kuu + kau.transpose() * alpha;
    k = (0.5 * (k + k.transpose())).eval();
    stiffness.setZero();
    recovery.setZero();
    for (int a = 0; a < 4; ++a)
      for (int c = 0; c < 4; ++c) stiffness.block<2, 2>(3 * a, 3 * c) = k.block<2, 2>(2 * a, 2 * c);
    const int component[3] = {0, 1, 3};  // xx, yy, xy among the six components
    for (int q = 0; q < 4; ++q) {
      const Mat3x8 s = elastic * (b[q] + g[q] * alpha);
      for (int a = 0; a < 4; ++a) {
        double weight = 0.25;
        for (int c = 0; c < 2; ++c) weight *= 1 + std::sqrt(3.0) * kCorner[a][c] * kCorner[q][c];
        for (int r = 0; r < 3; ++r)
          for (int n = 0; n < 4; ++n)
            for (int c = 0; c < 2; ++c)
              recovery(6 * a + component[r], 3 * n + c) += weight * s(r, 2 * n + c);
      }
    }
  }
};

}  // namespace swgpar
