// Loops over contact faces and blocks: what the Cython layer calls.
#pragma once

#include "contact.hpp"
#include "contact_lines.hpp"
#include "friction.hpp"

namespace swgpar {

// Largest cosine of the angle between the outward normals of two flanks that can touch. It is near
// -1 for flanks that touch, whatever their load, and above 0 for a surface seen from behind or
// across a tooth.
constexpr double kFacing = -0.3;

struct FlankBatch {  // n_patch master flanks with the same grid
  int n_patch, n_s, n_z;
  const double* s;
  const double* z;
  const double* point;            // (n_patch, n_s + 1, 2)
  const double* tangent;          // (n_patch, n_s + 1, 2)
  const double* bulge;            // (n_patch, n_s, 4, 2)
  const double* orientation;      // (n_patch)
  const double* rotation;         // (n_patch, 2) cosine and sine of the angles of the teeth
  double body_cosine, body_sine;  // of the rotation of the body as a whole
  const std::int32_t* conn;       // (n_patch, n_s + 1, n_z + 1)
  const std::uint8_t* sixths;

  Patch patch(int k) const {
    const std::int64_t row = static_cast<std::int64_t>(k) * (n_s + 1);
    return Patch{n_s,
                 n_z,
                 s,
                 z,
                 point + 2 * row,
                 tangent + 2 * row,
                 bulge + 8 * static_cast<std::int64_t>(k) * n_s,
                 orientation[k],
                 rotation[2 * k],
                 rotation[2 * k + 1],
                 body_cosine,
                 body_sine,
                 conn + row * (n_z + 1),
                 sixths + row * (n_z + 1)};
  }
};

struct FaceBatch {  // slave faces and their quadrature points
  std::int64_t n_face;
  int n_q;
  const std::int32_t* conn;  // (n_face, 4)
  const std::uint8_t* sixths;
  const double* coords;       // (n_face, 4, 3) undeformed, at the tooth's angle
  const double* normal;       // (n_face, 3) undeformed outward normal, of which the side matters
  const double* shape;        // (n_face, n_q, 4)
  const double* weight;       // (n_face, n_q) area
  const double* offset;       // (n_face, n_q) exact surface above the facet
  const std::int32_t* patch;  // (n_face) master patch
};

// What the gap of each quadrature point has as gradient, by its 4 slave and 4 master nodes; null
// pointers: not wanted.
struct GapGradients {
  std::int32_t* conn = nullptr;    // (n_face, n_q, 8)
  std::uint8_t* sixths = nullptr;  // (n_face, n_q, 8)
  double* vector = nullptr;        // (n_face, n_q, 8, 3)
  double* friction = nullptr;      // (n_face, n_q, 8, 3) nodal forces of friction by the pressure
};

// Gaps (mm), pressures (MPa) and foot points (s, z; mm) at the quadrature points of all faces; adds
// the contact forces to `residual`, the tangent to `rows` and the energy's derivative by the
// rotation of the master body to `moment`.
//   p = multiplier - penalty gap;  virtual work = sum weight p dgap  (p > 0)
// limit : MPa, bound of the pressure in the tangent's geometric terms. Returns the blocks that the
// pattern lacks.
inline std::int64_t flank_contact(const FlankBatch& patches, const FaceBatch& faces,
                                  const double* u, const double* multiplier, double penalty,
                                  double opening, double reach, double beyond, double limit,
                                  const Friction& friction, double* residual, const BlockRows& rows,
                                  double* gap, double* pressure, double* foot_point, double* moment,
                                  const GapGradients& gradients) {
  std::int64_t missing = 0;
  for (std::int64_t k = 0; k < faces.n_face; ++k) {
    const Patch patch = patches.patch(faces.patch[k]);
    std::int32_t conn[8];
    std::uint8_t sixths[8];
    Vec3 undeformed[4], corner[4];
    for (int a = 0; a < 4; ++a) {
      conn[a] = faces.conn[4 * k + a];
      sixths[a] = faces.sixths[4 * k + a];
      const double* c = faces.coords + 12 * k + 3 * a;
      undeformed[a] = Vec3(c[0], c[1], c[2]);
      corner[a] = undeformed[a] + nodal(u, conn[a], sixths[a]);
    }
    const Vec3 outward(faces.normal[3 * k], faces.normal[3 * k + 1], faces.normal[3 * k + 2]);
    Vec3 face_normal = (corner[2] - corner[0]).cross(corner[3] - corner[1]).normalized();
    if ((undeformed[2] - undeformed[0]).cross(undeformed[3] - undeformed[1]).dot(outward) < 0.0)
      face_normal = -face_normal;
    for (int q = 0; q < faces.n_q; ++q) {
      const std::int64_t kq = k * faces.n_q + q;
      const double* shape = faces.shape + 4 * kq;
      const Vec3 xs =
          shape[0] * corner[0] + shape[1] * corner[1] + shape[2] * corner[2] + shape[3] * corner[3];
      const FootPoint f = project(patch, u, xs, beyond);
      // a surface seen from behind, or across a tooth, is not the one this point can touch
      if (!f.found || f.normal.dot(face_normal) > kFacing || std::abs(f.gap) > reach) continue;
      foot_point[2 * kq] = patch.s[f.i] + f.eta * (patch.s[f.i + 1] - patch.s[f.i]);
      foot_point[2 * kq + 1] = patch.z[f.j] + f.zeta * (patch.z[f.j + 1] - patch.z[f.j]);
      gap[kq] = f.gap - faces.offset[kq] + opening;
      const double p = multiplier[kq] - penalty * gap[kq];
      const double bounding = friction.lagged == nullptr ? p : friction.lagged[kq];
      if (p <= 0.0 && bounding <= 0.0 && gradients.vector == nullptr) continue;
      if (p > 0.0) pressure[kq] = p;
      const double e = f.eta, z = f.zeta, w = faces.weight[kq];
      const double m[4] = {(1 - e) * (1 - z), e * (1 - z), (1 - e) * z, e * z};
      const int di[4] = {0, 1, 0, 1}, dj[4] = {0, 0, 1, 1};
      for (int a = 0; a < 4; ++a) {
        conn[4 + a] = patch.node(f.i + di[a], f.j + dj[a]);
        sixths[4 + a] = patch.image(f.i + di[a], f.j + dj[a]);
      }
      if (gradients.vector != nullptr) {
        for (int a = 0; a < 8; ++a) {
          gradients.conn[8 * kq + a] = conn[a];
          gradients.sixths[8 * kq + a] = sixths[a];
          const double share = a < 4 ? shape[a] : -m[a - 4];
          for (int c = 0; c < 3; ++c) gradients.vector[3 * (8 * kq + a) + c] = share * f.normal[c];
        }
      }
      if (p > 0.0 && residual != nullptr) {
        for (int a = 0; a < 4; ++a) {
          add_nodal(residual, conn[a], sixths[a], -p * w * shape[a] * f.normal);
          add_nodal(residual, conn[4 + a], sixths[4 + a], p * w * m[a] * f.normal);
        }
        moment[k] += p * w * (f.normal[1] * f.height[0] - f.normal[0] * f.height[1]);
      }
      if (p > 0.0 && rows.values != nullptr)
        missing +=
            add_contact_tangent(f, shape, conn, sixths, w, penalty, std::min(p, limit), rows);
      if (friction.coefficient == 0.0 || bounding <= 0.0) continue;
      const Vec2 length(patch.s[f.i + 1] - patch.s[f.i], patch.z[f.j + 1] - patch.z[f.j]);
      const Traction t = traction(f, length, Vec2(foot_point[2 * kq], foot_point[2 * kq + 1]),
                                  friction, kq, bounding);
      if (!t.acts) continue;
      const Motion motion(f, shape);
      if (residual != nullptr) {
        const Eigen::Matrix<double, 24, 1> force =
            w * motion.foot.transpose() * (motion.x.transpose() * t.value);
        for (int a = 0; a < 8; ++a)
          add_nodal(residual, conn[a], sixths[a], force.segment<3>(3 * a));
        moment[k] += w * motion.by_rotation(f).dot(motion.x.transpose() * t.value);
      }
      if (gradients.friction != nullptr && friction.lagged == nullptr) {
        const Eigen::Matrix<double, 24, 1> force =
            motion.foot.transpose() * (motion.x.transpose() * by_pressure(t, motion, friction));
        for (int c = 0; c < 24; ++c) gradients.friction[24 * kq + c] = force[c];
      }
      if (rows.values != nullptr)
        missing += add_friction_tangent(
            f, t, motion, f.straight ? Vec3::Zero().eval() : patch.third_derivative(f.i, f.eta),
            conn, sixths, w, penalty, bounding, std::min(1.0, limit / bounding), friction, rows);
    }
  }
  return missing;
}

// Adds the tangents of lines of contact, cells start[k] .. start[k + 1] - 1 of line k; see
// `add_line_tangent`. stiffness : the lines' matrices, one after the other.
inline std::int64_t add_line_tangents(std::int64_t n_line, const std::int64_t* start, int n_node,
                                      const std::int32_t* conn, const std::uint8_t* sixths,
                                      const double* left, const double* right,
                                      const double* stiffness, const BlockRows& rows) {
  std::int64_t missing = 0;
  for (std::int64_t k = 0; k < n_line; ++k) {
    const int n_cell = static_cast<int>(start[k + 1] - start[k]);
    const std::int64_t first = start[k] * n_node;
    missing += add_line_tangent(n_cell, n_node, conn + first, sixths + first, left + 3 * first,
                                right + 3 * first, stiffness, rows);
    stiffness += static_cast<std::int64_t>(n_cell) * n_cell;
  }
  return missing;
}

// Adds dense blocks (n, m, m, 3, 3) of the nodes conn (n, m) to the owned rows; returns the blocks
// that the pattern lacks.
inline std::int64_t add_blocks(std::int64_t n, int m, const std::int32_t* conn,
                               const std::uint8_t* sixths, const double* blocks,
                               const BlockRows& rows) {
  std::int64_t missing = 0;
  for (std::int64_t k = 0; k < n; ++k) {
    for (int a = 0; a < m; ++a) {
      for (int b = 0; b < m; ++b) {
        const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(
            blocks + 9 * ((k * m + a) * m + b));
        if (!rows.add(conn[k * m + a], sixths[k * m + a], conn[k * m + b], sixths[k * m + b],
                      block))
          ++missing;
      }
    }
  }
  return missing;
}

}  // namespace swgpar
