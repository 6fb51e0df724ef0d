// Loops over elements: what the Cython layer calls. Arrays are C-ordered.
#pragma once

#include <cstdint>

#include "contact.hpp"
#include "corotation.hpp"

namespace swgpar {

struct ElementBatch {
  std::int64_t n;
  const double* stiffness;     // (n_ref, 24, 24)
  const double* gradient;      // (n_ref, 8, 3)
  const double* coords;        // (n_ref, 8, 3)
  const std::int32_t* ref_of;  // (n)
  const double* turn;          // (n, 2) cosine and sine of the sector's turn
  const std::int32_t* conn;    // (n, 8), -1: fixed
  const std::uint8_t* flip;    // (n, 8)
};

using RowMat8x3 = Eigen::Matrix<double, 8, 3, Eigen::RowMajor>;

inline Corotated state(const ElementBatch& e, std::int64_t k, const double* u, Mat8x3& g) {
  const std::int64_t ref = e.ref_of[k];
  g = Eigen::Map<const RowMat8x3>(e.gradient + 24 * ref);
  Mat8x3 x = Eigen::Map<const RowMat8x3>(e.coords + 24 * ref);
  x.rowwise() -= x.colwise().mean().eval();
  const double c = e.turn[2 * k], s = e.turn[2 * k + 1];
  Mat8x3 turned = x, v;
  turned.col(0) = c * x.col(0) - s * x.col(1);
  turned.col(1) = s * x.col(0) + c * x.col(1);
  for (int a = 0; a < 8; ++a) v.row(a) = nodal(u, e.conn[8 * k + a], e.flip[8 * k + a]).transpose();
  return Corotated(x, turned, v, g, e.stiffness + 576 * ref);
}

// Adds forces and tangent blocks; returns the index of a collapsed element or -1.
inline std::int64_t assemble(const ElementBatch& e, const double* u, double* residual, const std::int64_t* slot,
                             double* values, double* energy) {
  Mat8x3 g;
  for (std::int64_t k = 0; k < e.n; ++k) {
    const Corotated c = state(e, k, u, g);
    if (!c.valid) return k;
    *energy += 0.5 * c.d.dot(c.f0);
    const std::int32_t* conn = e.conn + 8 * k;
    const std::uint8_t* flip = e.flip + 8 * k;
    if (residual != nullptr)
      for (int a = 0; a < 8; ++a) add_nodal(residual, conn[a], flip[a], c.rotation * c.r.segment<3>(3 * a));
    if (values == nullptr) continue;
    const Mat24 t = c.tangent(g, e.stiffness + 576 * e.ref_of[k]);
    for (int a = 0; a < 8; ++a) {
      for (int b = 0; b < 8; ++b) {
        const std::int64_t place = slot[64 * k + 8 * a + b];
        if (place < 0) continue;
        Mat3 block = c.rotation * (0.5 * (t.block<3, 3>(3 * a, 3 * b) + t.block<3, 3>(3 * b, 3 * a).transpose())) *
                     c.rotation.transpose();
        if (flip[a]) block.topRows<2>() *= -1.0;
        if (flip[b]) block.leftCols<2>() *= -1.0;
        Eigen::Map<Mat3>(values + 9 * place) += block;
      }
    }
  }
  return -1;
}

// Stress at the nodes of every element, global axes: (n, 8, 6); xx, yy, zz, xy, yz, zx.
inline std::int64_t stress(const ElementBatch& e, const double* recovery, const double* u, double* out) {
  Mat8x3 g;
  for (std::int64_t k = 0; k < e.n; ++k) {
    const Corotated c = state(e, k, u, g);
    if (!c.valid) return k;
    const Eigen::Map<const Eigen::Matrix<double, 48, 24, Eigen::RowMajor>> s(recovery + 1152 * e.ref_of[k]);
    const Eigen::Matrix<double, 48, 1> local = s * c.d;
    for (int a = 0; a < 8; ++a) {
      const auto v = local.segment<6>(6 * a);
      Mat3 t;
      t << v[0], v[3], v[5], v[3], v[1], v[4], v[5], v[4], v[2];
      t = (c.rotation * t * c.rotation.transpose()).eval();
      double* o = out + 48 * k + 6 * a;
      o[0] = t(0, 0), o[1] = t(1, 1), o[2] = t(2, 2), o[3] = t(0, 1), o[4] = t(1, 2), o[5] = t(2, 0);
    }
  }
  return -1;
}

// Reference matrices of n elements; returns the index of an inverted element or -1.
inline std::int64_t reference(std::int64_t n, const double* coords, double young, double poisson, double* stiffness,
                              double* recovery, double* gradient, double* volume) {
  for (std::int64_t k = 0; k < n; ++k) {
    const Mat8x3 x = Eigen::Map<const RowMat8x3>(coords + 24 * k);
    const Hex8i h(x, young, poisson);
    if (!(h.smallest_jacobian > 0)) return k;
    Eigen::Map<Mat24>(stiffness + 576 * k) = h.stiffness;
    Eigen::Map<Eigen::Matrix<double, 48, 24, Eigen::RowMajor>>(recovery + 1152 * k) = h.recovery;
    Eigen::Map<RowMat8x3>(gradient + 24 * k) = h.gradient;
    volume[k] = h.volume;
  }
  return -1;
}

}  // namespace swgpar
