// Corners of the unit cube and derivatives of its trilinear shape functions: hexahedron and
// quadrilateral share them.
#pragma once

#include <Eigen/Dense>

namespace swgpar {

using Mat8x3 = Eigen::Matrix<double, 8, 3>;

constexpr double kCorner[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                  {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};

// dN_a/d(xi, eta, zeta), one row per node.
inline Mat8x3 shape_gradient(double xi, double eta, double zeta) {
  Mat8x3 g;
  for (int a = 0; a < 8; ++a) {
    const double* c = kCorner[a];
    g(a, 0) = 0.125 * c[0] * (1 + eta * c[1]) * (1 + zeta * c[2]);
    g(a, 1) = 0.125 * c[1] * (1 + xi * c[0]) * (1 + zeta * c[2]);
    g(a, 2) = 0.125 * c[2] * (1 + xi * c[0]) * (1 + eta * c[1]);
  }
  return g;
}

}  // namespace swgpar
