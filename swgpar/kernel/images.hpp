// Nodes that are images of others, rotated about z: their vectors, forces and blocks. Elements and
// contact share it.
#pragma once

#include <Eigen/Dense>
#include <cstdint>

namespace swgpar {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;

// Cosines and sines of the angles by which images are rotated about z. The flag of a node is its
// angle in sixths of a turn, 0 where it is no image. Half a turn is exact.
// swgpar/geometry/rotation.py has the same table.
struct PlaneRotation {
  double c, s;
};
constexpr double kSine = 0.86602540378443864676;
constexpr PlaneRotation kSixths[6] = {{1.0, 0.0},  {0.5, kSine},   {-0.5, kSine},
                                      {-1.0, 0.0}, {-0.5, -kSine}, {0.5, -kSine}};

// Vector of local node `node` (-1: fixed), rotated when it is an image.
inline Vec3 nodal(const double* u, std::int32_t node, std::uint8_t sixths) {
  if (node < 0) return Vec3::Zero();
  const auto [c, s] = kSixths[sixths];
  const double* v = u + 3 * node;
  return Vec3(c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]);
}

// Adds the force f to the vector r (n_local, 3) at a local node; the counterpart of `nodal`.
inline void add_nodal(double* r, std::int32_t node, std::uint8_t sixths, const Vec3& f) {
  if (node < 0) return;
  const auto [c, s] = kSixths[sixths];
  r[3 * node] += c * f[0] + s * f[1];
  r[3 * node + 1] += c * f[1] - s * f[0];
  r[3 * node + 2] += f[2];
}

// Block of the owners of two nodes from that of the nodes, which may be images: R_row^T block
// R_col.
inline Mat3 of_owners(Mat3 block, std::uint8_t row_flip, std::uint8_t col_flip) {
  if (row_flip) {
    const auto [c, s] = kSixths[row_flip];
    const Eigen::RowVector3d x = block.row(0), y = block.row(1);
    block.row(0) = c * x + s * y;
    block.row(1) = c * y - s * x;
  }
  if (col_flip) {
    const auto [c, s] = kSixths[col_flip];
    const Vec3 x = block.col(0), y = block.col(1);
    block.col(0) = c * x + s * y;
    block.col(1) = c * y - s * x;
  }
  return block;
}

}  // namespace swgpar
