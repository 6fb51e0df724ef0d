// Loops over elements: what the Cython layer calls. Arrays are C-ordered.
#pragma once

#include <cstdint>

#include "corotation.hpp"
#include "hex8i.hpp"
#include "images.hpp"
#include "quad4i.hpp"

namespace swgpar {

struct ElementBatch {  // N nodes each: 8; 4 in the plane; those of a condensed part
  std::int64_t n, nodes;
  const double* stiffness;     // (n_ref, 3 N, 3 N)
  const double* gradient;      // (n_ref, N, 3)
  const double* coords;        // (n_ref, N, 3), from which displacements count
  const double* stress_free;   // (n_ref, N, 3)
  const std::int32_t* ref_of;  // (n)
  const double* rotation;      // (n, 2) cosine and sine of the sector's angle
  const std::int32_t* conn;    // (n, N), -1: fixed
  const std::uint8_t* sixths;  // (n, N)
};

template <int N>
using RowNodes = Eigen::Matrix<double, N, 3, Eigen::RowMajor>;

template <int N>
inline std::int64_t count(const ElementBatch& e) {
  return N == Eigen::Dynamic ? e.nodes : N;
}

template <int N>
inline CorotatedElement<N> state(const ElementBatch& e, std::int64_t k, const double* u,
                                 Eigen::Matrix<double, N, 3>& g) {
  const std::int64_t ref = e.ref_of[k], m = count<N>(e);
  g = Eigen::Map<const RowNodes<N>>(e.gradient + 3 * m * ref, m, 3);
  Eigen::Matrix<double, N, 3> x = Eigen::Map<const RowNodes<N>>(e.coords + 3 * m * ref, m, 3);
  Eigen::Matrix<double, N, 3> small =
      Eigen::Map<const RowNodes<N>>(e.stress_free + 3 * m * ref, m, 3);
  x.rowwise() -= x.colwise().mean().eval();
  small.rowwise() -= small.colwise().mean().eval();
  const double c = e.rotation[2 * k], s = e.rotation[2 * k + 1];
  Eigen::Matrix<double, N, 3> rotated = x, v(m, 3);
  rotated.col(0) = c * x.col(0) - s * x.col(1);
  rotated.col(1) = s * x.col(0) + c * x.col(1);
  for (int a = 0; a < m; ++a)
    v.row(a) = nodal(u, e.conn[m * k + a], e.sixths[m * k + a]).transpose();
  return CorotatedElement<N>(small, rotated, v, g, e.stiffness + 9 * m * m * ref);
}

// Adds forces and tangent blocks; returns the index of a collapsed element or -1.
template <int N>
inline std::int64_t assemble(const ElementBatch& e, const double* u, double* residual,
                             const std::int64_t* slot, double* values, double* energy) {
  constexpr int P = N == 4 ? 2 : 3;  // components with a tangent
  using Block = Eigen::Matrix<double, P, P>;
  const std::int64_t m = count<N>(e);
  Eigen::Matrix<double, N, 3> g(m, 3);
  for (std::int64_t k = 0; k < e.n; ++k) {
    const CorotatedElement<N> c = state<N>(e, k, u, g);
    if (!c.valid) return k;
    *energy += 0.5 * c.d.dot(c.f0);
    const std::int32_t* conn = e.conn + m * k;
    const std::uint8_t* sixths = e.sixths + m * k;
    if (residual != nullptr)
      for (int a = 0; a < m; ++a)
        add_nodal(residual, conn[a], sixths[a], c.rotation * c.r.template segment<3>(3 * a));
    if (values == nullptr) continue;
    const Block turn = c.rotation.template topLeftCorner<P, P>();
    const auto t = c.tangent(g, e.stiffness + 9 * m * m * e.ref_of[k]);
    for (int a = 0; a < m; ++a) {
      for (int b = 0; b < m; ++b) {
        const std::int64_t block_index = slot[m * m * k + m * a + b];
        if (block_index < 0) continue;
        const Block even = 0.5 * (t.template block<P, P>(3 * a, 3 * b) +
                                  t.template block<P, P>(3 * b, 3 * a).transpose());
        Mat3 block = Mat3::Zero();
        block.template topLeftCorner<P, P>() = turn * even * turn.transpose();
        Eigen::Map<Mat3>(values + 9 * block_index) += of_owners(block, sixths[a], sixths[b]);
      }
    }
  }
  return -1;
}

// Stress at the nodes of every element, global axes: (n, N, 6); xx, yy, zz, xy, yz, zx.
template <int N>
inline std::int64_t stress(const ElementBatch& e, const double* recovery, const double* u,
                           double* out) {
  Eigen::Matrix<double, N, 3> g;
  for (std::int64_t k = 0; k < e.n; ++k) {
    const CorotatedElement<N> c = state<N>(e, k, u, g);
    if (!c.valid) return k;
    using Recovery = Eigen::Matrix<double, 6 * N, 3 * N, Eigen::RowMajor>;
    const Eigen::Matrix<double, 6 * N, 1> local =
        Eigen::Map<const Recovery>(recovery + 18 * N * N * e.ref_of[k]) * c.d;
    for (int a = 0; a < N; ++a) {
      const auto v = local.template segment<6>(6 * a);
      Mat3 t;
      t << v[0], v[3], v[5], v[3], v[1], v[4], v[5], v[4], v[2];
      t = (c.rotation * t * c.rotation.transpose()).eval();
      double* o = out + 6 * (N * k + a);
      o[0] = t(0, 0), o[1] = t(1, 1), o[2] = t(2, 2), o[3] = t(0, 1), o[4] = t(1, 2),
      o[5] = t(2, 0);
    }
  }
  return -1;
}

// Reference matrices of n elements (Hex8i; Quad4i with its thickness) of one elasticity matrix,
// which is symmetric; returns the index of an inverted element or -1.
template <class Element, class... Thickness>
inline std::int64_t reference(std::int64_t n, const double* coords, const double* elasticity,
                              bool incompatible, double* stiffness, double* recovery,
                              double* gradient, double* volume, Thickness... thickness) {
  constexpr int N = Element::kNodes;
  const typename Element::Elasticity elastic =
      Eigen::Map<const typename Element::Elasticity>(elasticity);
  for (std::int64_t k = 0; k < n; ++k) {
    const Eigen::Matrix<double, N, 3> x = Eigen::Map<const RowNodes<N>>(coords + 3 * N * k);
    const Element h(x, elastic, incompatible, thickness...);
    if (!(h.smallest_jacobian > 0)) return k;
    Eigen::Map<Eigen::Matrix<double, 3 * N, 3 * N>>(stiffness + 9 * N * N * k) = h.stiffness;
    Eigen::Map<Eigen::Matrix<double, 6 * N, 3 * N, Eigen::RowMajor>>(recovery + 18 * N * N * k) =
        h.recovery;
    Eigen::Map<RowNodes<N>>(gradient + 3 * N * k) = h.gradient;
    volume[k] = h.volume;
  }
  return -1;
}

}  // namespace swgpar
